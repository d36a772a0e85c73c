/// Hardening curves and the return to the yield surface for packs of points: hardening.hpp, j2_law.hpp and hill48.hpp
/// again, for kernel sources only (simd/pack.hpp). What a point gets does not depend on the others in its pack.
#pragma once

#include "simd/pack.hpp"
#include "solver_metal/law_constants.hpp"

namespace interply::metal {
namespace {

/// Through the thickness (lobatto.hpp).
inline constexpr int kMostPoints = 15;

/// sigma_y(p) and its first two derivatives, MPa.
template <class Real>
struct PackYield {
  Real stress, slope, bend;
};

struct SwiftCurve {
  CurveConstants c;
  template <class Real>
  PackYield<Real> operator()(const Real& p) const {
    const Real base = Real(c.offset) + p, per_base = Real(1.0) / base;
    const Real stress = Real(c.strength) * simd::exp(Real(c.exponent) * simd::log(base));  // (H1)
    const Real slope = Real(c.exponent) * stress * per_base;
    return {stress, slope, Real(c.exponent - 1) * slope * per_base};
  }
};

struct VoceCurve {
  CurveConstants c;
  template <class Real>
  PackYield<Real> operator()(const Real& p) const {
    const Real missing = Real(c.strength - c.start) * simd::exp(Real(-c.rate) * p);
    return {Real(c.strength) - missing, Real(c.rate) * missing, Real(-c.rate * c.rate) * missing};  // (H2)
  }
};

/// @pre p > 0
struct HockettSherbyCurve {
  CurveConstants c;
  template <class Real>
  PackYield<Real> operator()(const Real& p) const {
    const Real power = Real(c.rate) * simd::exp(Real(c.exponent) * simd::log(p)), per_p = Real(1.0) / p;
    const Real missing = Real(c.strength - c.start) * simd::exp(-power), growth = Real(c.exponent) * power * per_p;
    const Real slope = missing * growth;
    return {Real(c.strength) - missing, slope, slope * (Real(c.exponent - 1) * per_p - growth)};  // (H3)
  }
};

/// Point by point.
struct TableCurve {
  CurveConstants c;
  template <class Real>
  PackYield<Real> operator()(const Real& p) const {
    constexpr int kWidth = simd::kWidth<Real>;
    const simd::Lanes<Real, false> all(0, kWidth);
    double at[kWidth], stress[kWidth], slope[kWidth];
    all.store(at, p);
    for (int l = 0; l < kWidth; ++l) interpolate(at[l], stress[l], slope[l]);
    return {all.load(stress), all.load(slope), Real(0.0)};
  }

