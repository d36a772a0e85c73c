/// A look at a user's own law before anything depends on it, in a process of its own.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace interply::solve {

/// Loads the library in a child of this process and lets VumatPoints::examine() call it there, so that a law that
/// stops, crashes or never returns is a sentence. Called before this process has threads.
/// @param density  without mass scaling, t/mm3
/// @param limit    s; then the child is killed
/// @return warnings
/// @throws scene::SceneError naming layer, library, cause and the last lines of what the law wrote
std::vector<std::string> probe_vumat(const scene::VumatLaw& law, const std::string& layer, double density,
                                     double limit = 60);

}  // namespace interply::solve
