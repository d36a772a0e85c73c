/// Messages of proto/scene.proto <-> plain structs of scene.hpp. Absent fields keep the struct's default.
#pragma once

#include "scene.pb.h"
#include "scene/scene.hpp"

namespace interply::scene {

Scene to_scene(const schema::Scene& message);
Law to_law(const schema::Law& message);

/// Every field of the scene, defaults included, except those that a layer's kind has no use for.
schema::Scene to_message(Scene scene);

}  // namespace interply::scene
