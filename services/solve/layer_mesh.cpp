#include "scene/meshes.hpp"
#include "scene/read_scene.hpp"
#include "solve/layer_mechanics.hpp"

namespace interply::solve {

mechanics::TriangleMesh make_layer_mesh(const scene::Scene& scene, int layer) {
  double z = 0;  // the stack stands on z = 0
  for (int i = 0; i < layer; ++i) z += scene.layers[static_cast<std::size_t>(i)].thickness;
  const scene::Layer& own = scene.layers[static_cast<std::size_t>(layer)];
  z += 0.5 * own.thickness;
  const scene::Blank& blank = scene.blank;
  if (const auto flat = scene::read_mesh_of(scene, static_cast<std::size_t>(layer))) {
    try {
      return mechanics::make_mesh(flat->points, flat->triangles, z, blank.half);
    } catch (const std::invalid_argument& error) {
      throw scene::SceneError("mesh of layer " + own.name + ": " + error.what());
    }
  }
  return mechanics::make_blank(
      blank.length, blank.width, own.mesh_size.value_or(blank.mesh_size), z, blank.half,
      blank.diagonals == scene::Diagonals::Centre ? mechanics::Diagonals::Centre : mechanics::Diagonals::Around);
}

}  // namespace interply::solve
