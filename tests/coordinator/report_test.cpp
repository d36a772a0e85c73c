#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "coordinator/scripted_link.hpp"
#include "coordinator/verdict.hpp"
#include "support/own_tools.hpp"

namespace {

using namespace interply;
using namespace interply::coordinator;
using testing::HasSubstr;
using testing::Not;

TEST(ProgressLine, SaysStrokeStepIncrementTimeLeftAndResidual) {
  const std::string line = format_progress({.step = 1234,
                                            .time = 2.5e-3,
                                            .end_time = 16e-3,
                                            .dt = 4.04e-7,
                                            .stroke = 12.3,
                                            .punch_force = 1500,
                                            .residual = -0.0004,
                                            .seconds_left = 42.4});
  for (const auto* part : {"12.3 mm", "1234", "2.500/16.000 ms", "4.04e-07 s", "1.50 kN", "-0.040 %", "left 42 s"})
    EXPECT_THAT(line, HasSubstr(part));
  EXPECT_THAT(line, Not(HasSubstr("waiting")));
  EXPECT_THAT(line, Not(HasSubstr("\n")));
}

TEST(ProgressLine, SaysWhoIsWaitedForAndNoUnknownTime) {
  const std::string line = format_progress({.seconds_left = -1, .waiting_for = "ply_2"});
  EXPECT_THAT(line, HasSubstr("waiting for ply_2"));
  EXPECT_THAT(line, Not(HasSubstr("left")));
}

TEST(ProgressLine, LongTimesAreInHours) { EXPECT_THAT(format_progress({.seconds_left = 3725}), HasSubstr("1:02:05")); }

TEST(Summary, NamesEveryLayerWithItsNumbersForcesEnergiesAndPenetration) {
  scene::Scene scene = test::read_flat_stack({"motion.forming_time=2e-5", "tools.blank_holder.ramp=1e-5"});
  scene.time.energy_limit = 1e9;
  test::ScriptedLink link(scene);
  link.everyone_joins_and_moves();
  link.on_answer = [&](int who, const exchange::Force& force) {
    if (!force.last) return link.answer(who, force);
    link.push({.kind = exchange::Event::Kind::Ended,
               .who = who,
               .final = {.digest = 1, .summary = {{"shear angle up to", "deg", 12.5 + who}, {"count", "-", 3}}}});
  };
  test::ScriptedRun run;
  run.run(scene, link);
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  for (const auto* part :
       {"flat_stack", "sheet_lower", "ply_2", "fabric", "metal", "shear angle up to 14.5 deg", "count 3\n",
        "draw-in at -x, +x, +y, largest of the rim (mm): sheet_lower 0.0 0.0 0.0 0.0, ply_1 0.0 0.0 0.0 0.0", "punch force 0.000 kN (half model)",
        "target 61.253 kN", "energy (mJ)", "kinetic/internal", "penetration"})
    EXPECT_THAT(run.outcome.summary, HasSubstr(part));
  EXPECT_THAT(run.outcome.summary, Not(HasSubstr("digest")));
}

/// A pin between the nodes of layers that stay where they are, flat on each other: nothing is ever pressed.
TEST(Summary, SaysWhatNeverTouched) {
  const test::OwnTools tools(4);
  test::Soup pin = test::make_box({4, 4, 40});
  for (test::Vector3& x : pin) x += test::Vector3(10, 10, 0);
  tools.write("punch", pin);
  std::vector<std::string> overrides{"blank.mesh_size=20", "motion.forming_time=2e-5", "tools.blank_holder.ramp=1e-5",
                                     "motion.stroke=15"};
  for (const std::string& override : tools.overrides({"punch"})) overrides.push_back(override);
  scene::Scene scene = test::read_flat_stack(overrides);
  scene.time.energy_limit = 1e9;
  test::ScriptedLink link(scene);
  link.everyone_joins_and_moves();
  test::ScriptedRun run;
  run.run(scene, link);
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  EXPECT_THAT(run.outcome.summary, HasSubstr("  warning: the punch never touched "));
  EXPECT_THAT(run.outcome.summary, HasSubstr("  warning: ply_1 and ply_2 never touched: no pressure between them"));
  EXPECT_THAT(run.outcome.summary, Not(HasSubstr("blank holder never touched")));  // it has come down on the stack
}

TEST(Verdict, NamesEachThatNeverTouchedAndAMissingPunch) {
  scene::Scene scene = test::read_flat_stack();
  std::vector<bool> touched(scene.layers.size() + 2, true);
  EXPECT_TRUE(list_untouched(scene, touched, 9).empty());
  touched.front() = touched.back() = false;
  EXPECT_THAT(list_untouched(scene, touched, 9),
              testing::ElementsAre(HasSubstr("the die never touched sheet_lower: its force was 0 in all 9 steps"),
                                   HasSubstr("the punch never touched sheet_upper: its force was 0 in all 9 steps")));
  scene.tools.punch.reset();
  scene.motion.stroke = 60;
  EXPECT_THAT(list_untouched(scene, std::vector<bool>(scene.layers.size() + 1, true), 9),
              testing::ElementsAre(HasSubstr("there was no punch")));
}

}  // namespace
