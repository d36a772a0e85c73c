/// What types and ranges cannot say: values that must fit each other.
#pragma once

#include <string>

#include "scene/report.hpp"
#include "scene/scene.hpp"

namespace interply::scene {

/// Adds every contradiction of the scene to the report. A check is left out where its inputs are already reported.
void check_scene(const Scene& scene, Report& report);

/// The same for a law alone. @param path of the law, e.g. "layers[2].law"
void check_law(const Law& law, const std::string& path, Report& report);

}  // namespace interply::scene
