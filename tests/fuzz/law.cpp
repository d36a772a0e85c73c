/// A law file, as `interply point` reads it.
#include "fuzz/parts.hpp"
#include "scene/read_scene.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace interply;
  try {
    scene::parse_law({reinterpret_cast<const char*>(data), size}, "fuzz.yaml");
  } catch (const scene::SceneError& refused) {
    fuzz::expect_sentences(refused.what(), {"fuzz.yaml"});
  }
  return 0;
}
