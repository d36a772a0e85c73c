/// Which solver integrates a layer, for whoever runs layers in this process.
#pragma once

#include "solve/session.hpp"

namespace interply::launch {

solve::LayerFactory find_layer_factory(scene::Kind kind);

/// Users' own laws can be loaded. @throws scene::SceneError
void check_laws(const scene::Scene& scene);

}  // namespace interply::launch
