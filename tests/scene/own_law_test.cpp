/// Hill48 and users' own laws in a scene.
#include <filesystem>

#include "scene/scene_test_support.hpp"

namespace interply::scene {
namespace {

class OwnLaw : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_ / "laws");
    std::ofstream(folder_ / "laws/libmine.so") << "not a library; the scene does not load it";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  Scene read(const std::string& law) {
    std::ofstream(folder_ / "scene.yaml") << with("woven:\n        variant: full", law);
    return read_scene(folder_ / "scene.yaml");
  }
  std::string refuse_law(const std::string& law) {
    try {
      read(law);
    } catch (const SceneError& error) {
      const std::string said = error.what();
      return said.substr(said.find(": ") + 2);
    }
    return "";
  }
  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("interply_own_law_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(OwnLaw, LibraryIsFoundBesideTheSceneAndKeptWithItsDigest) {
  const Scene scene =
      read("vumat: {library: laws/libmine.so, parameters: [210e3, 0.3, -1], state_variables: 2, integration: shell}");
  const auto& law = std::get<VumatLaw>(scene.layers[1].law);
  EXPECT_EQ(law.library.path, (folder_ / "laws/libmine.so").lexically_normal().string());
  EXPECT_EQ(law.library.digest.size(), 16u);
  EXPECT_EQ(law.parameters, (std::vector<double>{210e3, 0.3, -1}));
  EXPECT_EQ(law.state_variables, 2);
  EXPECT_EQ(scene.layers[1].kind(), Kind::Metal);
  const Scene again = parse_scene(scene.text, "elsewhere/scene.yaml");
  EXPECT_EQ(again.text, scene.text);
  EXPECT_EQ(again.digest, scene.digest);
}

TEST_F(OwnLaw, IsAFabricMembraneByDefault) {
  const Scene scene = read("vumat: {library: laws/libmine.so}");
  EXPECT_EQ(scene.layers[1].kind(), Kind::Fabric);
  EXPECT_TRUE(std::get<VumatLaw>(scene.layers[1].law).parameters.empty());
  EXPECT_EQ(parse_scene(scene.text, "scene.yaml").digest, scene.digest);
}

TEST_F(OwnLaw, MistakesAreNamed) {
  EXPECT_EQ(refuse_law("vumat: {}"), "layers[1].law.vumat.library: is required and has no default");
  EXPECT_TRUE(refuse_law("vumat: {library: laws/libyours.so}").starts_with("layers[1].law.vumat.library: "));
  EXPECT_EQ(refuse_law("vumat: {library: laws/libmine.so, parameters: [1, two]}"),
            "layers[1].law.vumat.parameters[1]: 'two' is not a number");
  EXPECT_EQ(refuse_law("vumat: {library: laws/libmine.so, parameters: 1}"),
            "layers[1].law.vumat.parameters: must be a list, not a single value");
  EXPECT_EQ(refuse_law("vumat: {library: laws/libmine.so, state_variables: -1}"),
            "layers[1].law.vumat.state_variables: -1 is not in [0, 1000]");
  EXPECT_EQ(refuse_law("vumat: {library: laws/libmine.so}\n    threads: 2"),
            "layers[1].threads: a vumat is called from one thread; set 1");
  EXPECT_EQ(refuse_law("vumat: {library: laws/libmine.so}\n    integration_points: 3"),
            "layers[1].integration_points: belongs to a metal layer only");
  EXPECT_EQ(refuse_law("vumat: {library: laws/libmine.so, integration: shell}\n    bending: 3"),
            "layers[1].bending: belongs to a fabric layer only");
}

TEST(Hill48InAScene, IsReadAndWrittenBack) {
  const Scene scene =
      parse_scene(kSmallScene, "scene.yaml", {"layers.sheet.law.j2.hill48={r0: 1.9, r45: 1.3, r90: 2.2}"});
  const auto& law = std::get<J2Law>(scene.layers[0].law);
  ASSERT_TRUE(law.hill48);
  EXPECT_EQ(law.hill48->r45, 1.3);
  EXPECT_EQ(parse_scene(scene.text, "scene.yaml").digest, scene.digest);
  EXPECT_FALSE(std::get<J2Law>(parse_scene(kSmallScene, "scene.yaml").layers[0].law).hill48);
}

TEST(Hill48InAScene, RatiosAreChecked) {
  EXPECT_EQ(refuse_value("layers.sheet.law.j2.hill48={r0: 0, r45: 1, r90: 1}"),
            "layers[0].law.j2.hill48.r0: 0 is not in [0.01, 100]");
  EXPECT_EQ(refuse_value("layers.sheet.law.j2.hill48={r0: 1, r45: 1}"),
            "layers[0].law.j2.hill48.r90: is required and has no default");
  EXPECT_EQ(refuse_value("layers.sheet.law.j2.hill48=none"), "");
}

}  // namespace
}  // namespace interply::scene