 private:
  void interpolate(double p, double& stress, double& slope) const {
    const double* right = c.points;  // the first point beyond p
    const double* const end = c.points + 2 * c.n_points;
    while (right < end && right[0] <= p) right += 2;
    if (right == c.points || right == end) {
      stress = right == end ? end[-1] : right[1];
      slope = 0;
      return;
    }
    const double* const left = right - 2;
    slope = (right[1] - left[1]) / (right[0] - left[0]);
    stress = left[1] + slope * (p - left[0]);
  }
};

/// body(curve) for the curve of a law.
template <class Body>
inline auto with_curve(const CurveConstants& c, const Body& body) {
  switch (c.curve) {
    case Curve::Swift:
      return body(SwiftCurve{c});
    case Curve::Voce:
      return body(VoceCurve{c});
    case Curve::HockettSherby:
      return body(HockettSherbyCurve{c});
    default:
      return body(TableCurve{c});
  }
}

/// Hardening of the points of a pack; see PlasticPoint.
template <class Real>
struct PackPoint {
  Real plastic_strain, yield_stress, yield_slope, multiplier;
};

/// Equivalent stress at the multiplier l and its first two derivatives: s_eq^2 = sum square_m / (1 + k_m l)^2, which
/// falls and is convex.
template <class Real>
struct PackEquivalent {
  Real stress, slope, bend;
};

template <int kModes, class Real>
inline PackEquivalent<Real> compute_equivalent(const Real (&k)[kModes], const Real (&square)[kModes], const Real& l) {
  const Real one(1.0);
  Real f[kModes], product = one;
  for (int m = 0; m < kModes; ++m) {
    f[m] = one + k[m] * l;
    product = product * f[m];
  }
  const Real inverse = one / product;  // one division for all modes
  Real sum(0.0), first(0.0), second(0.0);
  for (int m = 0; m < kModes; ++m) {
    Real shrink = inverse;
    for (int o = 0; o < kModes; ++o)
      if (o != m) shrink = shrink * f[o];
    const Real part = square[m] * shrink * shrink, fall = k[m] * shrink;
    sum += part;
    first += part * fall;
    second += part * fall * fall;
  }
  const Real stress = simd::sqrt(sum), per_stress = one / stress, slope = -first * per_stress;
  return {stress, slope, (Real(3.0) * second - slope * slope) * per_stress};
}

/// The return of the points of a pack, some of which may stay elastic.
template <int kModes, class Real>
struct PackReturn {
  Real square[kModes];    ///< share of each mode in s_eq^2 of the trial state, MPa2
  simd::Mask<Real> left;  ///< points still to return
  PackPoint<Real> start;
  PackPoint<Real> end;  ///< of the points that are through; the others are as they were, with a multiplier of 0
  Real l;               ///< of the points left, 1/MPa
};

/// Halley's step for g(l) = s_eq(l) - sigma_y(p + l s_eq(l)). g falls and is convex where the curve is concave; the
/// step is kept below twice Newton's and `next` above 0.
template <class Real>
struct PackStep {
  Real g, next;
  Real more;  ///< plastic strain of the step
};

template <class Real>
inline PackStep<Real> compute_step(const PackEquivalent<Real>& s, const PackYield<Real>& y, const Real& l) {
  const Real half(0.5), dp = s.stress + l * s.slope, ddp = s.slope + s.slope + l * s.bend;  // of p over l
  const Real g = s.stress - y.stress, g1 = s.slope - y.slope * dp;                          // (J3), (R5)
  const Real g2 = s.bend - y.slope * ddp - y.bend * dp * dp, square1 = g1 * g1;
  const Real step = -g * g1 / simd::max(square1 - half * g * g2, half * square1);
  return {g, simd::max(l + step, Real(0.125) * l), step * (dp + half * ddp * step)};
}

/// The first guess: the root for linear hardening, with equal rates where the excess is small, else after a step
/// with the true ones. It lies before the root of a concave curve.
template <int kModes, class Real>
inline void start_return(const Real (&k)[kModes], PackReturn<kModes, Real>& r) {
  constexpr double kSmallExcess = 0.03;  // of the yield stress
  Real trial2 = r.square[0], fall = r.square[0] * k[0];
  for (int m = 1; m < kModes; ++m) {
    trial2 += r.square[m];
    fall += r.square[m] * k[m];
  }
  const Real yield = r.start.yield_stress, zero(0.0);
  const Real trial = simd::sqrt(trial2), excess = trial - yield;
  const simd::Mask<Real> steep = r.start.yield_slope * trial2 > fall;  // it may be infinite
  const Real slope = simd::select(steep, zero, r.start.yield_slope);
  r.l = excess * trial2 / (trial * (fall + slope * trial2) - fall * excess);
  const simd::Mask<Real> large = r.left & (excess > Real(kSmallExcess) * yield);
  if (simd::any(large)) {
    const PackEquivalent<Real> s = compute_equivalent(k, r.square, r.l);
    r.l = simd::select(large, compute_step(s, {yield + slope * (r.l * s.stress), slope, zero}, r.l).next, r.l);
  }
  r.end = r.start;
  r.end.multiplier = zero;
}

/// One step towards the solution of (J3) or (R5). A point is through when g is below kNearlyConverged of its yield
/// stress and the step below kSmallStep of p, where Hockett-Sherby bends most: with sigma_y by its Taylor polynomial of
/// second degree it leaves about the cube of that.
/// @return whether points are left
template <int kModes, class Real, class Curve>
inline bool continue_return(const Curve& curve, const Real (&k)[kModes], PackReturn<kModes, Real>& r) {
  constexpr double kNearlyConverged = 1e-5, kSmallStep = 3e-4;
  const PackEquivalent<Real> s = compute_equivalent(k, r.square, r.l);
  const Real p = r.start.plastic_strain + r.l * s.stress;
  const PackYield<Real> y = curve(p);
  const PackStep<Real> step = compute_step(s, y, r.l);
  const simd::Mask<Real> through = r.left & (simd::abs(step.g) <= Real(kNearlyConverged) * y.stress) &
                                   (simd::abs(step.more) <= Real(kSmallStep) * p);
  if (simd::any(through)) {
    const Real yield = y.stress + step.more * (y.slope + Real(0.5) * y.bend * step.more);
    r.end.multiplier = simd::select(through, step.next, r.end.multiplier);
    r.end.plastic_strain = simd::select(through, p + step.more, r.end.plastic_strain);
    r.end.yield_stress = simd::select(through, yield, r.end.yield_stress);
    r.end.yield_slope = simd::select(through, y.slope + y.bend * step.more, r.end.yield_slope);
    r.left = r.left & !through;
  }
  r.l = step.next;
  return simd::any(r.left);
}

/// The points left, by the reference code.
template <int kModes, class Real>
inline void finish_return(const LawConstants& law, PackReturn<kModes, Real>& r) {
  constexpr int kWidth = simd::kWidth<Real>;
  const simd::Lanes<Real, false> all(0, kWidth);
  double square[kModes][kWidth], is_left[kWidth], p[kWidth], stress[kWidth], slope[kWidth], multiplier[kWidth] = {};
  for (int m = 0; m < kModes; ++m) all.store(square[m], r.square[m]);
  all.store(is_left, simd::select(r.left, Real(1.0), Real(0.0)));
  all.store(p, r.start.plastic_strain);
  all.store(stress, r.start.yield_stress);
  all.store(slope, r.start.yield_slope);
  for (int l = 0; l < kWidth; ++l) {
    if (is_left[l] == 0) continue;
    double own[kModes];
    for (int m = 0; m < kModes; ++m) own[m] = square[m][l];
    const PlasticPoint returned = return_to_yield_surface(law, own, {p[l], stress[l], slope[l]});
    p[l] = returned.plastic_strain;
    stress[l] = returned.yield_stress;
    slope[l] = returned.yield_slope;
    multiplier[l] = returned.multiplier;
  }
  r.end.plastic_strain = simd::select(r.left, all.load(p), r.end.plastic_strain);
  r.end.yield_stress = simd::select(r.left, all.load(stress), r.end.yield_stress);
  r.end.yield_slope = simd::select(r.left, all.load(slope), r.end.yield_slope);
  r.end.multiplier = simd::select(r.left, all.load(multiplier), r.end.multiplier);
}

/// Returns n independent packs, whose steps overlap in the processor.
template <int kModes, class Real, class Curve>
inline void return_packs(const LawConstants& law, const Curve& curve, const Real (&k)[kModes], int n,
                         PackReturn<kModes, Real>* r) {
  constexpr int kSteps = 6;
  PackReturn<kModes, Real>* left[kMostPoints];
  for (int i = 0; i < n; ++i) {
    start_return(k, r[i]);
    left[i] = &r[i];
  }
  for (int step = 0; step < kSteps && n > 0; ++step) {
    int kept = 0;
    for (int i = 0; i < n; ++i)
      if (continue_return(curve, k, *left[i])) left[kept++] = left[i];
    n = kept;
  }
  for (int i = 0; i < n; ++i) finish_return(law, *left[i]);
}

/// Symmetric2.
template <class Real>
struct PackTensor {
  Real m11, m22, m12;

