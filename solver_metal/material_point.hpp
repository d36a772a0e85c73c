/// One material point of a sheet: an increment of its law, and uniaxial tension, for calibration.
#pragma once

#include <vector>

#include "solver_metal/hardening.hpp"
#include "solver_metal/law_constants.hpp"
#include "solver_metal/symmetric2.hpp"

namespace interply::metal {

/// State of one point. `yield` always equals sigma_y(plastic_strain), so that an elastic step never evaluates the
/// curve.
struct J2Point {
  Symmetric2 stress{};          ///< Cauchy, plane stress, in the polar (Hill48: rolling) frame, MPa
  double plastic_strain = 0;    ///< p, equivalent
  YieldStress<double> yield{};  ///< sigma_y(p) and its slope
};

/// Advances a point by a strain increment.
/// @param de  logarithmic strain increment, in the frame of the stress
/// @return thickness strain increment: -nu/E d(s11 + s22) - (dp11 + dp22), plastic flow being incompressible
double update_point(const LawConstants& law, const Symmetric2& de, J2Point& point);

struct MetalPoint {
  double strain = 0;            ///< true (logarithmic) strain along the bar
  double stress = 0;            ///< Cauchy stress along the bar, MPa
  double plastic_strain = 0;    ///< equivalent
  double width_strain = 0;      ///< true strain across the bar
  double thickness_strain = 0;  ///< true strain through the thickness
};

/// Pulls (or pushes) a bar free of stress across its width and thickness from rest at zero strain through the given
/// true strains, with the law of the sheets; with hill48 along the rolling direction. Increments above 1e-3 are
/// divided.
/// @return one point per strain, in order
std::vector<MetalPoint> follow_uniaxial_path(const scene::J2Law& law, const std::vector<double>& strain);

}  // namespace interply::metal
