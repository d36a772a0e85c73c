#include "solver_fabric/fabric_kernels.hpp"

#include "mechanics/shell_kernels.hpp"
#include "solver_fabric/membrane.hpp"
#include "solver_fabric/stable_increment.hpp"
#include "solver_fabric/woven_law.hpp"

namespace interply::fabric {
namespace {

using mechanics::ShellRows;
using simd::Index, simd::for_each_pack, simd::Sum;
using Real = simd::Pack;

/// First of the lanes where `good` is false.
int find_bad_lane(const Mask<Real>& good) {
  alignas(64) double bad[simd::kWidth<Real>];
  simd::write_lanes(bad, select(good, Real(0.0), Real(1.0)));
  int l = 0;
  while (bad[l] == 0) ++l;
  return l;
}

// One function per law (noinline): the compiler rounds a scalar loop otherwise where it is merged with another.
template <class Law>
[[gnu::noinline]] MembraneResult stretch(const ShellRows& s, const double* const x[3], const Law& law, double thickness,
                                         Index begin, Index end) {
  MembraneResult result;
  Sum<Real> energy(begin);
  for_each_pack<Real>(begin, end, [&](const auto& lanes) {
    const mechanics::Facet<Real> f = mechanics::compute_facet<Real>(s, lanes, x);
    mechanics::store_facet(s, lanes, f);
    const FibreState<Real> fibres = compute_fibre_state(f);
    const Potential<Real> w = evaluate(law, fibres.la, fibres.lb, fibres.gamma);
    const MembraneStress<Real> S = compute_membrane_stress(w, fibres);
    const Real volume = Real(thickness) * lanes.load(s.area);
    mechanics::store_membrane(s, lanes, volume * S.S11, volume * S.S22, volume * S.S12);
    energy.add(lanes, volume * w.W);
    const Mask<Real> good =
        fibres.cosine > Real(kFoldedCosine) && f.area_ratio > Real(kFoldedAreaRatio) && w.W - w.W == Real(0.0);
    if (!all(good) && result.failed < 0) result.failed = lanes.begin() + find_bad_lane(good);
  });
  result.energy = energy.total();
  return result;
}

double bend(const ShellRows& s, const double* phi, const BendingStiffness& stiffness, Index begin, Index end) {
  const Real warp(stiffness.warp), weft(stiffness.weft), twist(2 * stiffness.twist), half(0.5), two(2.0);
  Sum<Real> energy(begin);
  for_each_pack<Real>(begin, end, [&](const auto& lanes) {
    const auto f = mechanics::load_facet<Real>(s, lanes);
    const auto k = mechanics::compute_curvature(s, lanes, f, phi);
    const Real m11 = warp * k.k11, m22 = weft * k.k22, m12 = twist * k.k12;
    mechanics::store_moments(s, lanes, k, m11, m22, m12);
    energy.add(lanes, half * k.area * (m11 * k.k11 + m22 * k.k22 + two * m12 * k.k12));
  });
  return energy.total();
}

/// Largest compute_membrane_eigenvalue_bound() of the elements [begin, end).
template <class Law>
[[gnu::noinline]] double bound(const ShellRows& s, const double* const x[3], const Law& law, Index begin, Index end) {
  Real largest(0.0);
  for_each_pack<Real>(begin, end, [&](const auto& lanes) {
    const auto f = mechanics::compute_facet<Real>(s, lanes, x);
    const Symmetric<Real> g = compute_gradient_products(mechanics::load_gradient<Real>(s, lanes));
    const FibreState<Real> fibres = compute_fibre_state(f);
    const Potential<Real> w = evaluate(law, fibres.la, fibres.lb, fibres.gamma);
    largest = max(largest, compute_membrane_eigenvalue_bound(w, fibres, g, law.stiffness_floor));
  });
  alignas(64) double lanes[simd::kWidth<Real>];
  simd::write_lanes(lanes, largest);
  double most = 0;
  for (const double l : lanes) most = l > most ? l : most;
  return most;
}

MembraneResult stretch_any(const ShellRows& s, const double* const x[3], const MembraneLaw& law, double thickness,
                           Index begin, Index end) {
  return visit_law(law, [&](const auto& l) { return stretch(s, x, l, thickness, begin, end); });
}

double bound_any(const ShellRows& s, const double* const x[3], const MembraneLaw& law, Index begin, Index end) {
  return visit_law(law, [&](const auto& l) { return bound(s, x, l, begin, end); });
}

}  // namespace

template <>
const FabricKernels& get_fabric_kernels<simd::Target>() {
  static constexpr FabricKernels kernels{stretch_any, bend, bound_any};
  return kernels;
}

}  // namespace interply::fabric
