#include "launch/check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <sstream>

#include "launch/run.hpp"
#include "paths.hpp"
#include "scene/read_scene.hpp"

namespace interply::launch {
namespace {

std::string check(const std::vector<std::string>& overrides) {
  std::ostringstream out;
  EXPECT_EQ(check_command({INTERPLY_SOURCE_DIR "/tests/scenes/flat_stack.yaml", overrides}, out), 0);
  return out.str();
}

TEST(Check, ListsNodesElementsAndMassOfEveryLayer) {
  // Half of 280 x 280 mm in 20 mm cells: 15 x 8 nodes, 2 x 14 x 7 triangles.
  // Mass: 280 mm x 140 mm x 1 mm x 7.85e-9 t/mm3 = 307.72 g; 280 x 140 x 1.2 x 6.19e-10 = 29.12 g.
  const auto text = check({});
  EXPECT_THAT(text, testing::ContainsRegex("sheet_lower +metal +120 +196 +307\\.72 +0\\.00"));
  EXPECT_THAT(text, testing::ContainsRegex("ply_2 +fabric +120 +196 +29\\.12 +0\\.00"));
}

TEST(Check, ShowsTheMassThatScalingAdds) {
  // Factor 4: three times the mass is added, and every frequency is halved.
  const auto text = check({"time.mass_scaling=4"});
  EXPECT_THAT(text, testing::ContainsRegex("sheet_lower +metal +120 +196 +307\\.72 +923\\.16"));
}

TEST(Check, WarnsOfAToolFinerThanTheMesh) {
  EXPECT_THAT(check({"tools.die.shoulder=4"}),
              testing::HasSubstr("warning     tools.die: a radius of 4 mm is finer than the 20 mm mesh of sheet_lower"));
}

TEST(Check, ARefusedSceneIsNotPriced) {
  std::ostringstream out;
  EXPECT_THROW(check_command({INTERPLY_SOURCE_DIR "/tests/scenes/flat_stack.yaml", {"blank.mesh_size=-1"}}, out),
               scene::SceneError);
  EXPECT_EQ(out.str(), "");
}

TEST(Check, RefusesANetworkThatThisHostDoesNotHaveAsARunDoes) {
  const std::string scene = INTERPLY_SOURCE_DIR "/tests/scenes/flat_stack.yaml", network = "observe.network=foo";
  const auto refusal = testing::ThrowsMessage<scene::SceneError>(
      testing::AllOf(testing::HasSubstr("observe.network: 'foo'"), testing::HasSubstr("lo (127.0.0.1)")));
  std::ostringstream out;
  EXPECT_THAT([&] { check_command({scene, {network}}, out); }, refusal);
  const auto folder = std::filesystem::temp_directory_path() / ("no_network." + std::to_string(getpid()));
  EXPECT_THAT([&] { run_command({.scene = scene, .overrides = {network}, .out = folder}); }, refusal);
  EXPECT_FALSE(std::filesystem::exists(folder));
}

}  // namespace
}  // namespace interply::launch
