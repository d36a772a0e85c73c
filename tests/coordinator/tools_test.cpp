#include "coordinator/tool_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "paths.hpp"
#include "scene/read_scene.hpp"
#include "solve/layer_mechanics.hpp"
#include "support/own_tools.hpp"
#include "support/results.hpp"

namespace {

using namespace interply;
using test::OwnTools;
using test::Soup;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

std::vector<std::string> check_tools(const scene::Scene& scene) { return coordinator::check_tools(scene).warnings; }

constexpr double kHeight = 5.6;  // of the flat stack
const std::vector<std::string> kAll{"punch", "die", "blank_holder"};

scene::Scene read_scene(const OwnTools& tools, const std::vector<std::string>& which = kAll,
                        std::vector<std::string> more = {}) {
  more.insert(more.begin(), "motion.stroke=60");
  for (const std::string& override : tools.overrides(which)) more.push_back(override);
  return scene::read_scene(std::string(INTERPLY_SOURCE_DIR) + "/tests/scenes/flat_stack.yaml", more);
}

coordinator::PlacedTools place(const scene::Scene& scene) {
  const auto last = static_cast<int>(scene.layers.size()) - 1;
  return coordinator::place_tools(scene, solve::make_layer_mesh(scene, 0), solve::make_layer_mesh(scene, last),
                                  kHeight);
}

std::string refuse(const scene::Scene& scene) {
  try {
    check_tools(scene);
  } catch (const scene::SceneError& error) {
    return error.what();
  }
  return "";
}

Soup moved(Soup soup, const test::Vector3& by, double scale = 1) {
  for (test::Vector3& x : soup) x = scale * x + by;
  return soup;
}

TEST(Tools, SurfacesOfTheDefaultToolsAreAccepted) {
  for (const bool closed : {true, false})
    EXPECT_THAT(check_tools(read_scene(OwnTools(8, closed), kAll, {"blank.mesh_size=10"})), IsEmpty());
}

/// With facets in threes the tip of the punch is a vertex.
TEST(Tools, AreMovedUntilTheyTouchTheFlatStack) {
  const OwnTools tools(8);
  tools.write("punch", moved(test::make_punch(100, 50, 15, 60, 9), {0, 0, 37}));
  tools.write("die", moved(test::make_plate(100, 22, 10, 80, 160, 8, true), {0, 0, -300}));
  const auto placed = place(read_scene(tools));
  EXPECT_NEAR(placed.punch.z, kHeight - 37, 1e-5);  // single precision of the file
  EXPECT_NEAR(placed.die.z, 300, 1e-4);
  EXPECT_NEAR(placed.blank_holder.z, kHeight, 1e-5);
}

/// A stop beside the blank, higher than the land, does not keep the die away from it.
TEST(Tools, OnlyWhatIsOverTheBlankTouchesIt) {
  const OwnTools tools(8);
  Soup die = test::make_plate(100, 22, 10, 80, 160, 8, true);
  for (const auto& x : test::make_box({5, 20, 10})) die.push_back(x + test::Vector3(146, 0, 15));
  tools.write("die", die);
  EXPECT_NEAR(place(read_scene(tools, {"die"})).die.z, 0, 1e-5);
  for (auto& x : die) x.x() -= 3;  // now 2 mm of it are over the blank
  tools.write("die", die);
  EXPECT_NEAR(place(read_scene(tools, {"die"})).die.z, -25, 1e-5);
}

/// The land of the holder: the blank without the opening enlarged by the shoulder.
TEST(Tools, FlangeAreaIsWhereTheHolderTouches) {
  const auto ours = place(read_scene(OwnTools(16))).flange_area;
  const double e = 100, r = 22 + 10;
  const double opening = std::sqrt(3.0) / 4 * e * e + 3 * e * r + M_PI * r * r;
  test::expect_result({.row = "STL",
                       .quantity = "area under the pressure of a blank holder from STL",
                       .source = "280 x 280 mm less the opening with its shoulder, half",
                       .reference = 0.5 * (280 * 280 - opening),
                       .ours = ours,
                       .unit = "mm2",
                       .tolerance = 1e-3,  // counted on parts of 0.7 mm
                       .mesh = "20 mm"});
}

double read_gap(const std::string& message) {
  const auto at = message.find("leave ");
  return at == message.npos ? NAN : std::stod(message.substr(at + 6));
}

/// Walls of punch and die are offsets of the same triangle; chords of the roundings take 0.04 mm. At a stroke of 90 mm
/// the prism of the punch is below the shoulder.
TEST(Tools, PunchThatDoesNotPassIsRefusedWithTheGap) {
  const OwnTools tools(8);
  tools.write("die", test::make_plate(100, 17, 10, 100, 160, 8, true));
  const std::string said = refuse(read_scene(tools, {"punch", "die"}, {"motion.stroke=90"}));
  EXPECT_THAT(said,
              AllOf(HasSubstr("tools.punch.stl: at full stroke punch and die leave "),
                    HasSubstr("less than the 5.6 mm that must stay; widen the opening or shorten motion.stroke")));
  EXPECT_NEAR(read_gap(said), 17 - 15, 0.05);
  const std::string die = refuse(read_scene(tools, {"die"}, {"motion.stroke=90"}));
  EXPECT_THAT(die, HasSubstr("tools.die.stl: at full stroke"));
  EXPECT_NEAR(read_gap(die), 17 - 15, 0.05);
  const OwnTools narrow(8);
  narrow.write("blank_holder", test::turn_over(test::make_plate(100, 14, 10, 80, 160, 8, true)));
  const std::string holder = refuse(read_scene(narrow, {"blank_holder"}));
  EXPECT_THAT(holder, HasSubstr("tools.blank_holder.stl: at full stroke punch and blank holder leave "));
  EXPECT_NEAR(read_gap(holder), 14 - 15, 0.05);
}

TEST(Tools, SkinWhoseNormalsPointAwayIsRefused) {
  const OwnTools tools(8);
  Soup skin = test::make_plate(100, 22, 10, 80, 160, 8, false);
  for (std::size_t t = 0; t < skin.size(); t += 3) std::swap(skin[t], skin[t + 1]);
  for (auto& x : skin) x.z() += 1e-3 * x.x();  // touches at one side only
  tools.write("die", skin);
  EXPECT_THAT(refuse(read_scene(tools, {"die"})),
              AllOf(HasSubstr("behind the surface; it is open at"), HasSubstr("turn them, or close the surface")));
}

TEST(Tools, WrongUnitsAndPlacesAreRefused) {
  const OwnTools tools(8);
  tools.write("punch", moved(test::make_punch(100, 50, 15, 60, 8), {0, 0, 0}, 1e-3));
  EXPECT_THAT(refuse(read_scene(tools)), HasSubstr("so scale it (metres by 1000)"));
  tools.write("punch", moved(test::make_punch(100, 50, 15, 60, 8), {500, 0, 0}));
  EXPECT_THAT(refuse(read_scene(tools)),
              HasSubstr("nothing of it lies over the blank, x -140 to 140, y -140 to 140 mm"));
}

TEST(Tools, HolderWithoutAFlatLandIsRefused) {
  const OwnTools tools(8);
  tools.write("blank_holder", moved(test::make_ball(200, 32), {0, 0, 0}));
  EXPECT_THAT(refuse(read_scene(tools)), HasSubstr("the pressure needs a flat land of at least 1 %"));
}

TEST(Tools, HalfModelOfAnUnsymmetricToolIsWarnedOf) {
  const OwnTools tools(8);
  tools.write("punch", moved(test::make_punch(100, 50, 15, 60, 8), {0, 0.5, 0}));
  const auto warnings = check_tools(read_scene(tools, kAll, {"blank.mesh_size=10"}));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], AllOf(HasSubstr("tools.punch.stl: is not symmetric about y = 0, by "),
                                 HasSubstr("so use symmetry: full")));
}

