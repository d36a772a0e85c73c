/// A law, then a path of deformations in CSV: `interply point`.
#include "launch/point.hpp"

#include "fuzz/parts.hpp"
#include "scene/read_scene.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace interply;
  const std::vector<std::string> parts = fuzz::split(data, size);
  if (parts.size() != 2) return 0;
  try {
    const scene::Law law = scene::parse_law(parts[0], "fuzz.yaml");
    if (!std::holds_alternative<scene::WovenLaw>(law) && !std::holds_alternative<scene::J2Law>(law)) return 0;
    const std::string response = launch::follow_path(law, parts[1], "fuzz.csv");
    if (response.find("nan") != response.npos || response.find("inf") != response.npos)
      fuzz::fail("a response that is not finite:\n" + response);
  } catch (const scene::SceneError& refused) {
    fuzz::expect_sentences(refused.what(), {"fuzz.yaml"});
  } catch (const launch::PathError& refused) {
    fuzz::expect_sentence(refused.what(), "fuzz.csv");
  }
  return 0;
}
