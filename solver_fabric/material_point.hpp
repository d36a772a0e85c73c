/// A woven ply at one material point, for calibration (`interply point`), for output and for tests: woven_law.hpp and
/// membrane.hpp on doubles.
#pragma once

#include <vector>

#include "mechanics/nodal.hpp"
#include "solver_fabric/membrane_law.hpp"

namespace interply::fabric {

/// State and response of a material point; energies and stresses in MPa.
struct FabricPoint {
  double I4 = 1, I8 = 1, gamma = 0;   ///< squared stretches, -; shear angle, rad
  double la = 1, lb = 1, cosine = 1;  ///< stretches; cosine of gamma, -
  double W = 0;                       ///< strain energy per reference volume
  double S11 = 0, S22 = 0, S12 = 0;   ///< second Piola-Kirchhoff stress in the fibre frame
  double smallest_eigenvalue = 0;     ///< of the Hessian of W in (la, lb, gamma); negative: the law is not convex
};

/// Deformation alone; energy and stress are 0.
/// @param f_a,f_b     F a0, F b0
/// @param area_ratio  J = |f_a x f_b|. @pre J > 0
FabricPoint compute_deformation(const mechanics::Vector3& f_a, const mechanics::Vector3& f_b, double area_ratio);

/// As compute_deformation(), with the response of `law`.
FabricPoint evaluate_point(const MembraneLaw& law, const mechanics::Vector3& f_a, const mechanics::Vector3& f_b,
                           double area_ratio);

/// @param F  in-plane deformation gradient in the fibre frame, columns F a0 and F b0. @pre det F > 0
FabricPoint evaluate_point(const MembraneLaw& law, const mechanics::Matrix2& F);

/// Response along a path of deformation gradients. The law has no memory: every point stands for itself.
std::vector<FabricPoint> follow_path(const scene::WovenLaw& law, const std::vector<mechanics::Matrix2>& path);

}  // namespace interply::fabric