TEST(Tools, RadiusFinerThanTheMeshIsWarnedOf) {
  const OwnTools tools(8);
  const auto analytic = check_tools(read_scene(tools, {}, {"blank.mesh_size=10", "tools.die.shoulder=4"}));
  EXPECT_THAT(analytic, ElementsAre(AllOf(HasSubstr("tools.die: a radius of 4 mm is finer than the 10 mm mesh of"),
                                          HasSubstr("a mesh of 4 mm would do"))));
  EXPECT_THAT(check_tools(read_scene(tools, {}, {"blank.mesh_size=4", "tools.die.shoulder=4"})), IsEmpty());
  // every vertex of the surface lies on the tool rounded with 5 mm
  tools.write("punch", test::make_punch(100, 50, 5, 60, 8));
  const auto rounded = check_tools(read_scene(tools, {"punch"}, {"blank.mesh_size=10"}));
  ASSERT_EQ(rounded.size(), 1u);
  EXPECT_THAT(rounded[0], HasSubstr("tools.punch.stl: a radius of "));
  EXPECT_NEAR(std::stod(rounded[0].substr(rounded[0].find("radius of") + 9)), 5, 1);
  EXPECT_THAT(check_tools(read_scene(tools, {"punch"}, {"blank.mesh_size=5"})), IsEmpty());
  tools.write("punch", test::make_box({30, 30, 80}));
  EXPECT_THAT(check_tools(read_scene(tools, {"punch"}, {"blank.mesh_size=10"})),
              ElementsAre(AllOf(HasSubstr("tools.punch.stl: a sharp edge at ("), HasSubstr("-80)"),
                                HasSubstr("round it to 10 mm or more"))));
}

