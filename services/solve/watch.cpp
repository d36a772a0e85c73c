#include "solve/watch.hpp"

#include <stdexcept>

#include "scene/read_scene.hpp"

namespace interply::solve {

observe::DdsOptions make_dds_options(const scene::Scene& scene, const std::string& run) {
  return {.network = scene.observe.network,
          .multicast = scene.observe.multicast,
          .domain = scene.observe.domain,
          .run = run,
          .peers = {}};
}

void check_network(const scene::Scene& scene) try {
  if (scene.record.frames > 0) observe::check_network(make_dds_options(scene, "any"));
} catch (const std::runtime_error& e) {
  throw scene::SceneError(e.what());
}

}  // namespace interply::solve
