/// A scene file, then one --set override per further part. An accepted scene's resolved text reads back to the same
/// digest, and the warnings about it can be found.
#include "fuzz/parts.hpp"
#include "scene/read_scene.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace interply;
  std::vector<std::string> overrides = fuzz::split(data, size);
  const std::string text = overrides.front();
  overrides.erase(overrides.begin());
  try {
    const scene::Scene scene = scene::parse_scene(text, "fuzz.yaml", overrides);
    scene::find_warnings(scene);
    try {
      if (scene::parse_scene(scene.text, "resolved", {}).digest != scene.digest)
        fuzz::fail("another digest from the resolved scene:\n" + scene.text);
    } catch (const scene::SceneError& refused) {
      fuzz::fail("the resolved scene is refused: " + std::string(refused.what()) + "\n" + scene.text);
    }
  } catch (const scene::SceneError& refused) {
    fuzz::expect_sentences(refused.what(), {"fuzz.yaml", "--set "});
  }
  return 0;
}
