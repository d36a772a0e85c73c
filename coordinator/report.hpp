/// The one-screen summary of a run.
#pragma once

#include <string>
#include <vector>

#include "coordinator/step.hpp"

namespace interply::coordinator {

/// @param seconds  wall time of the forming
std::string format_summary(const scene::Scene& scene, const Forming& forming, const EnergyBalance& end,
                           const std::vector<exchange::Final>& finals, double seconds);

}  // namespace interply::coordinator
