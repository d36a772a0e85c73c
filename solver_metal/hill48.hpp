/// Plane-stress plasticity of a rolled sheet, Hill's quadratic yield function of 1948 with isotropic hardening, over
/// `Real`: what the return (return_mapping.hpp) needs of it. All components are in the rolling frame: 1 along the
/// rolling direction, which turns with the material (polar frame).
///
/// Source: Hill, Proc. R. Soc. A 193 (1948). From the ratios r = width / thickness plastic strain of bars cut at 0, 45
/// and 90 deg to the rolling direction, with the yield stress of the *rolling direction* as reference:
///
///   s_eq^2 = s' P s = s11^2 - 2 h s11 s22 + p s22^2 + q s12^2                                           (R1)
///   h = r0/(1 + r0),   p = r0 (1 + r90)/(r90 (1 + r0)),   q = (r0 + r90)(1 + 2 r45)/(r90 (1 + r0))
///
/// r0 = r45 = r90 = 1 is J2. (R1) is convex for all positive r: q > 0, and
/// p - h^2 = h ((1 + r90)/r90 - h) > 0, as h < 1. Flow is associated, so a bar at the angle x has
///
///   s_yield(x) = sigma_y / sqrt(c^4 - 2 h c^2 s^2 + p s^4 + q c^2 s^2),   c = cos x, s = sin x          (R2)
///   r(x) = (h - (1 + p + 2 h - q) c^2 s^2) / ((1 - h) c^2 + (p - h) s^2)                                (R3)
///
/// Return to the surface. With the elastic tangent C and C^(1/2) P C^(1/2) = V diag(k) V', the modes y = V' C^(-1/2) s
/// do not mix:
///
///   y_i = y_i* / (1 + k_i l),    s_eq^2 = sum k_i y_i^2                                                 (R4)
///
/// where * is the elastic trial state.
#pragma once

#include "simd/pack.hpp"
#include "solver_metal/law_constants.hpp"
#include "solver_metal/symmetric2.hpp"

namespace interply::metal {
namespace {

template <class Real>
struct Hill48 {
  static constexpr int kModes = 3;
  explicit Hill48(const LawConstants& law)
      : law(law),
        sum_modulus(law.sum_modulus),
        twice_shear(law.twice_shear),
        rate{Real(law.rate[0]), Real(law.rate[1]), Real(law.rate[2])} {}

  const LawConstants& law;
  Real sum_modulus, twice_shear, rate[kModes];

  Tensor<Real> compute_trial(const Tensor<Real>& stress, const Tensor<Real>& de, Real (&square)[kModes]) const {
    const Real half(0.5), a = sum_modulus * (de.m11 + de.m22), b = twice_shear * (de.m11 - de.m22);
    const Tensor<Real> s = stress + Tensor<Real>{half * (a + b), half * (a - b), twice_shear * de.m12};
    const Real y0 = to_mode(0, s), y1 = to_mode(1, s), y2 = Real(1 / law.shear_root) * s.m12;
    square[0] = rate[0] * y0 * y0;
    square[1] = rate[1] * y1 * y1;
    square[2] = rate[2] * y2 * y2;
    return s;
  }
  /// Stress (R4) of points that return.
  Real shrink(const Real& l, Tensor<Real>& s) const {
    const Real one(1.0), f0 = one + rate[0] * l, f1 = one + rate[1] * l, f2 = one + rate[2] * l;
    const Real inverse = one / (f0 * f1 * f2);
    const Real y0 = to_mode(0, s) * (f1 * f2 * inverse), y1 = to_mode(1, s) * (f0 * f2 * inverse);
    s = {Real(law.from_mode[0][0]) * y0 + Real(law.from_mode[0][1]) * y1,
         Real(law.from_mode[1][0]) * y0 + Real(law.from_mode[1][1]) * y1, s.m12 * (f0 * f1 * inverse)};
    return l * (Real(1 - law.coefficients.h) * s.m11 + Real(law.coefficients.p - law.coefficients.h) * s.m22);
  }

 private:
  Real to_mode(int i, const Tensor<Real>& s) const {
    return Real(law.to_mode[i][0]) * s.m11 + Real(law.to_mode[i][1]) * s.m22;
  }
};

}  // namespace
}  // namespace interply::metal
