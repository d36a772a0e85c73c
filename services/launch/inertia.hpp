/// How much of the work of forming inertia takes, before anything is computed.
#pragma once

#include <optional>

#include "scene/scene.hpp"

namespace interply::launch {

/// Kinetic energy / work done by the tools when the punch is fastest, at half its stroke. Rough: a factor of three
/// where it is small, and less than the truth where it is large, since a blank that is thrown does not form as assumed
/// here.
///
/// The opening counts as a disc of equal area, radius R, that is drawn into a cone of depth d = stroke/2. Its velocity
/// falls from that of the punch to 0 at the rim: 1/12 m v^2. Metal is stretched as much as the cone is longer than the
/// disc, p = (d/R)^2/2, at its yield stress; what lies on the flange slides by the d^2/(4 R) that the cone is larger,
/// under the blank holder's pressure between both tools.
/// @param flange_area, blank_area  of the modelled part, mm2
/// @return nothing without a punch, or with a law of the user's own in a metal layer, whose yield stress is not known
std::optional<double> estimate_kinetic_share(const scene::Scene& scene, double flange_area, double blank_area);

}  // namespace interply::launch
