/// Steel sheets brought to equilibrium.
#pragma once

#include "support/metal_sheet.hpp"
#include "support/static_sheet.hpp"

namespace interply::metal::test {

/// A sheet of the layer's law, thickness and points, at rest.
inline interply::test::StaticSheet make_static_sheet(const scene::Layer& layer, TriangleMesh mesh) {
  return {std::move(mesh), layer.thickness, layer.density,
          [&](const TriangleMesh& m) { return std::make_unique<MetalLayer>(layer, layer.density, m); }};
}

}  // namespace interply::metal::test
