#include "launch/layer_factories.hpp"

#include "solve/vumat_probe.hpp"
#include "solver_fabric/fabric_layer.hpp"
#include "solver_metal/metal_layer.hpp"

namespace interply::launch {

solve::LayerFactory find_layer_factory(scene::Kind kind) {
  return kind == scene::Kind::Fabric ? fabric::make_fabric_layer : metal::make_metal_layer;
}

std::vector<std::string> check_laws(const scene::Scene& scene) {
  std::vector<std::string> warnings;
  for (const scene::Layer& layer : scene.layers)
    if (const auto* own = std::get_if<scene::VumatLaw>(&layer.law))
      for (const auto& warning : solve::probe_vumat(*own, layer.name, layer.density)) warnings.push_back(warning);
  return warnings;
}

}  // namespace interply::launch
