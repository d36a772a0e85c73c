#include "launch/check.hpp"

#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <sstream>

#include "coordinator/stack.hpp"
#include "launch/datacheck.hpp"
#include "launch/inertia.hpp"
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
  EXPECT_THAT(text, testing::ContainsRegex("sheet_lower +j2 swift +0 +1 +120 +196 +307\\.72 "));
  EXPECT_THAT(text, testing::ContainsRegex("ply_2 +woven full +0 +1\\.2 +120 +196 +29\\.12 "));
}

TEST(Check, ShowsTheMassThatScalingAdds) {
  // Factor 4: three times the mass is added. 2 x 307.72 + 3 x 29.1177 = 702.793 g.
  EXPECT_THAT(check({"time.mass_scaling=4"}), testing::HasSubstr("mass scaling adds 2108.38 g"));
  EXPECT_THAT(check({}), testing::Not(testing::HasSubstr("mass scaling")));
}

TEST(Check, WarnsOfAToolFinerThanTheMesh) {
  EXPECT_THAT(
      check({"tools.die.shoulder=4"}),
      testing::HasSubstr("warning     tools.die: a radius of 4 mm is finer than the 20 mm mesh of sheet_lower"));
}

datacheck::Datacheck check_shipped(const std::string& scene, const std::vector<std::string>& overrides = {}) {
  return check_data(scene::read_scene(INTERPLY_SOURCE_DIR "/deploy/scenes/" + scene + ".yaml", overrides));
}

/// Stiffness: p_ref / (0.02 x thinner layer); friction: that of the pair, if it has one, goes before that of the kinds.
TEST(Check, ShowsEveryInterfaceWithItsFrictionAndStiffness) {
  const auto check =
      check_shipped("tetrahedron_fml_coarse", {"friction.pairs=[{between: [ply_1, ply_2], coefficient: 0.4}]"});
  ASSERT_EQ(check.interfaces_size(), 7);
  const auto is = [&](int k, const std::string& name, double friction, double stiffness) {
    EXPECT_EQ(check.interfaces(k).name(), name);
    EXPECT_EQ(check.interfaces(k).friction().value(), friction);
    EXPECT_NEAR(check.interfaces(k).stiffness().value(), stiffness, 1e-9);
  };
  is(0, "die|sheet_lower", 0.1, 30 / (0.02 * 1.0));
  is(1, "sheet_lower|ply_1", 0.25, 30 / (0.02 * 1.0));
  is(2, "ply_1|ply_2", 0.4, 30 / (0.02 * 1.2));
  is(6, "sheet_upper|punch", 0.1, 30 / (0.02 * 1.0));
}

/// Triangle of edge e offset by r: e sqrt(3)/2 + 2 r along x, e + 2 r along y. Ball of 40 mm, facets of 5 deg.
TEST(Check, ShowsToolsWithSizePlaceAndSmallestRadius) {
  const auto analytic = check_shipped("tetrahedron_fml_coarse");
  ASSERT_EQ(analytic.tools_size(), 3);
  const datacheck::Tool &die = analytic.tools(0), &punch = analytic.tools(2);
  EXPECT_EQ(die.name(), "die");
  EXPECT_NEAR(die.size_x().value(), 100 * std::sqrt(3) / 2 + 2 * 32, 1e-9);
  EXPECT_NEAR(die.size_y().value(), 100 + 2 * 32, 1e-9);
  EXPECT_EQ(die.smallest_radius().value(), 10);
  EXPECT_EQ(die.touching_height().value(), 0);
  EXPECT_NEAR(punch.size_z().value(), 65, 1e-9);
  EXPECT_NEAR(punch.touching_height().value(), 5.6, 1e-9);
  const auto surfaces = check_shipped("own_tools");
  const datacheck::Tool& dome = surfaces.tools(2);
  EXPECT_EQ(dome.shape(), "dome_punch.stl, 2736 triangles");
  EXPECT_NEAR(dome.size_x().value(), 80, 0.2);
  EXPECT_NEAR(dome.smallest_radius().value(), 40, 6);  // an estimate from chords
  EXPECT_NEAR(dome.moved().value(), 2.2, 1e-4);
}

/// 60 mm in 15 ms by a smooth step, whose steepest slope is 15/8; 2 MPa on the flange.
TEST(Check, ShowsSpeedAndForce) {
  const auto check = check_shipped("tetrahedron_fml_coarse");
  EXPECT_NEAR(check.motion().largest_speed().value(), 15.0 / 8 * 60 / 15, 1e-12);
  EXPECT_NEAR(check.motion().time().value(), 16, 1e-12);
  const double r = 32, opening = std::sqrt(3) / 4 * 1e4 + 300 * r + M_PI * r * r;
  EXPECT_NEAR(check.motion().holder_force().value(), 2e-3 * 0.5 * (280 * 280 - opening), 1e-9);
}

