/// What a scene would do and cost, and what looks doubtful, without running it.
#pragma once

#include "datacheck.pb.h"
#include "scene/scene.hpp"

namespace interply::launch {

/// Takes seconds whatever the mesh: where it is a rectangle's, increments, memory and time are measured on a blank of
/// the same elements, fewer of them, with an opening that leaves the same share of flange.
/// @throws scene::SceneError  for what a run would refuse, too
datacheck::Datacheck check_data(const scene::Scene& scene);

}  // namespace interply::launch
