#include "solver_fabric/fabric_kernels.hpp"

#include "mechanics/shell_kernels.hpp"

namespace interply::fabric {
namespace {

using namespace simd;
using mechanics::ShellRows;
using Real = Pack;

/// Potential of woven_law.hpp; what nobody reads the compiler leaves out.
struct Energy {
  Real W, W_a, W_b, tau;
  Real W_aa, W_bb, W_gg, W_ab, W_ag, W_bg;
};

/// A function of one variable: value, first and second derivative.
struct Jet {
  Real f, d, dd;
};

Jet compute_fibre_energy(const FibreParameters& p, const Real& e, const Mask<Real>& tense) {
  const Real cubic = select(tense, Real(p.a), Real(0.0)) * e, square = select(tense, Real(p.b), Real(p.d));
  const Real two(2.0), three(3.0), six(6.0);
  return {(cubic + square) * e * e, (three * cubic + two * square) * e, six * cubic + two * square};
}

Jet compute_biaxial_factor(const FibreParameters& p, const Real& transverse, const Mask<Real>& tense) {
  const Real one(1.0), zero(0.0), c(p.c);
  if (p.p_min == 1) return {one, zero, zero};
  const Real capped = min(transverse, Real(p.strain_cap)), q = Real(1 - p.p_min) * exp(c * capped);
  return {select(tense, Real(p.p_min) + q * (one + c * (transverse - capped)), one), select(tense, q * c, zero),
          select(tense && transverse <= Real(p.strain_cap), q * c * c, zero)};
}

Jet compute_tension_shear_factor(const FibreParameters& p, const Real& l, const Real& u, const Mask<Real>& tense) {
  const Real v = select(tense, u, Real(0.0));
  return {Real(p.s_T) * v * v, Real(4 * p.s_T) * l * v,
          select(tense, Real(p.s_T) * (Real(12.0) * l * l - Real(4.0)), Real(0.0))};
}

Jet compute_compression_shear_factor(const FibreParameters& p, const Real& l, const Real& u, const Mask<Real>& tense) {
  if (p.s_C == 0 || all(tense)) return {Real(1.0), Real(0.0), Real(0.0)};
  const Real v = select(tense, Real(0.0), u), k = exp(Real(p.s_C) * v * v * v);
  const Real h_d = Real(6 * p.s_C) * l * v * v;  // derivatives of the exponent
  const Real h_dd = Real(6 * p.s_C) * v * v + Real(24 * p.s_C) * l * l * v;
  return {k, k * h_d, k * (h_dd + h_d * h_d)};
}

/// InvariantLaw::evaluate().
Energy evaluate(const InvariantParameters& law, const Real& la, const Real& lb, const Real& gamma) {
  const Real one(1.0), ea = la - one, eb = lb - one, ua = la * la - one, ub = lb * lb - one;
  const Mask<Real> tense_a = la > one, tense_b = lb > one;
  const Jet na = compute_fibre_energy(law.warp, ea, tense_a), nb = compute_fibre_energy(law.weft, eb, tense_b);
  const Jet ka = compute_biaxial_factor(law.warp, eb, tense_a), kb = compute_biaxial_factor(law.weft, ea, tense_b);
  const Jet ta = compute_tension_shear_factor(law.warp, la, ua, tense_a);
  const Jet tb = compute_tension_shear_factor(law.weft, lb, ub, tense_b);
  const Jet ca = compute_compression_shear_factor(law.warp, la, ua, tense_a);
  const Jet cb = compute_compression_shear_factor(law.weft, lb, ub, tense_b);

  const Real g = abs(gamma), sign = select(gamma < Real(0.0), Real(-1.0), one);
  const Real s0(law.s[0]), s1(law.s[1]), s2(law.s[2]), two(2.0);
  const Jet cube{g * g * g * Real(1.0 / 3), sign * g * g, two * g};
  const Real t = ta.f + tb.f;
  const Real p = g * g * (Real(0.5) * s0 + g * (Real(1.0 / 3) * s1 + g * Real(0.25) * s2)) + cube.f * t;
  const Real p_g = sign * g * (s0 + g * (s1 + t + g * s2));
  const Real p_gg = s0 + g * (two * (s1 + t) + g * Real(3.0) * s2);
  const Real p_a = cube.f * ta.d, p_b = cube.f * tb.d, q_a = p_a * ca.f + p * ca.d, q_b = p_b * cb.f + p * cb.d;
  Energy w;
  w.W = na.f * ka.f + nb.f * kb.f + p * ca.f * cb.f;
  w.W_a = na.d * ka.f + nb.f * kb.d + q_a * cb.f;
  w.W_b = na.f * ka.d + nb.d * kb.f + q_b * ca.f;
  w.tau = p_g * ca.f * cb.f;
  w.W_aa = na.dd * ka.f + nb.f * kb.dd + (cube.f * ta.dd * ca.f + two * p_a * ca.d + p * ca.dd) * cb.f;
  w.W_bb = na.f * ka.dd + nb.dd * kb.f + (cube.f * tb.dd * cb.f + two * p_b * cb.d + p * cb.dd) * ca.f;
  w.W_gg = p_gg * ca.f * cb.f;
  w.W_ab = na.d * ka.d + nb.d * kb.d + p_a * ca.f * cb.d + p_b * ca.d * cb.f + p * ca.d * cb.d;
  w.W_ag = (cube.d * ta.d * ca.f + p_g * ca.d) * cb.f;
  w.W_bg = (cube.d * tb.d * cb.f + p_g * cb.d) * ca.f;
  return w;
}

/// PiecewiseLinear::evaluate(), lane by lane.
Jet evaluate(const CurveView& curve, const Real& at) {
  alignas(64) double x[kWidth<Real>], f[kWidth<Real>], d[kWidth<Real>], dd[kWidth<Real>];
  write_lanes(x, at);
  for (int l = 0; l < kWidth<Real>; ++l) {
    int low = 0, high = curve.n - 1;  // straight on beyond both ends
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      (curve.x[middle] <= x[l] ? low : high) = middle;
    }
    const double t = x[l] - curve.x[low];
    dd[l] = (curve.value[high] - curve.value[low]) / (curve.x[high] - curve.x[low]);
    f[l] = curve.integral[low] + t * (curve.value[low] + dd[l] * t / 2);
    d[l] = curve.value[low] + dd[l] * t;
  }
  return {read_lanes<Real>(f), read_lanes<Real>(d), read_lanes<Real>(dd)};
}

/// TableLaw::evaluate().
Energy evaluate(const TableParameters& law, const Real& la, const Real& lb, const Real& gamma) {
  const Jet na = evaluate(law.warp, la - Real(1.0)), nb = evaluate(law.weft, lb - Real(1.0));
  const Jet s = evaluate(law.shear, abs(gamma));
  const Real zero(0.0);
  return {.W = na.f + nb.f + s.f,
          .W_a = na.d,
          .W_b = nb.d,
          .tau = select(gamma < zero, -s.d, s.d),
          .W_aa = na.dd,
          .W_bb = nb.dd,
          .W_gg = s.dd,
          .W_ab = zero,
          .W_ag = zero,
          .W_bg = zero};
}

/// FibreState of membrane.hpp and what the stress needs of it.
struct Fibres {
  Real la, lb, inverse_a, inverse_b, inverse_area;
  Real product;  ///< f_a . f_b
  Real gamma, cosine;
};

Fibres compute_fibres(const mechanics::Facet<Real>& f) {
  Fibres s;
  s.la = sqrt(dot(f.f1, f.f1));
  s.lb = sqrt(dot(f.f2, f.f2));
  s.product = dot(f.f1, f.f2);
  s.inverse_a = Real(1.0) / s.la;
  s.inverse_b = Real(1.0) / s.lb;
  s.inverse_area = Real(1.0) / f.area_ratio;
  s.gamma = atan(s.product * s.inverse_area);
  s.cosine = f.area_ratio * s.inverse_a * s.inverse_b;
  return s;
}

/// Second Piola-Kirchhoff, MPa.
struct Stress {
  Real S11, S22, S12;
};

/// S11 = W_a/la - tau tan(gamma)/I4, S22 alike, S12 = tau/(cos(gamma) la lb); cos(gamma) = J/(la lb).
Stress compute_stress(const Energy& w, const Fibres& s) {
  const Real S12 = w.tau * s.inverse_area, turned = S12 * s.product;
  return {(w.W_a - turned * s.inverse_a) * s.inverse_a, (w.W_b - turned * s.inverse_b) * s.inverse_b, S12};
}

/// First of the lanes where `good` is false.
int find_bad_lane(const Mask<Real>& good) {
  alignas(64) double bad[kWidth<Real>];
  write_lanes(bad, select(good, Real(0.0), Real(1.0)));
  int l = 0;
  while (bad[l] == 0) ++l;
  return l;
}

template <class Law>
MembraneResult stretch(const ShellRows& s, const double* const x[3], const Law& law, double thickness, Index begin,
                       Index end) {
  MembraneResult result;
  Sum<Real> energy(begin);
  for_each_pack<Real>(begin, end, [&](const auto& lanes) {
    const mechanics::Facet<Real> f = mechanics::compute_facet<Real>(s, lanes, x);
    mechanics::store_facet(s, lanes, f);
    const Fibres fibres = compute_fibres(f);
    const Energy w = evaluate(law, fibres.la, fibres.lb, fibres.gamma);
    const Stress S = compute_stress(w, fibres);
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

/// Symmetric 2 x 2 matrix.
struct Symmetric {
  Real m11, m22, m12;
};

/// Of the product of two symmetric matrices, one of them positive definite.
Real compute_largest_eigenvalue(const Symmetric& a, const Symmetric& b) {
  const Real half = Real(0.5) * (a.m11 * b.m11 + a.m22 * b.m22) + a.m12 * b.m12;
  const Real determinant = (a.m11 * a.m22 - a.m12 * a.m12) * (b.m11 * b.m22 - b.m12 * b.m12);
  return half + sqrt(max(Real(0.0), half * half - determinant));
}

/// Of H Q, H symmetric and Q positive definite, both 3 x 3: from the right end of the interval that holds the roots of
/// the characteristic polynomial, m + 2 p, Newton's method comes down to the largest one and never below it. Eight
/// steps leave at most p/256 (a double root), else round-off.
Real compute_largest_eigenvalue(const Real (&h)[6], const Real (&q)[6]) {
  // order 11, 22, 33, 12, 13, 23
  const auto determinant = [](const Real(&a)[6]) {
    return a[0] * (a[1] * a[2] - a[5] * a[5]) - a[3] * (a[3] * a[2] - a[5] * a[4]) + a[4] * (a[3] * a[5] - a[1] * a[4]);
  };
  const Real m00 = h[0] * q[0] + h[3] * q[3] + h[4] * q[4], m01 = h[0] * q[3] + h[3] * q[1] + h[4] * q[5];
  const Real m02 = h[0] * q[4] + h[3] * q[5] + h[4] * q[2], m10 = h[3] * q[0] + h[1] * q[3] + h[5] * q[4];
  const Real m11 = h[3] * q[3] + h[1] * q[1] + h[5] * q[5], m12 = h[3] * q[4] + h[1] * q[5] + h[5] * q[2];
  const Real m20 = h[4] * q[0] + h[5] * q[3] + h[2] * q[4], m21 = h[4] * q[3] + h[5] * q[1] + h[2] * q[5];
  const Real m22 = h[4] * q[4] + h[5] * q[5] + h[2] * q[2];
  const Real trace = m00 + m11 + m22, product = determinant(h) * determinant(q);
  const Real minors = m00 * m11 - m01 * m10 + m00 * m22 - m02 * m20 + m11 * m22 - m12 * m21;
  const Real mean = Real(1.0 / 3) * trace, p = sqrt(max(Real(0.0), mean * mean - Real(1.0 / 3) * minors));
  Real root = mean + Real(2.0) * p;
  for (int i = 0; i < 8; ++i) {
    const Real value = ((root - trace) * root + minors) * root - product;
    const Real slope = (Real(3.0) * root - Real(2.0) * trace) * root + minors;
    root = select(value > Real(0.0) && slope > Real(0.0), root - value / slope, root);
  }
  return root;
}

/// compute_membrane_eigenvalue_bound() of stable_increment.hpp: the largest of the elements [begin, end).
template <class Law>
double bound(const ShellRows& s, const double* const x[3], const Law& law, const double (&floor)[2], Index begin,
             Index end) {
  Real largest(0.0);
  for_each_pack<Real>(begin, end, [&](const auto& lanes) {
    const auto f = mechanics::compute_facet<Real>(s, lanes, x);
    const auto n = mechanics::load_gradient<Real>(s, lanes);
    Symmetric g{Real(0.0), Real(0.0), Real(0.0)};
    for (int k = 0; k < 3; ++k) {
      g.m11 += n.n1[k] * n.n1[k];
      g.m22 += n.n2[k] * n.n2[k];
      g.m12 += n.n1[k] * n.n2[k];
    }
    const Fibres b = compute_fibres(f);
    const Energy w = evaluate(law, b.la, b.lb, b.gamma);
    const Stress S = compute_stress(w, b);
    const Real inverse_ab = b.inverse_a * b.inverse_b, sine = b.product * inverse_ab;
    const Symmetric scaled{g.m11 * b.inverse_a * b.inverse_a, g.m22 * b.inverse_b * b.inverse_b, g.m12 * inverse_ab};
    const Real h[6] = {max(w.W_aa, Real(floor[0])), max(w.W_bb, Real(floor[1])), w.W_gg, w.W_ab, w.W_ag, w.W_bg};
    const Real q[6] = {g.m11,
                       g.m22,
                       scaled.m11 + scaled.m22 - Real(2.0) * sine * scaled.m12,
                       sine * g.m12,
                       b.cosine * g.m12 * b.inverse_b,
                       b.cosine * g.m12 * b.inverse_a};
    const Real zero(0.0), one(1.0);
    const Symmetric identity{one, one, zero};
    const Real across = max(zero, max(w.W_a * b.inverse_a, w.W_b * b.inverse_b));
    const Real in_plane = max(zero, compute_largest_eigenvalue(h, q)) +
                          across * compute_largest_eigenvalue(identity, g) +
                          abs(w.tau) * compute_largest_eigenvalue(identity, scaled);
    largest = max(largest, max(in_plane, compute_largest_eigenvalue({S.S11, S.S22, S.S12}, g)));
  });
  alignas(64) double lanes[kWidth<Real>];
  write_lanes(lanes, largest);
  double most = 0;
  for (const double l : lanes) most = l > most ? l : most;
  return most;
}

}  // namespace

template <>
const FabricKernels& get_fabric_kernels<simd::Target>() {
  static constexpr FabricKernels kernels{stretch<InvariantParameters>, stretch<TableParameters>, bend,
                                         bound<InvariantParameters>, bound<TableParameters>};
  return kernels;
}

}  // namespace interply::fabric