  friend PackTensor operator+(const PackTensor& a, const PackTensor& b) {
    return {a.m11 + b.m11, a.m22 + b.m22, a.m12 + b.m12};
  }
  friend PackTensor operator-(const PackTensor& a, const PackTensor& b) {
    return {a.m11 - b.m11, a.m22 - b.m22, a.m12 - b.m12};
  }
  friend PackTensor operator*(const Real& s, const PackTensor& a) { return {s * a.m11, s * a.m22, s * a.m12}; }
};

/// J2, update_point() of j2_law.hpp.
template <class Real>
struct J2Pack {
  static constexpr int kModes = 2;
  explicit J2Pack(const LawConstants& law)
      : sum_modulus(law.sum_modulus),
        twice_shear(law.twice_shear),
        rate{Real(0.5 * law.sum_modulus), Real(1.5 * law.twice_shear)} {}

  Real sum_modulus, twice_shear, rate[kModes];

  /// Trial stress under the strain increment `de`, and the shares of its modes in s_eq^2.
  PackTensor<Real> compute_trial(const PackTensor<Real>& stress, const PackTensor<Real>& de,
                                 Real (&square)[kModes]) const {
    const Real half(0.5);
    const Real a = stress.m11 + stress.m22 + sum_modulus * (de.m11 + de.m22);
    const Real b = stress.m11 - stress.m22 + twice_shear * (de.m11 - de.m22), c = stress.m12 + twice_shear * de.m12;
    square[0] = Real(0.25) * a * a;
    square[1] = Real(0.75) * b * b + Real(3.0) * c * c;
    return {half * (a + b), half * (a - b), c};
  }
  /// Stress (J2) of points that return. @return plastic strain through the thickness with its sign turned
  Real shrink(const Real& l, PackTensor<Real>& s) const {
    const Real one(1.0), half(0.5), fa = one + rate[0] * l, fb = one + rate[1] * l, inverse = one / (fa * fb);
    const Real a = (s.m11 + s.m22) * (fb * inverse), b = (s.m11 - s.m22) * (fa * inverse);
    s = {half * (a + b), half * (a - b), s.m12 * (fa * inverse)};
    return half * l * a;
  }
};

/// Hill48, update_point() of hill48.hpp.
template <class Real>
struct Hill48Pack {
  static constexpr int kModes = 3;
  explicit Hill48Pack(const LawConstants& law)
      : law(law),
        sum_modulus(law.sum_modulus),
        twice_shear(law.twice_shear),
        rate{Real(law.rate[0]), Real(law.rate[1]), Real(law.rate[2])} {}