/// A stand-in of fewer elements of the same size gives the increments of the whole blank, and everything else in
/// proportion. 64 000 elements a layer are measured on; 98 000 are not.
TEST(Check, AFineMeshIsMeasuredOnASmallerBlankOfTheSameElements) {
  const auto whole = check_shipped("tetrahedron_fml", {"blank={mesh_size: 2}"});
  const auto fine = check_shipped("tetrahedron_fml", {"blank={length: 700, width: 700, mesh_size: 2}"});
  EXPECT_EQ(fine.layers(0).elements().value(), 2 * 350 * 175);
  EXPECT_EQ(fine.layers(0).nodes().value(), 351 * 176);
  for (int i = 0; i < 5; ++i)
    EXPECT_NEAR(fine.layers(i).increment().value() / whole.layers(i).increment().value(), 1, 1e-3) << i;
  EXPECT_NEAR(fine.cost().increment().value() / whole.cost().increment().value(), 1, 0.02);
  EXPECT_NEAR(fine.cost().record().value() / whole.cost().record().value(), 6.25, 0.3);
  EXPECT_NEAR(fine.layers(1).mass().value(), 1e6 * 700 * 350 * 1.2 * 6.19e-10, 1e-6);
}

/// So does one with plates in place of surfaces.
TEST(Check, SurfacesAreReplacedByPlatesToMeasureIncrements) {
  const auto surfaces = check_shipped("own_tools");
  scene::Scene scene = scene::read_scene(INTERPLY_SOURCE_DIR "/deploy/scenes/own_tools.yaml");
  coordinator::Stack stack(scene);
  stack.begin_step();
  for (int i = 0; i < stack.n_layers(); ++i) {
    stack.take_motion(i, stack.layer(i).mesh.reference, {}, 1e-6 * surfaces.layers(i).increment().value());
    stack.compute_contact_of(i, 0);
  }
  EXPECT_NEAR(surfaces.cost().increment().value() / (1e6 * 0.9 * stack.collect_votes().stack), 1, 0.02);
}

TEST(Check, FramesSetTheLeastNumberOfSteps) {
  const auto check = check_shipped("tetrahedron_fml_coarse", {"record.frames=100000"});
  EXPECT_EQ(check.cost().steps().value(), 100000);
  EXPECT_EQ(check.cost().frames().value(), 100001);
}

TEST(Check, RecordAndMemoryBeyondThisMachineAreWarnedOf) {
  const auto check = check_shipped("tetrahedron_fml", {"record.frames=100000", "blank.mesh_size=0.3"});
  EXPECT_THAT(check.warnings(), testing::Contains(testing::StartsWith("record.frames: the record takes about ")));
  EXPECT_GT(check.cost().record().value(), check.cost().free_disk().value());
}

/// One sheet, disc of radius R: half of the cone, p = (d/R)^2/2 at constant yield stress, and friction by hand.
TEST(Check, KineticShareIsThatOfACone) {
  scene::Scene scene = scene::read_scene(INTERPLY_SOURCE_DIR "/deploy/scenes/tetrahedron_fml_coarse.yaml");
  scene.layers.resize(1);
  scene.layers[0].law = scene::J2Law{.hardening = scene::HardeningTable{{{0, 200}, {1, 200}}}};
  const double d = 30, v = 15.0 / 8 * 60 / 15e-3, R = 80, opening = M_PI * R * R / 2, flange = 30000;
  const double kinetic = 7.85e-9 * opening * v * v / 12;
  const double plastic = opening * 200 * d * d / (2 * R * R), friction = 0.2 * 2 * flange * d * d / (4 * R);
  EXPECT_NEAR(*estimate_kinetic_share(scene, flange, flange + opening), kinetic / (plastic + friction), 1e-9);
  scene.layers[0].law = scene::VumatLaw{.integration = scene::Integration::Shell};
  EXPECT_FALSE(estimate_kinetic_share(scene, flange, flange + opening));
}

TEST(Check, JsonHoldsTheSame) {
  std::ostringstream out;
  EXPECT_EQ(check_command({.scene = INTERPLY_SOURCE_DIR "/tests/scenes/flat_stack.yaml", .json = true}, out), 0);
  datacheck::Datacheck read;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(out.str(), &read).ok());
  EXPECT_EQ(read.layers(0).elements().value(), 196);
  EXPECT_EQ(read.layers(0).mass().unit(), "g");
}

TEST(Check, FitsEightyColumns) {
  std::istringstream text(check({"tools.punch={}"}));
  for (std::string line; std::getline(text, line);)
    if (!line.starts_with("warning")) EXPECT_LE(line.size(), 80u) << line;
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
