#include "scene/scene_test_support.hpp"

namespace interply::scene {
namespace {

Scene parse_with(const std::vector<std::string>& overrides) {
  return parse_scene(kSmallScene, "scene.yaml", overrides);
}

TEST(Overrides, ReachEveryDepthByNameOrIndex) {
  const Scene scene = parse_with(
      {"blank.mesh_size=10", "layers.ply_1.law.woven.variant=biaxial", "layers[0].thickness=0.8", "layers.1.threads=2",
       "layers.ply_1.law.woven.a=[1000, 2000]", "layers[1].law.woven.a[1]=3000", "motion={stroke: 5}"});
  EXPECT_EQ(scene.blank.mesh_size, 10);
  EXPECT_EQ(scene.layers[0].thickness, 0.8);
  EXPECT_EQ(scene.layers[1].threads, 2);
  const WovenLaw& law = std::get<WovenLaw>(scene.layers[1].law);
  EXPECT_EQ(law.variant, Variant::Biaxial);
  EXPECT_EQ(law.a.warp, 1000);
  EXPECT_EQ(law.a.weft, 3000);
  EXPECT_EQ(scene.motion.stroke, 5);
  EXPECT_EQ(scene.motion.forming_time, 15e-3);
}

TEST(Overrides, LastOneWins) { EXPECT_EQ(parse_with({"motion.stroke=1", "motion.stroke=2"}).motion.stroke, 2); }

TEST(Overrides, ReplaceABlockAsAWhole) {
  const Scene scene = parse_with({"layers.ply_1.law={j2: {hardening: {voce: {s0: 100, s_inf: 200, rate: 10}}}}"});
  EXPECT_EQ(scene.layers[1].kind(), Kind::Metal);
  EXPECT_EQ(std::get<Voce>(std::get<J2Law>(scene.layers[1].law).hardening).s_inf, 200);
  EXPECT_FALSE(parse_with({"tools.punch=none"}).tools.punch);
}

TEST(Overrides, ChangeOneOfTheLayersThatShareALaw) {
  const std::string shared = R"(layers:
  - {name: a, density: 1e-9, law: &soft {woven: {c: 10}}}
  - {name: b, density: 1e-9, law: *soft}
)";
  const Scene scene = parse_scene(shared, "scene.yaml", {"layers.b.law.woven.c=20"});
  EXPECT_EQ(std::get<WovenLaw>(scene.layers[0].law).c.warp, 10);
  EXPECT_EQ(std::get<WovenLaw>(scene.layers[1].law).c.warp, 20);
}

TEST(Overrides, UnknownPathNamesTheNearestOne) {
  EXPECT_EQ(refuse_value("blank.mesh_sze=10"), "blank.mesh_sze: unknown key; did you mean 'mesh_size'?");
  EXPECT_EQ(refuse_value("layrs.ply_1.thickness=1"), "layrs: unknown key; did you mean 'layers'?");
  EXPECT_EQ(refuse_value("layers.ply_2.thickness=1"), "layers: holds no item named 'ply_2'; did you mean 'ply_1'?");
  EXPECT_EQ(refuse_value("layers.ply_1.law.woven.varant=full"),
            "layers[1].law.woven.varant: unknown key; did you mean 'variant'?");
}

TEST(Overrides, ImpossiblePathIsRefused) {
  EXPECT_EQ(refuse_value("layers[2].thickness=1"), "layers: has 2 items, so no item 2");
  EXPECT_EQ(refuse_value("layers[0].thickness.x=1"),
            "layers[0].thickness: is a single value, so it has no part 'x'; set all of it");
  EXPECT_EQ(refuse_value("tools[0]=1"), "tools: is a block of keys, so it has no part '0'; set all of it");
  for (const char* malformed : {"blank", "=1", "blank..x=1", "[0]=1", "layers[0=1", "layers[0]thickness=1", "blank.=1"})
    EXPECT_EQ(refuse_value(malformed), "is not of the form path=value, such as blank.mesh_size=10") << malformed;
  EXPECT_EQ(refuse_value("blank={").substr(0, 16), "not valid YAML: ");
}

}  // namespace
}  // namespace interply::scene
