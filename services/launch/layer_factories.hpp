/// Which solver integrates a layer, for whoever runs layers in this process.
#pragma once

#include <string>
#include <vector>

#include "solve/session.hpp"

namespace interply::launch {

solve::LayerFactory find_layer_factory(scene::Kind kind);

/// Tries every user's own law in a process of its own (solve/vumat_probe.hpp).
/// @return warnings  @throws scene::SceneError naming layer, library, cause and the law's last lines
std::vector<std::string> check_laws(const scene::Scene& scene);

}  // namespace interply::launch
