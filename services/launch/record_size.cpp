#include "launch/record_size.hpp"

#include "coordinator/frames.hpp"
#include "coordinator/interface_fields.hpp"
#include "record/layout.hpp"

namespace interply::launch {

std::uint64_t measure_record(const scene::Scene& scene,
                             const std::vector<std::unique_ptr<solve::LayerMechanics>>& layers,
                             const coordinator::Stack& stack) {
  if (scene.record.frames == 0) return 0;
  record::Layout layout;
  layout.header = coordinator::make_header(scene, "", stack);
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const std::string& name = scene.layers[i].name;
    const mechanics::TriangleMesh& mesh = stack.layer(static_cast<int>(i)).mesh;
    layout.meshes[name] = {.layer = name, .kind = "", .reference = mesh.reference, .triangles = mesh.triangles};
    auto fields = layers[i]->compute_fields(mesh.reference);
    fields.push_back(solve::TrustBook(layers[i]->trust_limits(), mesh).describe());
    layout.layer_fields[name] = record::shapes_of(fields);
  }
  for (int k = 0; k < stack.n_interfaces(); ++k) {
    const std::string& name = layout.header.interfaces[static_cast<std::size_t>(k)];
    layout.interface_fields[name] = record::shapes_of(coordinator::describe_interface(scene, stack, k));
    layout.other_fields[name] = record::shapes_of(coordinator::describe_other_side(stack, k));
  }
  return record::measure_record(layout);
}

}  // namespace interply::launch
