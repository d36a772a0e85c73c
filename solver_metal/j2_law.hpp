/// Plane-stress J2 plasticity with isotropic hardening: one material point, one increment.
///
/// Source: Simo & Taylor, Int. J. Numer. Meth. Engng 22 (1986); Simo & Hughes, Computational Inelasticity, box 3.3.
/// Their projection is diagonal in a = s11 + s22, b = s11 - s22, c = s12, which we use directly:
///
///   s_eq^2 = a^2/4 + 3 b^2/4 + 3 c^2                                                                   (J1)
///   a = a* / (1 + E/(2(1-nu)) l),  b = b* / (1 + 3G l),  c = c* / (1 + 3G l)                           (J2)
///   g(l) = s_eq(l) - sigma_y(p + l s_eq(l)) = 0,   dp = l s_eq                                         (J3)
///
/// where * is the elastic trial state and l = dp / s_eq >= 0. Where we differ: their consistency parameter is 3/2 l,
/// and we solve (J3) in s_eq, not in its square, which is nearly linear in l. s_eq(l) falls and l s_eq(l) rises
/// monotonically, so without softening (J3) has exactly one root.
#pragma once

#include <algorithm>
#include <cmath>

#include "solver_metal/hardening.hpp"
#include "solver_metal/symmetric2.hpp"

namespace interply::metal {

/// Elastic constants in the form the update needs, and the hardening curve.
struct J2Constants {
  explicit J2Constants(const scene::J2Law& law)
      : young(law.young),
        poisson(law.poisson),
        sum_modulus(law.young / (1 - law.poisson)),
        twice_shear(law.young / (1 + law.poisson)),
        hardening(law.hardening) {}

  double young;        ///< E, MPa
  double poisson;      ///< nu
  double sum_modulus;  ///< E/(1-nu): a over e11 + e22, MPa
  double twice_shear;  ///< 2G: b over e11 - e22 and c over e12, MPa
  scene::Hardening hardening;
};

/// State of one point. `yield` always equals sigma_y(plastic_strain), so that an elastic step never evaluates the
/// curve.
struct J2Point {
  Symmetric2 stress;          ///< Cauchy, plane stress, in the polar frame, MPa
  double plastic_strain = 0;  ///< p, equivalent
  YieldStress yield;          ///< sigma_y(p) and its slope
};

/// s_eq of (J1), MPa.
inline double compute_von_mises(const Symmetric2& s) {
  const double a = s.m11 + s.m22, b = s.m11 - s.m22;
  return std::sqrt(0.25 * a * a + 0.75 * b * b + 3 * s.m12 * s.m12);
}

/// Returns the trial invariants to the yield surface; called by update_point() for a state outside it.
/// @param quarter_a2  a*^2 / 4, MPa2
/// @param shear2      3 b*^2 / 4 + 3 c*^2, MPa2
/// @param point       plastic_strain and yield advance
/// @return l of (J3), 1/MPa
inline double update_plastic_strain(const J2Constants& law, double quarter_a2, double shear2, J2Point& point) {
  constexpr double kNearlyConverged = 1e-8;  // of (J3) / yield stress: one more linear step leaves its square
  constexpr int kMaxIterations = 80;         // the bracket alone is exhausted by then
  const double ka = 0.5 * law.sum_modulus, kb = 1.5 * law.twice_shear;
  const double trial = std::sqrt(quarter_a2 + shear2), excess = trial - point.yield.stress;
  // perfect plasticity with the softer of the two rates returns at least this far
  double low = 0, high = excess / (point.yield.stress * std::fmin(ka, kb));
  // first guess: exact for linear hardening where ka = kb
  const double rate = (quarter_a2 * ka + shear2 * kb) / (trial * trial);
  const double guess = excess / (rate + point.yield.slope);
  double l = std::clamp(guess / (trial - rate * guess), 0.0, high);
  double p = point.plastic_strain;
  YieldStress y = point.yield;
  for (int i = 0; i < kMaxIterations; ++i) {
    const double fa = 1 + ka * l, fb = 1 + kb * l, inverse = 1 / (fa * fb);  // one division for both of (J2)
    const double da = fb * inverse, db = fa * inverse;
    const double a2 = quarter_a2 * da * da, b2 = shear2 * db * db;
    const double equivalent = std::sqrt(a2 + b2);  // (J1), (J2)
    p = point.plastic_strain + l * equivalent;
    y = compute_yield_stress(law.hardening, p);
    const double g = equivalent - y.stress;  // (J3)
    const double fall = -(a2 * ka * da + b2 * kb * db) / equivalent, dp = equivalent + l * fall;
    const double step = -g / (fall - y.slope * dp);
    if (std::fabs(g) <= kNearlyConverged * y.stress) {
      l += step;
      p += dp * step;
      y.stress += y.slope * dp * step;
      break;
    }
    (g > 0 ? low : high) = l;
    l = l + step > low && l + step < high ? l + step : 0.5 * (low + high);
  }
  point.plastic_strain = p;
  point.yield = y;
  return l;
}

/// Advances a point by a strain increment in the polar frame.
/// @param de  logarithmic strain increment
/// @return thickness strain increment: -nu/E d(s11 + s22) - (dp11 + dp22), plastic flow being incompressible
inline double update_point(const J2Constants& law, const Symmetric2& de, J2Point& point) {
  const double a_old = point.stress.m11 + point.stress.m22;
  double a = a_old + law.sum_modulus * (de.m11 + de.m22);
  double b = point.stress.m11 - point.stress.m22 + law.twice_shear * (de.m11 - de.m22);
  double c = point.stress.m12 + law.twice_shear * de.m12;
  const double quarter_a2 = 0.25 * a * a, shear2 = 0.75 * b * b + 3 * c * c;
  double plastic = 0;
  if (quarter_a2 + shear2 > point.yield.stress * point.yield.stress) {
    const double l = update_plastic_strain(law, quarter_a2, shear2, point);
    a /= 1 + 0.5 * law.sum_modulus * l;  // (J2)
    b /= 1 + 1.5 * law.twice_shear * l;
    c /= 1 + 1.5 * law.twice_shear * l;
    plastic = 0.5 * l * a;
  }
  point.stress = {0.5 * (a + b), 0.5 * (a - b), c};
  return -law.poisson / law.young * (a - a_old) - plastic;
}

}  // namespace interply::metal
