/// One material point of a sheet under uniaxial tension, for calibration.
#pragma once

#include <vector>

#include "scene/scene.hpp"

namespace interply::metal {

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
