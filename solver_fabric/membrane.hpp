/// Constant-strain membrane triangle in the fibre frame: F -> fibre stretches and shear -> stress -> nodal forces.
#pragma once

#include <cmath>

#include "mechanics/edge_shell.hpp"
#include "solver_fabric/woven_law.hpp"

namespace interply::fabric {

using mechanics::Vector3;

/// What the laws need of a deformation gradient with the columns f_a = F a0, f_b = F b0.
struct FibreState {
  double I4 = 1, I8 = 1;  ///< squared stretches, -
  double la = 1, lb = 1;  ///< stretches, -
  double gamma = 0;       ///< shear angle, positive where the fibres close in on each other, rad
  double cos_gamma = 1;
  double sin_gamma = 0;
};

/// gamma from its sine f_a.f_b/(la lb) and its cosine J/(la lb): exact at zero, odd, and accurate up to folding, where
/// asin of the sine alone is not.
/// @param area_ratio  J = |f_a x f_b|
inline FibreState compute_fibre_state(const Vector3& f_a, const Vector3& f_b, double area_ratio) {
  FibreState s;
  s.I4 = f_a.squaredNorm();
  s.I8 = f_b.squaredNorm();
  s.la = std::sqrt(s.I4);
  s.lb = std::sqrt(s.I8);
  const double dot = f_a.dot(f_b), scale = 1 / (s.la * s.lb);
  s.gamma = std::atan2(dot, area_ratio);
  s.sin_gamma = dot * scale;
  s.cos_gamma = area_ratio * scale;
  return s;
}

/// Second Piola-Kirchhoff stress in the fibre frame, MPa.
struct MembraneStress {
  double S11 = 0, S22 = 0, S12 = 0;
};

/// solver_fabric/THEORY.md: S11 = 2 W4, S22 = 2 W8, S12 = Wab. @pre |gamma| < 90 deg, stretches > 0
inline MembraneStress compute_membrane_stress(const Potential& w, const FibreState& s) {
  const double tau_tan = w.tau * s.sin_gamma / s.cos_gamma;
  return {w.W_a / s.la - tau_tan / s.I4, w.W_b / s.lb - tau_tan / s.I8, w.tau / (s.cos_gamma * s.la * s.lb)};
}

/// Internal forces of the three corners, N:
///   f_i = A t [ (S11 f_a + S12 f_b) dN_i/da + (S12 f_a + S22 f_b) dN_i/db ]
/// @param area_thickness  reference area x reference thickness, mm3
inline void compute_membrane_forces(const mechanics::ShellGeometry& shell, Eigen::Index e,
                                    const mechanics::SurfaceGradient& g, const MembraneStress& s, double area_thickness,
                                    Vector3 force[3]) {
  const Vector3 along_a = area_thickness * (s.S11 * g.f1 + s.S12 * g.f2);
  const Vector3 along_b = area_thickness * (s.S12 * g.f1 + s.S22 * g.f2);
  for (int k = 0; k < 3; ++k) force[k] = shell.gradient(2 * k, e) * along_a + shell.gradient(2 * k + 1, e) * along_b;
}

}  // namespace interply::fabric
