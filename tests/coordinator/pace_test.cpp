#include "coordinator/pace.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "coordinator/amplitude.hpp"

namespace {

using namespace interply;
using namespace interply::coordinator;

scene::Scene make_scene(double end, int frames, int history, int history_every = 0) {
  scene::Scene s;
  s.tools.blank_holder.ramp = 0.25 * end;
  s.motion.forming_time = 0.75 * end;
  s.record = {.frames = frames, .history = history, .history_every = history_every};
  s.time.safety = 0.9;
  return s;
}

/// All steps of a run with votes that depend on the step.
struct Step {
  double time, dt;
  int frame;
  bool row, last;
};
template <typename Votes>
std::vector<Step> walk(const scene::Scene& scene, Votes votes) {
  Pace pace(scene);
  std::vector<Step> steps;
  pace.start(votes(0));
  while (true) {
    steps.push_back({pace.time(), pace.dt(), pace.frame(), pace.has_row(), pace.is_last()});
    if (pace.is_last() || steps.size() > 100000) return steps;
    pace.advance(votes(pace.step()));
  }
}
Votes constant(double dt) { return {.stack = dt}; }

TEST(Pace, TakesTheSafeShareOfWhatTheStackAllows) {
  const auto scene = make_scene(1e-3, 0, 10);
  Pace pace(scene);
  pace.start({.layers = {2e-6, 1.5e-6, 5e-6}, .contact = 3e-6, .stack = 1e-6});
  EXPECT_DOUBLE_EQ(pace.next_dt(), 0.9e-6);
  pace.advance({.stack = 0.5e-6});
  EXPECT_DOUBLE_EQ(pace.next_dt(), 0.45e-6);
}

TEST(Pace, FallsAtOnceAndGrowsByAtMostFivePerCentAStep) {
  const auto scene = make_scene(1e-3, 0, 10);
  const auto steps = walk(scene, [](std::int64_t n) {
    return constant(n == 0 ? 1e-6 : n < 10 ? 4e-6 : n < 200 ? 1e-6 : 2e-6);
  });
  for (std::size_t n = 2; n < steps.size(); ++n) EXPECT_LE(steps[n].dt, 1.05 * steps[n - 1].dt * (1 + 1e-12));
  EXPECT_DOUBLE_EQ(steps[1].dt, 0.9e-6);
  EXPECT_DOUBLE_EQ(steps[3].dt, 1.05 * 0.9e-6);  // the votes of step n hold from n + 1 to n + 2
  EXPECT_GT(steps[11].dt, 1.2e-6);
  EXPECT_NEAR(steps[12].dt, 0.9e-6, 1e-18);
}

TEST(Pace, LandsOnTheEndWithoutATinyStep) {
  for (const double end : {1e-3, 0.77e-3, 1e-3 / 3}) {
    const auto steps = walk(make_scene(end, 7, 10), [](auto) { return constant(1.234e-6); });
    EXPECT_TRUE(steps.back().last);
    EXPECT_NEAR(steps.back().time, end, 1e-12 * end);
    for (std::size_t n = 1; n < steps.size(); ++n) {
      EXPECT_GE(steps[n].dt, 0.99 * 0.9 * 1.234e-6 * (1 - 1e-9));
      EXPECT_EQ(steps[n].last, n + 1 == steps.size());
    }
  }
}

TEST(Pace, PublishesEveryFrameOnceAtTheFirstStepAtOrAfterItsInstant) {
  for (const int frames : {1, 7, 30}) {
    const double end = 1e-3;
    const auto steps = walk(make_scene(end, frames, 10), [](auto n) { return constant(n % 100 < 50 ? 3e-6 : 1e-6); });
    int next = 0;
    for (std::size_t n = 0; n < steps.size(); ++n) {
      const double instant = next * end / frames;
      if (steps[n].frame < 0) {
        EXPECT_TRUE(next > frames || steps[n].time < instant);
        continue;
      }
      EXPECT_EQ(steps[n].frame, next);
      EXPECT_GE(steps[n].time, instant * (1 - 1e-9));
      EXPECT_LT(next > 0 ? steps[n].time - steps[n].dt : -1, instant * (1 + 1e-9));
      ++next;
    }
    EXPECT_EQ(next, frames + 1);
    EXPECT_EQ(steps.back().frame, frames);
  }
}

TEST(Pace, NeverSkipsAFrameEvenIfEveryoneCouldGoFaster) {
  const auto steps = walk(make_scene(1e-3, 50, 10), [](auto) { return constant(1.0); });
  int frames = 0;
  for (const Step& s : steps) frames += s.frame >= 0;
  EXPECT_EQ(frames, 51);
}

TEST(Pace, WithoutARecordThereAreNoFrames) {
  for (const Step& s : walk(make_scene(1e-4, 0, 10), [](auto) { return constant(1e-6); })) EXPECT_EQ(s.frame, -1);
}

TEST(Pace, HistoryRowsAreEvenInTimeWithFirstAndLastStep) {
  const auto steps = walk(make_scene(1e-3, 3, 101), [](auto n) { return constant(n < 300 ? 2e-6 : 1e-6); });
  int rows = 0;
  for (const Step& s : steps) rows += s.row;
  EXPECT_EQ(rows, 101);
  EXPECT_TRUE(steps.front().row);
  EXPECT_TRUE(steps.back().row);
}

TEST(Pace, HistoryRowsBySteps) {
  const auto steps = walk(make_scene(1e-4, 3, 1000, 7), [](auto) { return constant(1e-6); });
  for (std::size_t n = 0; n < steps.size(); ++n) EXPECT_EQ(steps[n].row, n % 7 == 0 || steps[n].last) << n;
}

TEST(SmoothStep, GoesFromZeroToOneWithoutJerk) {
  EXPECT_EQ(smooth_step(-1), 0);
  EXPECT_EQ(smooth_step(0), 0);
  EXPECT_EQ(smooth_step(1), 1);
  EXPECT_EQ(smooth_step(2), 1);
  for (const double s : {0.1, 0.3, 0.5}) EXPECT_NEAR(smooth_step(s) + smooth_step(1 - s), 1, 1e-15);
  for (const double at : {0.0, 1.0}) {  // first and second difference quotients vanish at both ends
    const double e = 1e-3, inner = at == 0 ? e : 1 - e;
    EXPECT_LT(std::abs(smooth_step(inner) - smooth_step(at)) / e, 2e-5);
    EXPECT_LT(std::abs(smooth_step(at == 0 ? 2 * e : 1 - 2 * e) - 2 * smooth_step(inner) + at) / (e * e), 0.1);
  }
  EXPECT_NEAR((smooth_step(0.5 + 1e-6) - smooth_step(0.5 - 1e-6)) / 2e-6, 1.875, 1e-8);  // steepest in the middle
}

}  // namespace
