/// Whatever happens to the participants, a run ends with an exit code and a sentence that names who.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "coordinator/scripted_link.hpp"

namespace {

using namespace interply;
using namespace interply::test;
using exchange::StopReason;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using Kind = exchange::Event::Kind;

/// A few steps without a punch: what the layers do not do (move) does not matter here.
scene::Scene make_scene() {
  scene::Scene scene = read_flat_stack({"motion.forming_time=2e-5", "tools.blank_holder.ramp=1e-5"});
  scene.time.energy_limit = 1e9;
  return scene;
}

void expect_stopped(const ScriptedRun& run, const ScriptedLink& link, int exit_code, StopReason reason,
                    const std::string& status) {
  EXPECT_EQ(run.outcome.exit_code, exit_code);
  ASSERT_EQ(link.stopped.size(), 1u);
  EXPECT_EQ(link.stopped[0].first, reason);
  EXPECT_EQ(link.stopped[0].second, run.outcome.message);
  EXPECT_EQ(run.sink.end.status, status);
  EXPECT_EQ(run.sink.end.message, run.outcome.message);
  EXPECT_EQ(run.outcome.digest, "");
}

TEST(Supervision, RunThatNobodyDisturbsIsDone) {
  ScriptedLink link(make_scene());
  link.everyone_joins_and_moves();
  ScriptedRun run;
  run.run(make_scene(), link);
  EXPECT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  EXPECT_TRUE(link.stopped.empty());
  EXPECT_EQ(run.sink.end.status, "done");
  EXPECT_EQ(run.outcome.digest.size(), 16u);
  EXPECT_EQ(run.sink.end.frames_complete, 5);
  EXPECT_EQ(run.sink.header.layers.size(), 5u);
  EXPECT_THAT(run.log, Contains(HasSubstr("ply_2 joined")));
}

TEST(Supervision, EveryLayerIsAnsweredOnceAStepInOrder) {
  for (const bool eager : {false, true}) {
    ScriptedLink link(make_scene());
    link.everyone_joins_and_moves();
    link.eager = eager;
    ScriptedRun run;
    run.run(make_scene(), link);
    EXPECT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
    std::vector<std::int64_t> next(5, 0);
    for (const auto& [who, step] : link.answers) EXPECT_EQ(step, next[static_cast<std::size_t>(who)]++);
    for (const std::int64_t n : next) EXPECT_EQ(n, next[0]);
    EXPECT_GT(next[0], 10);
  }
}

/// An eager layer's next motion, and its Final, arrive while others are still at the step before.
TEST(Supervision, LayersAStepAheadChangeNothing) {
  std::vector<std::string> digests;
  std::vector<double> forces;
  bool was_ahead = false, ended_early = false;
  for (const bool eager : {false, true}) {
    const scene::Scene scene = make_scene();
    ScriptedLink link(scene);
    link.everyone_joins_and_moves();
    link.eager = eager;
    if (eager) {
      link.on_answer = [&](int who, const exchange::Force& force) {
        const bool others_on_their_way =
            std::any_of(link.events.begin(), link.events.end(), [](auto& e) { return e.kind == Kind::Moved; });
        was_ahead |= !force.last && others_on_their_way;
        ended_early |= force.last && others_on_their_way;
        link.answer(who, force);
      };
    }
    ScriptedRun run;
    run.run(scene, link);
    EXPECT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
    digests.push_back(run.outcome.digest);
    forces.push_back(run.sink.rows.back().blank_holder_force);
    EXPECT_EQ(run.sink.rows.back().time, scene.end_time());
  }
  EXPECT_TRUE(was_ahead);
  EXPECT_TRUE(ended_early);
  EXPECT_EQ(digests[0], digests[1]);
  EXPECT_EQ(forces[0], forces[1]);
  EXPECT_GT(forces[0], 0);
}

TEST(Supervision, MotionsBeforeTheLastOneHasJoinedAreKept) {
  const scene::Scene scene = make_scene();
  ScriptedLink link(scene);
  for (int i = 0; i < 5; ++i) {
    link.events.push_back({.kind = Kind::Joined, .who = i});
    link.events.push_back({.kind = Kind::Moved, .who = i});
  }
  ScriptedRun run;
  run.run(scene, link);
  EXPECT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
}

TEST(Supervision, StartUpDeadlineSaysWhoJoinedAndWhoIsMissing) {
  scene::Scene scene = make_scene();
  scene.exchange.startup_deadline = 0.3;
  ScriptedLink link(scene);
  link.events.push_back({.kind = Kind::Joined, .who = 1});
  link.events.push_back({.kind = Kind::Joined, .who = 4});
  ScriptedRun run;
  run.run(scene, link);
  expect_stopped(run, link, 4, StopReason::Lost, "lost");
  EXPECT_EQ(run.outcome.message,
            "start-up deadline of 0.3 s passed: joined ply_1, sheet_upper; missing sheet_lower, ply_2, ply_3");
}

TEST(Supervision, StartUpDeadlineWithNobodySaysSo) {
  scene::Scene scene = make_scene();
  scene.exchange.startup_deadline = 0.1;
  ScriptedLink link(scene);
  ScriptedRun run;
  run.run(scene, link);
  expect_stopped(run, link, 4, StopReason::Lost, "lost");
  EXPECT_THAT(run.outcome.message, HasSubstr("joined nobody; missing sheet_lower, ply_1, ply_2, ply_3, sheet_upper"));
}

/// The first rung of the ladder, at 5 s, in both waits.
TEST(Supervision, LadderSaysWhoIsWaitedForAtWhichStep) {
  scene::Scene scene = make_scene();
  scene.exchange.wait_deadline = 5.2;
  ScriptedLink link(scene);
  link.everyone_joins_and_moves();
  link.on_answer = [&](int who, const exchange::Force& force) {
    if (who == 2 && force.step == 3) return;  // ply_2 falls silent
    link.answer(who, force);
  };
  ScriptedRun run;
  run.run(scene, link);
  expect_stopped(run, link, 4, StopReason::Lost, "lost");
  EXPECT_THAT(run.log, Contains("waiting for ply_2 at step 4 for 5 s"));
  EXPECT_EQ(run.outcome.message, "no word from ply_2 at step 4 for 5.2 s");
  ASSERT_FALSE(run.progress.empty());
  EXPECT_EQ(run.progress.back().waiting_for, "ply_2");
}

TEST(Supervision, SilentLayerAtTheStartIsNamed) {
  scene::Scene scene = make_scene();
  scene.exchange.wait_deadline = 0.2;
  ScriptedLink link(scene);
  for (int i = 0; i < 5; ++i) link.events.push_back({.kind = Kind::Joined, .who = i});
  for (const int i : {4, 2, 0}) link.events.push_back({.kind = Kind::Moved, .who = i});
  ScriptedRun run;
  run.run(scene, link);
  expect_stopped(run, link, 4, StopReason::Lost, "lost");
  EXPECT_THAT(run.outcome.message, HasSubstr("no word from ply_1, ply_3 at step 0"));
}

TEST(Supervision, SilentLayerAfterTheLastStepIsNamed) {
  scene::Scene scene = make_scene();
  scene.exchange.wait_deadline = 0.2;
  ScriptedLink link(scene);
  link.everyone_joins_and_moves();
  link.on_answer = [&](int who, const exchange::Force& force) {
    if (who == 3 && force.last) return;  // ply_3 never sends its Final
    link.answer(who, force);
  };
  ScriptedRun run;
  run.run(scene, link);
  expect_stopped(run, link, 4, StopReason::Lost, "lost");
  EXPECT_THAT(run.outcome.message, AllOf(HasSubstr("no word from ply_3"), Not(HasSubstr("ply_2"))));
}

TEST(Supervision, DivergedLayerEndsTheRunWithItsOwnSentence) {
  for (const int steps : {-1, 0, 4}) {  // -1: before everyone has joined
    const scene::Scene scene = make_scene();
    ScriptedLink link(scene);
    if (steps < 0) link.events.push_back({.kind = Kind::Failed, .who = 2, .message = "ply_2: folded"});
    link.everyone_joins_and_moves();
    link.on_answer = [&](int who, const exchange::Force& force) {
      link.answer(who, force);
      if (who == 2 && force.step == steps)
        link.events.push_front({.kind = Kind::Failed, .who = 2, .message = "ply_2: folded"});
    };
    ScriptedRun run;
    run.run(scene, link);
    expect_stopped(run, link, 3, StopReason::Diverged, "diverged");
    EXPECT_EQ(run.outcome.message, "ply_2: folded");
  }
}

TEST(Supervision, LostConnectionNamesLayerStepAndCause) {
  const scene::Scene scene = make_scene();
  ScriptedLink link(scene);
  link.everyone_joins_and_moves();
  link.on_answer = [&](int who, const exchange::Force& force) {
    link.answer(who, force);
    if (who == 3 && force.step == 2)
      link.events.push_back({.kind = Kind::Suspect, .who = 3, .message = "its process was killed"});
  };
  ScriptedRun run;
  run.run(scene, link);
  expect_stopped(run, link, 4, StopReason::Lost, "lost");
  EXPECT_THAT(run.outcome.message, AllOf(HasSubstr("lost ply_3 at step"), HasSubstr("its process was killed")));
}

TEST(Supervision, ConnectionOfAStrangerIsNoReasonToStop) {
  const scene::Scene scene = make_scene();
  ScriptedLink link(scene);
  link.events.push_back({.kind = Kind::Suspect, .who = -1, .message = "a connection was closed"});
  link.everyone_joins_and_moves();
  link.events.push_back({.kind = Kind::Suspect, .who = -1, .message = "a connection was closed"});
  ScriptedRun run;
  run.run(scene, link);
  EXPECT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
}

TEST(Supervision, UndeliverableAnswerNamesItsLayer) {
  const scene::Scene scene = make_scene();
  ScriptedLink link(scene);
  link.everyone_joins_and_moves();
  link.gone = 1;
  ScriptedRun run;
  run.run(scene, link);
  expect_stopped(run, link, 4, StopReason::Lost, "lost");
  EXPECT_THAT(run.outcome.message, HasSubstr("lost ply_1 at step 0"));
}

/// A layer diverges in its internal forces while the coordinator computes contact: when its answer cannot be delivered
/// any more, its failure is already on its way.
TEST(Supervision, FailureThatOvertookItsAnswerIsADivergenceNotALoss) {
  const scene::Scene scene = make_scene();
  ScriptedLink link(scene);
  link.everyone_joins_and_moves();
  link.on_answer = [&](int who, const exchange::Force& force) {
    link.answer(who, force);
    if (force.step != 3 || who != 4) return;
    link.gone = 3;
    link.events.push_back({.kind = Kind::Failed, .who = 3, .message = "ply_3: folded"});
  };
  ScriptedRun run;
  run.run(scene, link);
  expect_stopped(run, link, 3, StopReason::Diverged, "diverged");
  EXPECT_EQ(run.outcome.message, "ply_3: folded");
}

TEST(Supervision, CancelEndsTheRunWhereverItIs) {
  for (const int steps : {-1, 0, 4, 1000000}) {  // before the first joins, at the start, in the middle, at the end
    const scene::Scene scene = make_scene();
    ScriptedLink link(scene);
    link.everyone_joins_and_moves();
    if (steps < 0) link.cancel("interrupted by SIGINT");
    link.on_answer = [&](int who, const exchange::Force& force) {
      link.answer(who, force);
      if (who == 2 && (force.step == steps || (force.last && steps == 1000000))) link.cancel("interrupted by SIGINT");
    };
    ScriptedRun run;
    run.run(scene, link);
    expect_stopped(run, link, 5, StopReason::Cancelled, "cancelled");
    if (steps < 0)
      EXPECT_EQ(run.outcome.message, "the run was cancelled before the first step (interrupted by SIGINT)");
    else
      EXPECT_THAT(run.outcome.message,
                  testing::MatchesRegex("the run was cancelled at step [0-9]+, 0\\.0[0-9]+ ms, stroke 0\\.0 mm "
                                        "\\(interrupted by SIGINT\\)"));
  }
}

/// Layers that do not answer to the force on them do work that nobody put in: the books must notice.
TEST(Supervision, EnergyThatNobodyPutInStopsTheRunAndNamesTheShare) {
  scene::Scene scene = read_flat_stack({"motion.forming_time=2e-3", "tools.blank_holder.ramp=1e-4"});
  struct Inventing : ScriptedLink {
    using ScriptedLink::ScriptedLink;
    mutable exchange::Motion changed;
    const exchange::Motion& motion(int who) const override {
      if (who != 3) return ScriptedLink::motion(who);
      changed = ScriptedLink::motion(who);
      changed.energies.internal = 500;  // mJ from nowhere
      return changed;
    }
  } link(scene);
  link.everyone_joins_and_moves();
  ScriptedRun run;
  run.run(scene, link);
  expect_stopped(run, link, 3, StopReason::Diverged, "diverged");
  EXPECT_THAT(run.outcome.message, AllOf(HasSubstr("energy residual"), HasSubstr("limit 2 %"), HasSubstr("step"),
                                         HasSubstr("time"), HasSubstr("largest share layer ply_3"), HasSubstr("cure")));
}

}  // namespace
