#include "solver_metal/metal_kernels.hpp"

#include "mechanics/shell_kernels.hpp"
#include "solver_metal/hill48.hpp"
#include "solver_metal/j2_law.hpp"
#include "solver_metal/return_mapping.hpp"
#include "solver_metal/stable_increment.hpp"

namespace interply::metal {
namespace {

using simd::Index;
using Real = simd::Pack;
using PackTensor = Tensor<Real>;

/// First point of a pack at which `good` does not hold, or -1.
template <class Lanes>
Index find_bad(const Lanes& lanes, const simd::Mask<Real>& good) {
  if (simd::all(good)) return -1;
  const simd::Lanes<Real, false> all(0, Lanes::kWidth);
  double is_good[Lanes::kWidth];
  all.store(is_good, simd::select(good, Real(1.0), Real(0.0)));
  for (int l = 0; l < lanes.count(); ++l)
    if (is_good[l] == 0) return lanes.begin() + l;
  return -1;
}

Index compute_facets(const mechanics::ShellRows& shell, const double* const x[3], double smallest, double largest,
                     Index begin, Index end) {
  Index bad = -1;
  simd::for_each_pack<Real>(begin, end, [&](const auto& lanes) {
    const auto f = mechanics::compute_facet<Real>(shell, lanes, x);
    mechanics::store_facet(shell, lanes, f);
    const Index found = find_bad(lanes, (f.area_ratio > Real(smallest)) & (f.area_ratio <= Real(largest)));
    if (bad < 0) bad = found;
  });
  return bad;
}

template <class Lanes>
PackTensor load(const Lanes& lanes, const double* const row[3]) {
  return {lanes.load(row[0]), lanes.load(row[1]), lanes.load(row[2])};
}

template <class Lanes>
void store(const Lanes& lanes, double* const row[3], const PackTensor& a) {
  lanes.store(row[0], a.m11);
  lanes.store(row[1], a.m22);
  lanes.store(row[2], a.m12);
}

/// Thickness means of stress, moment, thickness strain and stress work per volume.
struct Means {
  PackTensor force, moment;
  Real strain, work;
};

/// All points of a pack of elements under de(z) = membrane + xi bending. The hardening of a point is touched only
/// where it yields somewhere in the pack.
template <class Law, class Curve, class Lanes>
Means advance_points(const SheetRows& sheet, const LawConstants& constants, const Law& law, const Curve& curve,
                     const Lanes& lanes, const PackTensor& membrane, const PackTensor& bending) {
  const Index n = sheet.n;
  PackTensor stress[kMostPoints];
  Return<Law::kModes, Real> returns[kMostPoints];
  int return_of[kMostPoints], n_returns = 0;
  for (int i = 0; i < sheet.n_points; ++i) {
    const double* const rows[3] = {sheet.stress + 3 * i * n, sheet.stress + (3 * i + 1) * n,
                                   sheet.stress + (3 * i + 2) * n};
    auto& r = returns[n_returns];
    stress[i] = law.compute_trial(load(lanes, rows), membrane + Real(sheet.xi[i]) * bending, r.square);
    const Real yield = lanes.load(sheet.yield_stress + i * n);
    Real trial2 = r.square[0];
    for (int m = 1; m < Law::kModes; ++m) trial2 += r.square[m];
    r.left = trial2 > yield * yield;
    return_of[i] = -1;
    if (!simd::any(r.left)) continue;
    r.start = {lanes.load(sheet.plastic_strain + i * n), yield, lanes.load(sheet.yield_slope + i * n), Real(0.0)};
    return_of[i] = n_returns++;
  }
  return_packs(constants, curve, law.rate, n_returns, returns);

  const Real zero(0.0), lateral(-constants.poisson / constants.young);
  Means mean{{zero, zero, zero}, {zero, zero, zero}, zero, zero};
  for (int i = 0; i < sheet.n_points; ++i) {
    const Real weight(sheet.weight[i]), xi(sheet.xi[i]), half_weight(0.5 * sheet.weight[i]);
    Real plastic = zero;
    if (return_of[i] >= 0) {
      const Plastic<Real>& point = returns[return_of[i]].end;
      const simd::Mask<Real> yields = point.multiplier > zero;
      PackTensor s = stress[i];
      plastic = simd::select(yields, law.shrink(point.multiplier, s), zero);
      stress[i] = {simd::select(yields, s.m11, stress[i].m11), simd::select(yields, s.m22, stress[i].m22),
                   simd::select(yields, s.m12, stress[i].m12)};
      lanes.store(sheet.plastic_strain + i * n, point.strain);
      lanes.store(sheet.yield_stress + i * n, point.yield_stress);
      lanes.store(sheet.yield_slope + i * n, point.yield_slope);
    }
    double* const rows[3] = {sheet.stress + 3 * i * n, sheet.stress + (3 * i + 1) * n, sheet.stress + (3 * i + 2) * n};
    const PackTensor& s = stress[i];
    const PackTensor before = load(lanes, rows);
    store(lanes, rows, s);
    mean.strain += weight * (lateral * (s.m11 + s.m22 - before.m11 - before.m22) - plastic);
    mean.work += half_weight * contract(before + s, membrane + xi * bending);
    const PackTensor part = weight * s;
    mean.force = mean.force + part;
    mean.moment = mean.moment + xi * part;
  }
  return mean;
}

/// Second pass of a pack; see metal_element.hpp. @return which thicknesses are positive and finite
template <class Law, class Curve, class Lanes>
simd::Mask<Real> advance_pack(const mechanics::ShellRows& shell, const SheetRows& sheet, const LawConstants& constants,
                              const Law& law, const Curve& curve, const double* phi, const Lanes& lanes,
                              simd::Sum<Real>& work) {
  const Real half(0.5);
  const auto f = mechanics::load_facet<Real>(shell, lanes);
  const auto k = mechanics::compute_curvature<Real>(shell, lanes, f, phi);
  const PackTensor metric{dot(f.f1, f.f1), dot(f.f2, f.f2), dot(f.f1, f.f2)}, curvature{k.k11, k.k22, k.k12};
  const PackTensor old_metric = load(lanes, sheet.metric), old_curvature = load(lanes, sheet.curvature);
  const Real old_thickness = lanes.load(sheet.thickness), old_ratio = simd::sqrt(old_metric.determinant());

  const PackTensor middle = half * (old_metric + metric);
  const Real j = simd::sqrt(middle.determinant());
  const PackTensor um = compute_inverse_stretch(middle, j);
  const Real half_thickness = half * old_thickness * old_ratio / j;                  // of constant volume
  const PackTensor membrane = compute_congruence(um, half * (metric - old_metric));  // (E1)
  const PackTensor bending = compute_congruence(um, half_thickness * (old_curvature - curvature));  // (E1)
  const Means mean = advance_points(sheet, constants, law, curve, lanes, membrane, bending);

  const Real thickness = old_thickness * simd::exp(mean.strain);
  const Real volume = f.area_ratio * thickness, half_area = half * k.area;
  work.add(lanes, half_area * (old_ratio * old_thickness + volume) * mean.work);
  lanes.store(sheet.thickness, thickness);
  store(lanes, sheet.metric, metric);
  store(lanes, sheet.curvature, curvature);
  const PackTensor u = compute_inverse_stretch(metric, f.area_ratio);
  const PackTensor force = compute_congruence(u, (k.area * volume) * mean.force);               // A N of (E2)
  const PackTensor moment = compute_congruence(u, (-half * thickness * volume) * mean.moment);  // (E2)
  mechanics::store_membrane(shell, lanes, force.m11, force.m22, force.m12);
  mechanics::store_moments(shell, lanes, k, moment.m11, moment.m22, moment.m12);
  return (thickness > Real(0.0)) & (thickness < Real(1e300));
}

template <class Law, class Curve>
SheetAdvance advance_law(const mechanics::ShellRows& shell, const SheetRows& sheet, const LawConstants& constants,
                         const Curve& curve, const double* phi, Index begin, Index end) {
  const Law law(constants);
  SheetAdvance result;
  simd::Sum<Real> work(begin);
  simd::for_each_pack<Real>(begin, end, [&](const auto& lanes) {
    const Index found = find_bad(lanes, advance_pack(shell, sheet, constants, law, curve, phi, lanes, work));
    if (result.bad < 0) result.bad = found;
  });
  result.work = work.total();
  return result;
}

SheetAdvance advance(const mechanics::ShellRows& shell, const SheetRows& sheet, const LawConstants& law,
                     const double* phi, Index begin, Index end) {
  return with_curve(law.hardening, [&](const auto& curve) {
    return law.is_hill48 ? advance_law<Hill48<Real>>(shell, sheet, law, curve, phi, begin, end)
                         : advance_law<J2<Real>>(shell, sheet, law, curve, phi, begin, end);
  });
}

/// g_k of (T2), and the current volume.
struct Corners {
  Real g1[3], g2[3], volume;
  Real square(int k) const { return g1[k] * g1[k] + g2[k] * g2[k]; }
};

template <class Lanes>
Corners compute_corners(const mechanics::ShellRows& shell, const SheetRows& sheet, const Lanes& lanes,
                        const PackTensor& metric, const Real& j) {
  const PackTensor u = compute_inverse_stretch(metric, j);
  const auto n = mechanics::load_gradient<Real>(shell, lanes);
  Corners c;
  for (int k = 0; k < 3; ++k) {
    c.g1[k] = u.m11 * n.n1[k] + u.m12 * n.n2[k];
    c.g2[k] = u.m12 * n.n1[k] + u.m22 * n.n2[k];
  }
  c.volume = lanes.load(shell.area) * j * lanes.load(sheet.thickness);
  return c;
}

void add_nodal_stiffness(const mechanics::ShellRows& shell, const SheetRows& sheet, double* q) {
  simd::for_each_pack<Real>(0, sheet.n, [&](const auto& lanes) {
    const PackTensor metric = load(lanes, sheet.metric);
    const Corners c = compute_corners(shell, sheet, lanes, metric, simd::sqrt(metric.determinant()));
    alignas(64) double share[3][simd::kWidth<Real>];
    for (int k = 0; k < 3; ++k) simd::write_lanes(share[k], c.volume * c.square(k));
    for (int l = 0; l < lanes.count(); ++l)
      for (int k = 0; k < 3; ++k) q[shell.node[k][lanes.begin() + l]] += share[k][l];
  });
}

double bound_frequency2(const mechanics::ShellRows& shell, const SheetRows& sheet, const IncrementRows& rows,
                        Index begin, Index end) {
  Real highest(0.0);
  simd::for_each_pack<Real>(begin, end, [&](const auto& lanes) {
    const PackTensor metric = load(lanes, sheet.metric);
    const Real j = simd::sqrt(metric.determinant());
    const Corners c = compute_corners(shell, sheet, lanes, metric, j);
    PackTensor gram{Real(0.0), Real(0.0), Real(0.0)};
    for (int k = 0; k < 3; ++k) {
      const Real weight = simd::gather<Real>(rows.nodal_stiffness, lanes.load(shell.node[k])) / c.square(k);
      gram.m11 += weight * c.g1[k] * c.g1[k];
      gram.m22 += weight * c.g2[k] * c.g2[k];
      gram.m12 += weight * c.g1[k] * c.g2[k];
    }
    Real stress2(0.0);
    for (int i = 0; i < sheet.n_points; ++i) {
      const double* const at = sheet.stress + 3 * i * sheet.n;
      const Real s11 = lanes.load(at), s22 = lanes.load(at + sheet.n), s12 = lanes.load(at + 2 * sheet.n);
      stress2 = simd::max(stress2, s11 * s11 + s22 * s22 - s11 * s22 + Real(3.0) * s12 * s12);
    }
    const Real stress = Real(kPrincipalPerVonMises) * simd::sqrt(stress2);
    const Real membrane = bound_membrane_frequency2(gram, rows.young, rows.poisson, stress);
    const Real growth = compute_bending_growth(metric, j, Real(1 / rows.thickness0) * lanes.load(sheet.thickness));
    const Real bending = Real(rows.stiffening) * lanes.load(rows.bending_frequency2) * growth;
    highest = simd::max(highest, membrane + bending);  // (T1)
  });
  alignas(64) double lanes[simd::kWidth<Real>];
  simd::write_lanes(lanes, highest);
  double most = 0;
  for (const double l : lanes) most = l > most ? l : most;
  return most;
}

}  // namespace

template <>
const MetalKernels& get_metal_kernels<simd::Target>() {
  static constexpr MetalKernels kernels{compute_facets, advance, add_nodal_stiffness, bound_frequency2};
  return kernels;
}

}  // namespace interply::metal
