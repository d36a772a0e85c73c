/// Plane-stress plasticity of a rolled sheet, Hill's quadratic yield function of 1948 with isotropic hardening: one
/// material point, one increment. All components are in the rolling frame: 1 along the rolling direction, which turns
/// with the material (polar frame).
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
///   g(l) = s_eq(l) - sigma_y(p + l s_eq(l)) = 0,   dp = l s_eq                                          (R5)
///
/// where * is the elastic trial state. As for J2 (j2_law.hpp), s_eq(l) falls and l s_eq(l) rises, so without softening
/// (R5) has exactly one root.
#pragma once

#include <array>

#include "solver_metal/j2_law.hpp"

namespace interply::metal {

/// Coefficients of (R1).
struct Hill48Coefficients {
  double h = 0.5, p = 1, q = 3;
};

/// @pre all r > 0
Hill48Coefficients compute_hill48_coefficients(const scene::Hill48& r);

/// s_eq of (R1), MPa.
inline double compute_hill48(const Hill48Coefficients& c, const Symmetric2& s) {
  return std::sqrt(s.m11 * s.m11 - 2 * c.h * s.m11 * s.m22 + c.p * s.m22 * s.m22 + c.q * s.m12 * s.m12);
}

/// What the update needs: elasticity and hardening of `j2`, the coefficients, and the modes of (R4).
struct Hill48Constants {
  /// @pre law.hill48
  explicit Hill48Constants(const scene::J2Law& law);

  J2Constants j2;
  Hill48Coefficients coefficients;
  std::array<double, 3> rate{};               ///< k_i, MPa; the third is the shear
  double to_mode[2][2]{}, from_mode[2][2]{};  ///< V' C^(-1/2) and C^(1/2) V of (s11, s22)
  double shear_root = 0;                      ///< sqrt(G): s12 = shear_root y_3
};

/// Returns the trial modes to the yield surface; called by update_point() for a state outside it.
/// @param square  k_i y_i*^2, MPa2
/// @param point   plastic_strain and yield advance
/// @return l of (R5), 1/MPa
double update_plastic_strain(const Hill48Constants& law, const std::array<double, 3>& square, J2Point& point);

/// Advances a point by a strain increment in the rolling frame.
/// @param de  logarithmic strain increment
/// @return thickness strain increment: -nu/E d(s11 + s22) - (dp11 + dp22), plastic flow being incompressible
double update_point(const Hill48Constants& law, const Symmetric2& de, J2Point& point);

}  // namespace interply::metal
