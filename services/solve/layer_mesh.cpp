#include "solve/layer_mechanics.hpp"

namespace interply::solve {

mechanics::TriangleMesh make_layer_mesh(const scene::Scene& scene, int layer) {
  double z = 0;  // the stack stands on z = 0
  for (int i = 0; i < layer; ++i) z += scene.layers[static_cast<std::size_t>(i)].thickness;
  z += 0.5 * scene.layers[static_cast<std::size_t>(layer)].thickness;
  const scene::Blank& blank = scene.blank;
  return mechanics::make_rectangle({-0.5 * blank.length, 0.5 * blank.length},
                                   {blank.half ? 0.0 : -0.5 * blank.width, 0.5 * blank.width}, blank.mesh_size, z,
                                   blank.half);
}

}  // namespace interply::solve
