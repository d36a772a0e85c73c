/// Return to the yield surface, over `Real`, one double or a pack of them (simd/pack.hpp). A law brings it modes that
/// return on their own, each with its rate k_m and its share in s_eq^2 of the elastic trial state (j2_law.hpp,
/// hill48.hpp):
///
///   s_eq^2(l) = sum square_m / (1 + k_m l)^2
///   g(l) = s_eq(l) - sigma_y(p + l s_eq(l)) = 0,   dp = l s_eq                                         (J3)
///
/// We solve (J3) in s_eq, not in its square as Simo & Taylor: it is nearly linear in l. s_eq(l) falls and l s_eq(l)
/// rises monotonically, so without softening (J3) has exactly one root. Halley's method finds it; a point at which it
/// does not converge is bracketed. What a point gets does not depend on the others in its pack.
#pragma once

#include <algorithm>
#include <limits>

#include "solver_metal/hardening.hpp"
#include "solver_metal/law_constants.hpp"

namespace interply::metal {
namespace {

/// Through the thickness (lobatto.hpp).
inline constexpr int kMostPoints = 15;

/// Equivalent stress at the multiplier l and its first two derivatives: s_eq^2 = sum square_m / (1 + k_m l)^2, which
/// falls and is convex.
template <class Real>
struct Equivalent {
  Real stress, slope, bend;
};

template <int kModes, class Real>
inline Equivalent<Real> compute_equivalent(const Real (&k)[kModes], const Real (&square)[kModes], const Real& l) {
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
struct Return {
  Real square[kModes];    ///< share of each mode in s_eq^2 of the trial state, MPa2
  simd::Mask<Real> left;  ///< points still to return
  Plastic<Real> start;
  Plastic<Real> end;  ///< of the points that are through; the others are as they were, with a multiplier of 0
  Real l;             ///< of the points left, 1/MPa
};

/// Halley's step for g(l) = s_eq(l) - sigma_y(p + l s_eq(l)). g falls and is convex where the curve is concave; the
/// step is kept below twice Newton's and `next` above 0.
template <class Real>
struct Step {
  Real g, next;
  Real more;  ///< plastic strain of the step
};

template <class Real>
inline Step<Real> compute_step(const Equivalent<Real>& s, const YieldStress<Real>& y, const Real& l) {
  const Real half(0.5), dp = s.stress + l * s.slope, ddp = s.slope + s.slope + l * s.bend;  // of p over l
  const Real g = s.stress - y.stress, g1 = s.slope - y.slope * dp;                          // (J3)
  const Real g2 = s.bend - y.slope * ddp - y.bend * dp * dp, square1 = g1 * g1;
  const Real step = -g * g1 / simd::max(square1 - half * g * g2, half * square1);
  return {g, simd::max(l + step, Real(0.125) * l), step * (dp + half * ddp * step)};
}

/// The first guess: the root for linear hardening, with equal rates where the excess is small, else after a step
/// with the true ones. It lies before the root of a concave curve.
template <int kModes, class Real>
inline void start_return(const Real (&k)[kModes], Return<kModes, Real>& r) {
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
    const Equivalent<Real> s = compute_equivalent(k, r.square, r.l);
    r.l = simd::select(large, compute_step(s, {yield + slope * (r.l * s.stress), slope, zero}, r.l).next, r.l);
  }
  r.end = r.start;
  r.end.multiplier = zero;
}

/// One step towards the solution of (J3). A point is through when g is below kNearlyConverged of its yield
/// stress and the step below kSmallStep of p, where Hockett-Sherby bends most: with sigma_y by its Taylor polynomial of
/// second degree it leaves about the cube of that.
/// @return whether points are left
template <int kModes, class Real, class Curve>
inline bool continue_return(const Curve& curve, const Real (&k)[kModes], Return<kModes, Real>& r) {
  constexpr double kNearlyConverged = 1e-5, kSmallStep = 3e-4;
  const Equivalent<Real> s = compute_equivalent(k, r.square, r.l);
  const Real p = r.start.strain + r.l * s.stress;
  const YieldStress<Real> y = curve(p);
  const Step<Real> step = compute_step(s, y, r.l);
  const simd::Mask<Real> through = r.left & (simd::abs(step.g) <= Real(kNearlyConverged) * y.stress) &
                                   (simd::abs(step.more) <= Real(kSmallStep) * p);
  if (simd::any(through)) {
    const Real yield = y.stress + step.more * (y.slope + Real(0.5) * y.bend * step.more);
    r.end.multiplier = simd::select(through, step.next, r.end.multiplier);
    r.end.strain = simd::select(through, p + step.more, r.end.strain);
    r.end.yield_stress = simd::select(through, yield, r.end.yield_stress);
    r.end.yield_slope = simd::select(through, y.slope + y.bend * step.more, r.end.yield_slope);
    r.left = r.left & !through;
  }
  r.l = step.next;
  return simd::any(r.left);
}

/// One point by Newton's method with bisection. @param start  below the trial state
template <int kModes, class Curve>
inline Plastic<double> return_bracketed(const Curve& curve, const double (&k)[kModes], const double (&square)[kModes],
                                        const Plastic<double>& start) {
  constexpr double kNearlyConverged = 1e-8;  // of (J3) / yield stress: one more linear step leaves its square
  constexpr int kMaxIterations = 80;         // the bracket alone is exhausted by then
  const Equivalent<double> trial = compute_equivalent(k, square, 0.0);
  // perfect plasticity with the softest of the rates returns at least this far
  double low = 0, high = (trial.stress / start.yield_stress - 1) / *std::min_element(k, k + kModes);
  // first guess: exact for linear hardening where all rates are equal
  const double rate = -trial.slope / trial.stress,
               guess = (trial.stress - start.yield_stress) / (rate + start.yield_slope);
  double l = std::clamp(guess / (trial.stress - rate * guess), std::numeric_limits<double>::min(), high);
  Plastic<double> end = start;
  for (int i = 0; i < kMaxIterations; ++i) {
    const Equivalent<double> s = compute_equivalent(k, square, l);
    const double p = start.strain + l * s.stress;
    const YieldStress<double> y = curve(p);
    const double g = s.stress - y.stress;  // (J3)
    const double dp = s.stress + l * s.slope, step = -g / (s.slope - y.slope * dp);
    if (std::fabs(g) <= kNearlyConverged * y.stress)
      return {p + dp * step, y.stress + y.slope * dp * step, y.slope, l + step};
    end = {p, y.stress, y.slope, l};
    (g > 0 ? low : high) = l;
    l = l + step > low && l + step < high ? l + step : 0.5 * (low + high);
  }
  return end;
}

/// The points left, by return_to_yield_surface().
template <int kModes, class Real>
inline void finish_return(const LawConstants& law, Return<kModes, Real>& r) {
  constexpr int kWidth = simd::kWidth<Real>;
  const simd::Lanes<Real, false> all(0, kWidth);
  double square[kModes][kWidth], is_left[kWidth], p[kWidth], stress[kWidth], slope[kWidth], multiplier[kWidth] = {};
  for (int m = 0; m < kModes; ++m) all.store(square[m], r.square[m]);
  all.store(is_left, simd::select(r.left, Real(1.0), Real(0.0)));
  all.store(p, r.start.strain);
  all.store(stress, r.start.yield_stress);
  all.store(slope, r.start.yield_slope);
  for (int l = 0; l < kWidth; ++l) {
    if (is_left[l] == 0) continue;
    double own[kModes];
    for (int m = 0; m < kModes; ++m) own[m] = square[m][l];
    const Plastic<double> returned = return_to_yield_surface(law, own, {p[l], stress[l], slope[l], 0});
    p[l] = returned.strain;
    stress[l] = returned.yield_stress;
    slope[l] = returned.yield_slope;
    multiplier[l] = returned.multiplier;
  }
  r.end.strain = simd::select(r.left, all.load(p), r.end.strain);
  r.end.yield_stress = simd::select(r.left, all.load(stress), r.end.yield_stress);
  r.end.yield_slope = simd::select(r.left, all.load(slope), r.end.yield_slope);
  r.end.multiplier = simd::select(r.left, all.load(multiplier), r.end.multiplier);
}

/// Returns n independent packs, whose steps overlap in the processor.
template <int kModes, class Real, class Curve>
inline void return_packs(const LawConstants& law, const Curve& curve, const Real (&k)[kModes], int n,
                         Return<kModes, Real>* r) {
  constexpr int kSteps = 6;
  Return<kModes, Real>* left[kMostPoints];
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

}  // namespace
}  // namespace interply::metal
