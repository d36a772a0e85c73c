/// What a scene says of DDS, by which anyone may watch its run.
#pragma once

#include <string>

#include "observe/dds.hpp"
#include "scene/scene.hpp"

namespace interply::solve {

/// @param run  identity of the run
observe::DdsOptions make_dds_options(const scene::Scene& scene, const std::string& run);

/// @throws scene::SceneError if the run publishes and this host has no network interface `observe.network`
void check_network(const scene::Scene& scene);

}  // namespace interply::solve
