/// The keys of a scene for a person, from the schema and the defaults of the structs.
#include "scene/reference.hpp"

#include <gmock/gmock.h>

#include "scene.pb.h"
#include "scene/scene_test_support.hpp"

namespace interply::scene {
namespace {

using google::protobuf::Descriptor;
using testing::HasSubstr;

TEST(Reference, SaysDefaultUnitRangeAndMeaning) {
  const std::string text = describe_keys("motion");
  EXPECT_THAT(text, testing::ContainsRegex(
                        "stroke: 60 +# mm, in \\[0, inf\\), usually \\[0.1, 1e3\\]; of the punch, downwards\n"));
  EXPECT_THAT(describe_keys("layers.density"), HasSubstr("t/mm3, in (0, 1e-06], usually [1e-10, 3e-8], required"));
  EXPECT_THAT(
      describe_keys("layers[2].law.woven.variant"),
      HasSubstr("variant: full                     # fabric | uncoupled | full | biaxial | normal_shear; which"));
  EXPECT_THAT(describe_keys("layers.law.woven.a"), HasSubstr("MPa, one value or [warp, weft], in [0, inf)"));
  EXPECT_THAT(describe_keys("tools.punch"), HasSubstr("# none (default): the stack is only squeezed\n"));
}

/// What it gives as a default is what a scene without the key has.
TEST(Reference, DefaultsAreThoseThatASceneTakes) {
  const auto read_default = [](const std::string& path) {
    const std::string line = describe_keys(path);
    const std::size_t begin = line.find(": ") + 2;
    return line.substr(begin, line.find_last_not_of(' ', line.find('#') - 1) + 1 - begin);
  };
  const Scene scene = parse_scene(kSmallScene, "scene.yaml");
  for (const std::string path :
       {"motion.forming_time", "time.safety", "contact.penetration", "exchange.wait_deadline", "blank.mesh_size",
        "friction.steel_fabric", "record.frames", "observe.network", "tools.die.shoulder"})
    EXPECT_EQ(parse_scene(kSmallScene, "scene.yaml", {path + "=" + read_default(path)}).digest, scene.digest) << path;
}

std::vector<std::string> list_all(const Descriptor& type) {
  std::vector<std::string> names;
  for (int i = 0; i < type.field_count(); ++i) {
    names.push_back(type.field(i)->name());
    if (const auto* inner = type.field(i)->message_type();
        inner && !inner->options().GetExtension(schema::list) && !inner->options().GetExtension(schema::word))
      for (const std::string& name : list_all(*inner)) names.push_back(name);
  }
  return names;
}

TEST(Reference, HoldsEveryKeyOfTheSchema) {
  const std::string text = describe_keys("");
  for (const std::string& name : list_all(*schema::Scene::descriptor()))
    EXPECT_THAT("\n" + text, testing::ContainsRegex("[ \n-]" + name + ":")) << name;
}

TEST(Reference, AnUnknownPartNamesTheNearest) {
  const auto refuse = [](const std::string& path) {
    try {
      describe_keys(path);
    } catch (const SceneError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refuse("blnk"), "blnk: unknown key; did you mean 'blank'?");
  EXPECT_EQ(refuse("layers.law.wovn"), "layers.law.wovn: unknown key; did you mean 'woven'?");
  EXPECT_EQ(refuse("motion.stroke.x"), "motion.stroke: has no keys of its own");
}

}  // namespace
}  // namespace interply::scene
