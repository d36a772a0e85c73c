/// What a finished run must not be silent about.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace interply::coordinator {

/// Which tools and layers never pressed on each other, one sentence each, and that there was no punch.
/// @param touched  by interface, in the order of name_interfaces()
std::vector<std::string> list_untouched(const scene::Scene& scene, const std::vector<bool>& touched,
                                        std::int64_t steps);

}  // namespace interply::coordinator
