#include "launch/layer_factories.hpp"

#include "solve/vumat.hpp"
#include "solver_fabric/fabric_layer.hpp"
#include "solver_metal/metal_layer.hpp"

namespace interply::launch {

solve::LayerFactory find_layer_factory(scene::Kind kind) {
  return kind == scene::Kind::Fabric ? fabric::make_fabric_layer : metal::make_metal_layer;
}

void check_laws(const scene::Scene& scene) {
  for (const scene::Layer& layer : scene.layers)
    if (const auto* own = std::get_if<scene::VumatLaw>(&layer.law)) solve::check_vumat(*own, layer.name);
}

}  // namespace interply::launch
