#include "launch/layer_factories.hpp"

#include "solver_fabric/fabric_layer.hpp"
#include "solver_metal/metal_layer.hpp"

namespace interply::launch {

solve::LayerFactory find_layer_factory(scene::Kind kind) {
  return kind == scene::Kind::Fabric ? fabric::make_fabric_layer : metal::make_metal_layer;
}

}  // namespace interply::launch
