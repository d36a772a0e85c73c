/// Membrane laws of a woven ply as pure functions of the fibre stretches and the shear angle, over `Real`, which is a
/// double or a pack of them (simd/pack.hpp): the only text of the laws. Everything has internal linkage, as there.
///
/// Source: "Modeling multiaxial stress states in forming simulation of woven fabrics", eq. (1)-(11)
/// (solver_fabric/THEORY.md). Fibre stretches la = sqrt(I4), lb = sqrt(I8), fibre strains e = l - 1, shear angle gamma
/// = I10. Where we differ:
/// - "exp exp(x)" of the printed text is exp(x);
/// - odd powers of I10 in eq. (8), (9) are powers of |I10|, so that W does not depend on the sign of the shear;
/// - above `strain_cap`, exp(c e_t) of eq. (5), (6) goes on along its tangent (C1).
/// W is C1 everywhere, not C2 at la = 1 and lb = 1, where the stiffness jumps from 2 d to 2 b; l <= 1 is compression
/// (`tense` false).
#pragma once

#include "simd/pack.hpp"
#include "solver_fabric/membrane_law.hpp"

namespace interply::fabric {
namespace {

using simd::abs, simd::all, simd::exp, simd::max, simd::min, simd::select, simd::sqrt;
using simd::Mask;

/// A function of one variable: value, first and second derivative.
template <class Real>
struct Jet {
  Real f, d, dd;
};

/// Strain energy per reference volume with its first and second derivatives in (la, lb, gamma). All in MPa. What nobody
/// reads the compiler leaves out.
template <class Real>
struct Potential {
  Real W;
  Real W_a, W_b, tau;  ///< dW/dla, dW/dlb, dW/dgamma
  Real W_aa, W_bb, W_gg, W_ab, W_ag, W_bg;
};

/// Uniaxial energy N of one fibre direction: tension eq. (4), compression eq. (7). @param e  fibre strain
template <class Real>
Jet<Real> compute_fibre_energy(const FibreParameters& p, const Real& e, const Mask<Real>& tense) {
  const Real cubic = select(tense, Real(p.a), Real(0.0)) * e, square = select(tense, Real(p.b), Real(p.d));
  const Real two(2.0), three(3.0), six(6.0);
  return {(cubic + square) * e * e, (three * cubic + two * square) * e, six * cubic + two * square};
}

/// Biaxial factor k_TC on the tension of one direction, a function of the transverse strain: eq. (5), (6); one in
/// compression.
template <class Real>
Jet<Real> compute_biaxial_factor(const FibreParameters& p, const Real& transverse, const Mask<Real>& tense) {
  const Real one(1.0), zero(0.0), c(p.c);
  if (p.p_min == 1) return {one, zero, zero};
  const Real capped = min(transverse, Real(p.strain_cap)), q = Real(1 - p.p_min) * exp(c * capped);
  return {select(tense, Real(p.p_min) + q * (one + c * (transverse - capped)), one), select(tense, q * c, zero),
          select(tense && transverse <= Real(p.strain_cap), q * c * c, zero)};
}

/// Factor s_T (I - 1)^2 of the tension-shear energy, eq. (9); zero in compression. @param l,u  stretch, l^2 - 1
template <class Real>
Jet<Real> compute_tension_shear_factor(const FibreParameters& p, const Real& l, const Real& u,
                                       const Mask<Real>& tense) {
  const Real v = select(tense, u, Real(0.0));
  return {Real(p.s_T) * v * v, Real(4 * p.s_T) * l * v,
          select(tense, Real(p.s_T) * (Real(12.0) * l * l - Real(4.0)), Real(0.0))};
}

/// Reduction factor k_SC = exp(s_C (I - 1)^3) of the shear energy, eq. (10); one in tension. @param l,u  as above
template <class Real>
Jet<Real> compute_compression_shear_factor(const FibreParameters& p, const Real& l, const Real& u,
                                           const Mask<Real>& tense) {
  if (p.s_C == 0 || all(tense)) return {Real(1.0), Real(0.0), Real(0.0)};
  const Real v = select(tense, Real(0.0), u), k = exp(Real(p.s_C) * v * v * v);
  const Real h_d = Real(6 * p.s_C) * l * v * v;  // derivatives of the exponent
  const Real h_dd = Real(6 * p.s_C) * v * v + Real(24 * p.s_C) * l * l * v;
  return {k, k * h_d, k * (h_dd + h_d * h_d)};
}

/// Eq. (11), all four branches in one:
///   W = N_a(la) k_a(lb) + N_b(lb) k_b(la) + [W_S(gamma) + |gamma|^3/3 (A(la) + B(lb))] K_a(la) K_b(lb)
/// with N k eq. (2)-(7), W_S eq. (8), A, B eq. (9), K eq. (10).
template <class Real>
Potential<Real> evaluate(const InvariantLaw& law, const Real& la, const Real& lb, const Real& gamma) {
  const Real one(1.0), ea = la - one, eb = lb - one, ua = la * la - one, ub = lb * lb - one;
  const Mask<Real> tense_a = la > one, tense_b = lb > one;
  const Jet<Real> na = compute_fibre_energy(law.warp, ea, tense_a), nb = compute_fibre_energy(law.weft, eb, tense_b);
  const Jet<Real> ka = compute_biaxial_factor(law.warp, eb, tense_a);
  const Jet<Real> kb = compute_biaxial_factor(law.weft, ea, tense_b);
  const Jet<Real> ta = compute_tension_shear_factor(law.warp, la, ua, tense_a);
  const Jet<Real> tb = compute_tension_shear_factor(law.weft, lb, ub, tense_b);
  const Jet<Real> ca = compute_compression_shear_factor(law.warp, la, ua, tense_a);
  const Jet<Real> cb = compute_compression_shear_factor(law.weft, lb, ub, tense_b);

  const Real g = abs(gamma), sign = select(gamma < Real(0.0), Real(-1.0), one);
  const Real s0(law.s[0]), s1(law.s[1]), s2(law.s[2]), two(2.0);
  const Jet<Real> cube{g * g * g * Real(1.0 / 3), sign * g * g, two * g};
  const Real t = ta.f + tb.f;
  const Real p = g * g * (Real(0.5) * s0 + g * (Real(1.0 / 3) * s1 + g * Real(0.25) * s2)) + cube.f * t;
  const Real p_g = sign * g * (s0 + g * (s1 + t + g * s2));
  const Real p_gg = s0 + g * (two * (s1 + t) + g * Real(3.0) * s2);
  const Real p_a = cube.f * ta.d, p_b = cube.f * tb.d, q_a = p_a * ca.f + p * ca.d, q_b = p_b * cb.f + p * cb.d;
  Potential<Real> w;
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

/// Piecewise linear T(x), lane by lane: f its exact integral from 0 to x, d = T(x), dd its slope.
template <class Real>
Jet<Real> evaluate(const Curve& curve, const Real& at) {
  constexpr int kWidth = simd::kWidth<Real>;
  alignas(64) double x[kWidth], f[kWidth], d[kWidth], dd[kWidth];
  const double *const points = curve.x.data(), *const value = curve.value.data();
  simd::write_lanes(x, at);
  for (int l = 0; l < kWidth; ++l) {
    int low = 0, high = static_cast<int>(curve.x.size()) - 1;  // straight on beyond both ends
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      (points[middle] <= x[l] ? low : high) = middle;
    }
    const double t = x[l] - points[low];
    dd[l] = (value[high] - value[low]) / (points[high] - points[low]);
    f[l] = curve.integral[low] + t * (value[low] + dd[l] * t / 2);
    d[l] = value[low] + dd[l] * t;
  }
  return {simd::read_lanes<Real>(f), simd::read_lanes<Real>(d), simd::read_lanes<Real>(dd)};
}

/// Variant `fabric`: W = int T11 de_a + int T22 de_b + int T12 d|gamma|.
template <class Real>
Potential<Real> evaluate(const TableLaw& law, const Real& la, const Real& lb, const Real& gamma) {
  const Jet<Real> na = evaluate(law.warp, la - Real(1.0)), nb = evaluate(law.weft, lb - Real(1.0));
  const Jet<Real> s = evaluate(law.shear, abs(gamma));
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

/// Of one point alone.
template <class Real>
Potential<Real> evaluate(const MembraneLaw& law, const Real& la, const Real& lb, const Real& gamma) {
  return visit_law(law, [&](const auto& l) { return evaluate(l, la, lb, gamma); });
}

}  // namespace
}  // namespace interply::fabric
