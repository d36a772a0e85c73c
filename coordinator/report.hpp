/// The summary of a run: its numbers, filled once, as one screen of text and as JSON.
#pragma once

#include <string>
#include <vector>

#include "coordinator/step.hpp"
#include "summary.pb.h"

namespace interply::coordinator {

/// @param seconds  wall time of the forming
summary::Summary summarise(const scene::Scene& scene, const Forming& forming, const EnergyBalance& end,
                           const std::vector<exchange::Final>& finals, double seconds);

/// One screen, without the digest line.
std::string format_text(const summary::Summary& summary);

}  // namespace interply::coordinator
