/// A woven law at one material point, for calibration (`interply point`) and for tests.
#pragma once

#include <Eigen/LU>
#include <variant>
#include <vector>

#include "solver_fabric/membrane.hpp"

namespace interply::fabric {

/// State and response of a material point; energies and stresses in MPa.
struct FabricPoint {
  double I4 = 1, I8 = 1, gamma = 0;  ///< -, -, rad
  double W = 0;                      ///< strain energy per reference volume
  double S11 = 0, S22 = 0, S12 = 0;  ///< second Piola-Kirchhoff stress in the fibre frame
  double smallest_eigenvalue = 0;    ///< of the Hessian of W in (la, lb, gamma)
};

/// @param F  in-plane deformation gradient in the fibre frame, columns F a0 and F b0. @pre det F > 0
inline FabricPoint evaluate_point(const MembraneLaw& law, const mechanics::Matrix2& F) {
  const FibreState s = compute_fibre_state({F(0, 0), F(1, 0), 0}, {F(0, 1), F(1, 1), 0}, F.determinant());
  const Potential w = std::visit([&](const auto& l) { return l.evaluate(s.la, s.lb, s.gamma); }, law);
  const MembraneStress S = compute_membrane_stress(w, s);
  return {s.I4, s.I8, s.gamma, w.W, S.S11, S.S22, S.S12, compute_smallest_eigenvalue(w)};
}

/// Response along a path of deformation gradients. The law has no memory: every point stands for itself.
inline std::vector<FabricPoint> follow_path(const scene::WovenLaw& law, const std::vector<mechanics::Matrix2>& path) {
  const MembraneLaw membrane = make_membrane_law(law);
  std::vector<FabricPoint> points;
  points.reserve(path.size());
  for (const auto& F : path) points.push_back(evaluate_point(membrane, F));
  return points;
}

}  // namespace interply::fabric
