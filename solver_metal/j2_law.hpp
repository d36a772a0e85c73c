/// Plane-stress J2 plasticity with isotropic hardening, over `Real`: what the return (return_mapping.hpp) needs of it.
///
/// Source: Simo & Taylor, Int. J. Numer. Meth. Engng 22 (1986); Simo & Hughes, Computational Inelasticity, box 3.3.
/// Their projection is diagonal in a = s11 + s22, b = s11 - s22, c = s12, which we use directly:
///
///   s_eq^2 = a^2/4 + 3 b^2/4 + 3 c^2                                                                   (J1)
///   a = a* / (1 + E/(2(1-nu)) l),  b = b* / (1 + 3G l),  c = c* / (1 + 3G l)                           (J2)
///
/// where * is the elastic trial state and l = dp / s_eq >= 0. Where we differ: their consistency parameter is 3/2 l.
#pragma once

#include "simd/pack.hpp"
#include "solver_metal/law_constants.hpp"
#include "solver_metal/symmetric2.hpp"

namespace interply::metal {

/// s_eq of (J1), MPa.
inline double compute_von_mises(const Symmetric2& s) {
  const double a = s.m11 + s.m22, b = s.m11 - s.m22;
  return std::sqrt(0.25 * a * a + 0.75 * b * b + 3 * s.m12 * s.m12);
}

namespace {

template <class Real>
struct J2 {
  static constexpr int kModes = 2;
  explicit J2(const LawConstants& law)
      : sum_modulus(law.sum_modulus),
        twice_shear(law.twice_shear),
        rate{Real(0.5 * law.sum_modulus), Real(1.5 * law.twice_shear)} {}

  Real sum_modulus, twice_shear, rate[kModes];

  /// Trial stress under the strain increment `de`, and the shares of its modes in s_eq^2.
  Tensor<Real> compute_trial(const Tensor<Real>& stress, const Tensor<Real>& de, Real (&square)[kModes]) const {
    const Real half(0.5);
    const Real a = stress.m11 + stress.m22 + sum_modulus * (de.m11 + de.m22);
    const Real b = stress.m11 - stress.m22 + twice_shear * (de.m11 - de.m22), c = stress.m12 + twice_shear * de.m12;
    square[0] = Real(0.25) * a * a;
    square[1] = Real(0.75) * b * b + Real(3.0) * c * c;
    return {half * (a + b), half * (a - b), c};
  }
  /// Stress (J2) of points that return. @return plastic strain through the thickness with its sign turned
  Real shrink(const Real& l, Tensor<Real>& s) const {
    const Real one(1.0), half(0.5), fa = one + rate[0] * l, fb = one + rate[1] * l, inverse = one / (fa * fb);
    const Real a = (s.m11 + s.m22) * (fb * inverse), b = (s.m11 - s.m22) * (fa * inverse);
    s = {half * (a + b), half * (a - b), s.m12 * (fa * inverse)};
    return half * l * a;
  }
};

}  // namespace
}  // namespace interply::metal
