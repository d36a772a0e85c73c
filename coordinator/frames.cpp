#include "coordinator/frames.hpp"

#include <cmath>

#include "coordinator/coordinator.hpp"
#include "coordinator/interface_fields.hpp"
#include "mechanics/digest.hpp"

namespace interply::coordinator {

observe::RunHeader make_header(const scene::Scene& scene, const std::string& run_name, const Stack& stack) {
  observe::RunHeader header{.run = run_name,
                            .scene_text = scene.text,
                            .version = exchange::kVersion,
                            .scene_digest = mechanics::to_hex(scene.digest)};
  for (const scene::Layer& layer : scene.layers) header.layers.push_back(layer.name);
  for (const InterfaceName& interface : name_interfaces(scene)) {
    header.interfaces.push_back(interface.name);
    header.interface_nodes_of.push_back(interface.nodes_of);
    header.interface_others.push_back(interface.other);
  }
  header.tools = {"die", "blank_holder"};
  if (scene.tools.punch) header.tools.push_back("punch");
  header.tool_surfaces = stack.tool_surfaces();
  header.frames = scene.record.frames;
  header.history_capacity = scene.record.history_every > 0 ? 200000 : scene.record.history + 2;
  return header;
}

void put_frames(const scene::Scene& scene, const Stack& stack, const Pace& pace, observe::Sink& sink) {
  const auto names = name_interfaces(scene);
  for (int k = 0; k < stack.n_interfaces(); ++k) {
    const auto& name = names[static_cast<std::size_t>(k)];
    sink.put(observe::InterfaceFrame{.interface = name.name,
                                     .nodes_of = name.nodes_of,
                                     .frame = pace.frame(),
                                     .step = pace.step(),
                                     .time = pace.time(),
                                     .fields = describe_interface(scene, stack, k),
                                     .fields_on_other = describe_other_side(stack, k)});
  }
  for (const contact::Tool* tool : {&stack.die(), &stack.blank_holder(), stack.punch()}) {
    if (!tool) continue;
    sink.put(observe::ToolFrame{.tool = tool->name,
                                .frame = pace.frame(),
                                .step = pace.step(),
                                .time = pace.time(),
                                .position = tool->z,
                                .force = {tool->force.x(), tool->force.y(), tool->force.z()},
                                .moment = {tool->moment.x(), tool->moment.y(), tool->moment.z()}});
  }
}

Share explain_residual(const scene::Scene& scene, const EnergyBalance& balance) {
  Share worst{"none", 0, "a smaller time.safety"};
  const auto consider = [&](const std::string& name, double value, const char* cure) {
    if (std::isnan(worst.value)) return;  // the first NaN is the worst
    if (!(std::abs(value) <= std::abs(worst.value))) worst = {name, value, cure};
  };
  for (std::size_t i = 0; i < balance.layer_residual.size(); ++i)
    consider("layer " + scene.layers[i].name, balance.layer_residual[i],
             std::holds_alternative<scene::WovenLaw>(scene.layers[i].law)
                 ? "a smaller time.safety or time.vote_every, then a strain_cap or a smaller c in the law of this layer"
                 : "a smaller time.safety or time.vote_every, then a finer mesh");
  const auto names = name_interfaces(scene);
  for (std::size_t k = 0; k < balance.interface_residual.size(); ++k)
    consider("interface " + names[k].name, balance.interface_residual[k],
             "a smaller time.safety or time.vote_every, then a larger contact.damping or a smaller "
             "contact.reference_pressure");
  return worst;
}

}  // namespace interply::coordinator
