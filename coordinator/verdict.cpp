#include "coordinator/verdict.hpp"

#include <fmt/format.h>

#include "coordinator/coordinator.hpp"

namespace interply::coordinator {

std::vector<std::string> list_untouched(const scene::Scene& scene, const std::vector<bool>& touched,
                                        std::int64_t steps) {
  std::vector<std::string> sentences;
  if (!scene.tools.punch && scene.motion.stroke > 0)
    sentences.push_back(
        fmt::format("there was no punch (tools.punch): the stack was only squeezed, motion.stroke = {:g} mm moved "
                    "nothing",
                    scene.motion.stroke));
  const auto names = name_interfaces(scene);
  const std::size_t n = scene.layers.size();
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (touched[k]) continue;
    if (k > 0 && k < n) {
      sentences.push_back(fmt::format("{} and {} never touched: no pressure between them in any of {} steps",
                                      scene.layers[k - 1].name, scene.layers[k].name, steps));
      continue;
    }
    const char* tool = k == 0 ? "die" : k == n ? "blank holder" : "punch";
    sentences.push_back(
        fmt::format("the {} never touched {}: its force was 0 in all {} steps; {}", tool, names[k].nodes_of, steps,
                    k > n ? "see `interply check` for a tool finer than the mesh, or lengthen motion.stroke"
                          : "see `interply check` for a tool finer than the mesh or beside the blank"));
  }
  return sentences;
}

}  // namespace interply::coordinator