  const LawConstants& law;
  Real sum_modulus, twice_shear, rate[kModes];

  PackTensor<Real> compute_trial(const PackTensor<Real>& stress, const PackTensor<Real>& de,
                                 Real (&square)[kModes]) const {
    const Real half(0.5), a = sum_modulus * (de.m11 + de.m22), b = twice_shear * (de.m11 - de.m22);
    const PackTensor<Real> s = stress + PackTensor<Real>{half * (a + b), half * (a - b), twice_shear * de.m12};
    const Real y0 = to_mode(0, s), y1 = to_mode(1, s), y2 = Real(1 / law.shear_root) * s.m12;
    square[0] = rate[0] * y0 * y0;
    square[1] = rate[1] * y1 * y1;
    square[2] = rate[2] * y2 * y2;
    return s;
  }
  /// Stress (R4) of points that return.
  Real shrink(const Real& l, PackTensor<Real>& s) const {
    const Real one(1.0), f0 = one + rate[0] * l, f1 = one + rate[1] * l, f2 = one + rate[2] * l;
    const Real inverse = one / (f0 * f1 * f2);
    const Real y0 = to_mode(0, s) * (f1 * f2 * inverse), y1 = to_mode(1, s) * (f0 * f2 * inverse);
    s = {Real(law.from_mode[0][0]) * y0 + Real(law.from_mode[0][1]) * y1,
         Real(law.from_mode[1][0]) * y0 + Real(law.from_mode[1][1]) * y1, s.m12 * (f0 * f1 * inverse)};
    return l * (Real(1 - law.h) * s.m11 + Real(law.p - law.h) * s.m22);
  }

 private:
  Real to_mode(int i, const PackTensor<Real>& s) const {
    return Real(law.to_mode[i][0]) * s.m11 + Real(law.to_mode[i][1]) * s.m22;
  }
};

}  // namespace
}  // namespace interply::metal
