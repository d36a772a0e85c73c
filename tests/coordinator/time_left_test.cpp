/// The time that a run will still take, from steps at given moments.
#include "coordinator/time_left.hpp"

#include <gtest/gtest.h>

namespace interply::coordinator {
namespace {

constexpr double kStep = 1e-6, kEnd = 1e-2;  // s of forming

/// A run whose steps take as long as it is told.
struct Steps {
  TimeLeft left{kEnd};
  double time = 0, wall = 1000;
  Steps() { left.note(time, wall); }
  void step(double seconds) { left.note(time += kStep, wall += seconds); }
  void step_for(double seconds, double each) {
    for (double t = 0; t < seconds; t += each) step(each);
  }
  double expected(double each) const { return (kEnd - time) / kStep * each; }
};

TEST(TimeLeft, IsUnknownAtFirstAndThenThatOfThePaceOfTheLastSeconds) {
  Steps run;
  run.step_for(1, 0.01);
  EXPECT_LT(run.left.seconds(), 0);
  run.step_for(5, 0.01);
  EXPECT_NEAR(run.left.seconds(), run.expected(0.01), 0.02 * run.expected(0.01));
  run.step_for(8, 0.02);
  EXPECT_NEAR(run.left.seconds(), run.expected(0.02), 0.02 * run.expected(0.02));
}

TEST(TimeLeft, IsRightAfterAPauseHoweverLong) {
  for (const double pause : {6.0, 60.0, 7200.0}) {
    Steps run;
    run.step_for(7.5, 0.01);
    run.step(pause);
    for (int i = 0; i < 1000; ++i) {
      EXPECT_NEAR(run.left.seconds(), run.expected(0.01), 0.05 * run.expected(0.01)) << pause << " s, step " << i;
      run.step(0.01);
    }
  }
}

TEST(TimeLeft, SlowStepsAreNoPauses) {
  Steps run;
  run.step_for(100, 7);
  EXPECT_NEAR(run.left.seconds(), run.expected(7), 0.05 * run.expected(7));
  Steps slower;
  slower.step_for(10, 0.1);
  slower.step_for(200, 8);
  EXPECT_NEAR(slower.left.seconds(), slower.expected(8), 0.05 * slower.expected(8));
}

}  // namespace
}  // namespace interply::coordinator
