/// The same bits whatever the threads and whatever the order in which they arrive.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "simd/target.hpp"
#include "support/in_process_run.hpp"

namespace {

using namespace interply;

/// A short run in which the punch moves and everything is loaded, slides and yields a little.
scene::Scene make_scene(const std::vector<std::string>& more = {}) {
  std::vector<std::string> overrides{"motion.stroke=4", "motion.forming_time=0.6e-3"};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return test::read_test_scene("flat_stack.yaml", overrides);
}

const test::InProcessResult& reference() {
  static const test::InProcessResult run = test::run_in_process(make_scene());
  return run;
}

void expect_same_bits(const test::InProcessResult& run) {
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  EXPECT_EQ(run.outcome.digest, reference().outcome.digest);
  EXPECT_EQ(run.outcome.measures.steps, reference().outcome.measures.steps);
  EXPECT_EQ(run.outcome.measures.largest_residual, reference().outcome.measures.largest_residual);
  EXPECT_EQ(run.sink->rows.back().punch_force, reference().sink->rows.back().punch_force);
}

TEST(Digest, OfARunThatDoesSomething) {
  ASSERT_EQ(reference().outcome.exit_code, 0) << reference().outcome.message;
  EXPECT_EQ(reference().outcome.digest.size(), 16u);
  const auto& rows = reference().sink->rows;  // so fast a sheet leaves the punch again: it need not touch at the end
  EXPECT_TRUE(std::any_of(rows.begin(), rows.end(), [](const auto& row) { return row.punch_force > 0; }));
  EXPECT_GT(reference().sink->rows.back().friction, 0);
}

TEST(Digest, IsTheSameWhenRunTwice) { expect_same_bits(test::run_in_process(make_scene())); }

TEST(Digest, DoesNotDependOnTheThreadsOfALayer) {
  expect_same_bits(test::run_in_process(make_scene({"layers.sheet_lower.threads=2", "layers.ply_1.threads=2",
                                                    "layers.ply_2.threads=3", "layers.sheet_upper.threads=2"})));
}

TEST(Digest, DoesNotDependOnTheThreadsOfTheCoordinator) {
  for (const char* threads : {"contact.threads=2", "contact.threads=3"})
    expect_same_bits(test::run_in_process(make_scene({threads})));
}

TEST(Digest, DoesNotDependOnTheWidthOfThePacks) {
  if (simd::choose_target() != simd::Choice::Avx512) GTEST_SKIP() << "this machine has one width only";
  setenv("INTERPLY_SIMD", "avx2", 1);
  const auto narrow = test::run_in_process(make_scene());
  unsetenv("INTERPLY_SIMD");
  expect_same_bits(narrow);
}

TEST(Digest, DoesNotDependOnTheOrderOfArrival) {
  for (const int seed : {1, 2}) expect_same_bits(test::run_in_process(make_scene(), {.delay_seed = seed}));
}

TEST(Digest, SeesASmallChange) {
  const auto run = test::run_in_process(make_scene({"layers.ply_2.law.woven.a=[5.5e3, 5.500001e3]"}));
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  EXPECT_NE(run.outcome.digest, reference().outcome.digest);
}

}  // namespace
