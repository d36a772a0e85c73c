#include "coordinator/plausibility.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "coordinator/scripted_link.hpp"

namespace {

using namespace interply;
using coordinator::Plausibility;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

class PlausibilityOfAPly : public testing::Test {
 protected:
  scene::Scene scene = test::read_flat_stack({"motion.stroke=20"});
  mechanics::TriangleMesh mesh = solve::make_layer_mesh(scene, 1);
  Plausibility check{scene, 1, mesh};
  exchange::Motion motion{.step = 40, .vote = 1e-6, .position = mesh.reference, .thickness = {}};
};

TEST_F(PlausibilityOfAPly, NothingIsSaidOfWhatCanBe) {
  EXPECT_EQ(check.find_fault(motion), "");
  motion.position.row(2) -= 20;  // drawn along by the whole stroke
  motion.thickness = mechanics::Scalars::Constant(mesh.n_nodes(), 0.1 * 1.2);
  motion.vote = 1e-10;
  motion.energies = {.kinetic = 1e9, .internal = -3, .internal_work = 1, .contact_work = -1e9};
  EXPECT_EQ(check.find_fault(motion), "");
}

TEST_F(PlausibilityOfAPly, APositionThatIsNoneIsNamedWithItsNodeAndStep) {
  for (const double bad : {kNaN, kInfinity, -kInfinity, 1e300, 1e9}) {
    motion.position = mesh.reference;
    motion.position(1, 17) = bad;
    motion.position(0, 30) = kNaN;  // the first one is named
    EXPECT_THAT(check.find_fault(motion), AllOf(HasSubstr("layer ply_1: its node 17 is at ("), HasSubstr("at step 40")))
        << bad;
  }
}

TEST_F(PlausibilityOfAPly, AThicknessThatTheSceneDoesNotAllowIsNamed) {
  for (const double bad : {kNaN, kInfinity, 0.0, -1.2, 1.2e-3, 1200.0}) {
    motion.thickness = mechanics::Scalars::Constant(mesh.n_nodes(), 1.2);
    motion.thickness(9) = bad;
    EXPECT_THAT(check.find_fault(motion), AllOf(HasSubstr("layer ply_1: its node 9 is "), HasSubstr("mm thick"),
                                                HasSubstr("the scene's 1.2 mm"), HasSubstr("at step 40")))
        << bad;
  }
}

TEST_F(PlausibilityOfAPly, AnIncrementWithWhichTheRunWouldNotEndIsNamed) {
  for (const double bad : {kNaN, kInfinity, 0.0, -1e-7, 1e-300, 1e-15}) {
    motion.vote = bad;
    EXPECT_THAT(check.find_fault(motion),
                AllOf(HasSubstr("layer ply_1: its stable increment is "), HasSubstr("check the tangent of its law")))
        << bad;
  }
}

TEST_F(PlausibilityOfAPly, EnergiesThatAreNoNumbersAreNamed) {
  motion.energies.internal_work = kNaN;
  EXPECT_THAT(check.find_fault(motion), AllOf(HasSubstr("layer ply_1: its energies"), HasSubstr("at step 40")));
}

/// The neighbours have not seen anything of it: nobody was answered in that step.
TEST(Plausibility, TheCulpritEndsTheRunBeforeItsNeighboursHearOfIt) {
  const scene::Scene scene = test::read_flat_stack();
  test::ScriptedLink link(scene);
  link.everyone_joins_and_moves();
  link.motion_of(2).position(0, 3) = kNaN;
  test::ScriptedRun run;
  run.run(scene, link);
  EXPECT_EQ(run.outcome.exit_code, 3);
  EXPECT_THAT(run.outcome.message, HasSubstr("layer ply_2: its node 3 is at (nan, "));
  for (const auto& [who, step] : link.answers) EXPECT_LT(who, 1) << "a neighbour was answered";
}

/// A solver sees that its own elements are torn, after it has sent their nodes: its sentence says more.
TEST(Plausibility, WhatTheCulpritSaysOfItselfGoesFirst) {
  const scene::Scene scene = test::read_flat_stack();
  test::ScriptedLink link(scene);
  link.everyone_joins_and_moves();
  link.motion_of(2).position(0, 3) = kNaN;
  link.events.push_back({.kind = exchange::Event::Kind::Failed, .who = 2, .message = "layer ply_2, element 7"});
  test::ScriptedRun run;
  run.run(scene, link);
  EXPECT_EQ(run.outcome.exit_code, 3);
  EXPECT_EQ(run.outcome.message, "layer ply_2, element 7");
}

TEST(Plausibility, ACulpritThatLeavesIsStillNamedForWhatItSent) {
  const scene::Scene scene = test::read_flat_stack();
  test::ScriptedLink link(scene);
  link.everyone_joins_and_moves();
  link.motion_of(2).position(0, 3) = kNaN;
  link.events.push_back({.kind = exchange::Event::Kind::Suspect, .who = 2, .message = "its connection is closed"});
  test::ScriptedRun run;
  run.run(scene, link);
  EXPECT_EQ(run.outcome.exit_code, 3);
  EXPECT_THAT(run.outcome.message, HasSubstr("layer ply_2: its node 3 is at (nan, "));
}

}  // namespace
