/// What a finished run must not be silent about.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "summary.pb.h"

namespace interply::coordinator {

// Beyond these a run asks to be looked at; it is done all the same.
inline constexpr double kMostKinetic = 5;  ///< % of the work: the common rule for quasi-static forming is 5 to 10
inline constexpr double kMostPenetration =
    5;                                      ///< % of the thinner layer, of 99 % of the contact area (contact/THEORY.md)
inline constexpr double kMostResidual = 1;  ///< % of the energy scale

/// Which tools and layers never pressed on each other, one sentence each, and that there was no punch.
/// @param touched  by interface, in the order of name_interfaces()
std::vector<std::string> list_untouched(const scene::Scene& scene, const std::vector<bool>& touched,
                                        std::int64_t steps);

/// Adds the verdicts to a summary that holds everything else. @param untouched  of list_untouched()
void judge(const scene::Scene& scene, const std::vector<std::string>& untouched, summary::Summary& summary);

}  // namespace interply::coordinator