/// Nodes lie 20 mm apart from x = -140, y = 0 on.
TEST(Tools, PunchBetweenTheNodesIsWarnedOf) {
  const OwnTools tools(8);
  const Soup pin = test::make_box({4, 4, 80});
  tools.write("punch", moved(pin, {10, 10, 0}));
  EXPECT_THAT(check_tools(read_scene(tools, {"punch"}, {"blank.mesh_size=20"})),
              Contains(AllOf(HasSubstr("tools.punch.stl: can touch no node of "), HasSubstr("on its way of 60 mm"),
                             HasSubstr("it is 8 mm wide, so that a mesh of 4 mm would do"))));
  tools.write("punch", moved(pin, {20, 20, 0}));
  EXPECT_THAT(check_tools(read_scene(tools, {"punch"}, {"blank.mesh_size=20"})),
              Not(Contains(HasSubstr("can touch no node"))));
}

TEST(Tools, HoleInASolidIsWarnedOfWithItsPlace) {
  const OwnTools tools(8);
  Soup open;
  const Soup closed = test::make_punch(100, 50, 15, 60, 9);
  for (std::size_t t = 0; t < closed.size(); t += 3)
    if ((closed[t] + closed[t + 1] + closed[t + 2]).z() / 3 > 1) open.insert(open.end(), &closed[t], &closed[t] + 3);
  tools.write("punch", open);
  const int sides = geometry::parse_stl(test::to_binary_stl(open), "punch.stl").open_sides;
  ASSERT_GT(sides, 2);
  const std::string opening = "tools.punch.stl: the surface is open at " + std::to_string(sides) + " sides, near (";
  EXPECT_THAT(check_tools(read_scene(tools, {"punch"}, {"blank.mesh_size=10"})),
              Contains(AllOf(HasSubstr(opening),
                             HasSubstr("where the blank can get behind it; close it to a solid"))));
  // so is one triangle at the top of a ball, where the blank never comes
  Soup ball = test::make_ball(40, 12);
  std::size_t top = 0;
  for (std::size_t t = 0; t < ball.size(); t += 3)
    if ((ball[t] + ball[t + 1] + ball[t + 2]).z() > (ball[top] + ball[top + 1] + ball[top + 2]).z()) top = t;
  ball.erase(ball.begin() + static_cast<std::ptrdiff_t>(top), ball.begin() + static_cast<std::ptrdiff_t>(top) + 3);
  tools.write("punch", ball);
  EXPECT_THAT(check_tools(read_scene(tools, {"punch"}, {"blank.mesh_size=10"})),
              Contains(HasSubstr("tools.punch.stl: the surface is open at 3 sides, near (")));
}

TEST(Tools, BytesAfterTheLastTriangleAreWarnedOf) {
  const OwnTools tools(8);
  const Soup die = test::make_plate(100, 22, 10, 80, 160, 8, true);
  test::write_file(tools.path("die"), test::to_binary_stl(die) + "made by x");
  EXPECT_THAT(check_tools(read_scene(tools, {"die"}, {"blank.mesh_size=10"})),
              ElementsAre("tools.die.stl: holds 9 bytes after its last triangle, which are not read"));
}

TEST(Tools, ForgottenPunchAndStrokeAreWarnedOf) {
  const OwnTools tools(4);
  scene::Scene scene = read_scene(tools, {}, {"blank.mesh_size=10"});
  EXPECT_THAT(check_tools(scene), IsEmpty());
  scene.motion.stroke = 0;
  EXPECT_THAT(check_tools(scene), ElementsAre(HasSubstr("motion.stroke: is 0: the punch stays")));
  scene.tools.punch.reset();
  EXPECT_THAT(check_tools(scene), IsEmpty());
  scene.motion.stroke = 60;
  EXPECT_THAT(check_tools(scene), ElementsAre(HasSubstr("tools.punch: is missing: motion.stroke = 60 mm moves")));
}

TEST(Tools, FileThatHasChangedSinceTheSceneWasReadIsRefused) {
  const OwnTools tools(8);
  const scene::Scene scene = read_scene(tools);
  tools.write("die", test::make_plate(100, 22, 10, 80, 160, 9, true));
  EXPECT_THAT(refuse(scene), HasSubstr("has changed since the scene was resolved"));
}

/// A solver on another host reads the resolved scene without the tools' files.
TEST(Tools, ResolvedSceneNeedsNoFilesToBeRead) {
  std::string text;
  std::uint64_t digest = 0;
  {
    const OwnTools tools(4);
    const scene::Scene scene = read_scene(tools);
    text = scene.text;
    digest = scene.digest;
    EXPECT_THAT(text, HasSubstr("path: " + tools.path("punch")));
  }
  EXPECT_EQ(scene::parse_scene(text, "resolved").digest, digest);
}

}  // namespace
