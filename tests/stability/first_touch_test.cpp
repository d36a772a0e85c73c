/// The energy limit at the first touch of a fast punch, when the energies of the laminate are next to nothing: a loss
/// that is nothing beside the work to come does not end the run, a divergence does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "support/in_process_run.hpp"
#include "support/point_masses.hpp"
#include "support/tool_surfaces.hpp"

namespace {

using namespace interply;
using testing::HasSubstr;

constexpr double kRadius = 15, kBeside = 10, kMesh = 20;  // mm

/// A sheet under a ball whose tip comes down between two nodes, both `kBeside` from its axis: they are first hit at 3.8
/// of 12 mm of stroke, at nine tenths of the punch's largest speed.
class FirstTouch : public testing::Test {
 protected:
  FirstTouch() {
    test::Soup ball = test::make_ball(kRadius, 12);
    for (auto& corner : ball) corner.x() += kBeside;
    test::write_file(stl_.string(), test::to_binary_stl(ball));
    scene = scene::parse_scene(
        "name: bump\n"
        "blank: {length: 120, width: 120, symmetry: full, mesh_size: " + std::to_string(kMesh) + "}\n"
        "layers: [{name: sheet, thickness: 1.0, density: 7.85e-9, law: {j2: {}}}]\n"
        "tools:\n"
        "  punch: {stl: " + stl_.string() + "}\n"
        "  die: {edge: 50, offset: 16, shoulder: 8}\n"
        "  blank_holder: {edge: 50, offset: 16, shoulder: 8, pressure: 0.2, ramp: 0.5e-3}\n"
        "motion: {stroke: 12, forming_time: 3e-3}\n"
        "contact: {reference_pressure: 30}\n"
        "record: {frames: 2, history: 2000}\n",
        "bump.yaml");
  }
  ~FirstTouch() override { std::filesystem::remove(stl_); }

  /// Stroke at which the ball reaches the two nodes.
  static double first_stroke() { return kRadius - std::sqrt(kRadius * kRadius - kBeside * kBeside); }

  scene::Scene scene;

 private:
  std::filesystem::path stl_ =
      std::filesystem::path(testing::TempDir()) / ("bump_" + std::to_string(getpid()) + ".stl");
};

/// What the step of the touch loses is a quarter of all energies at that step, and a thousandth of the work of the run.
TEST_F(FirstTouch, ALossThatIsNothingBesideTheWorkOfTheRunDoesNotEndIt) {
  const auto run = test::run_in_process(scene);
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  double hit = 0;  // largest residual / energies of its step
  for (const auto& row : run.sink->rows) {
    const double residual =
        row.kinetic + row.internal + row.contact + row.friction + row.damping - row.thinning - row.external;
    if (row.stroke > first_stroke() - 0.1) hit = std::max(hit, std::abs(residual) / std::max(row.external, 1.0));
  }
  EXPECT_GT(hit, scene.time.energy_limit) << "this scene is no test of it";
  EXPECT_LT(run.outcome.measures.largest_residual, 0.5 * scene.time.energy_limit);
  EXPECT_LT(std::abs(run.outcome.measures.final_residual), 2e-3);
}

/// The same at any speed: what a hit loses and what it is measured against both go with the square of it.
TEST_F(FirstTouch, FormingFasterOrSlowerMakesNoDifference) {
  for (const double time : {1.5e-3, 12e-3}) {
    scene.motion.forming_time = time;
    const auto run = test::run_in_process(scene);
    EXPECT_EQ(run.outcome.exit_code, 0) << time << " s: " << run.outcome.message;
    EXPECT_LT(run.outcome.measures.largest_residual, 0.5 * scene.time.energy_limit) << time << " s";
  }
}

/// Twice the stable increment: the sheet flies apart as soon as the ball disturbs it. The run ends there, long before
/// its stroke is done.
TEST_F(FirstTouch, ADivergenceAtTheFirstTouchEndsTheRunThere) {
  scene.time.safety = 2;
  const auto run = test::run_in_process(scene);
  EXPECT_EQ(run.outcome.exit_code, 3);
  EXPECT_THAT(run.outcome.message, HasSubstr("energy residual"));
  EXPECT_THAT(run.outcome.message, HasSubstr("time.safety"));
  EXPECT_LT(run.sink->rows.back().stroke, first_stroke() + 1);
}

/// Contact alone beyond its limit: masses without elements, thrown off by springs too stiff for the increment.
TEST_F(FirstTouch, ContactTooStiffForTheIncrementEndsTheRunThere) {
  scene.time.safety = 3;
  const auto run = test::run_in_process(scene, {.factory = test::make_point_masses});
  EXPECT_EQ(run.outcome.exit_code, 3);
  EXPECT_THAT(run.outcome.message, HasSubstr("energy residual"));
  EXPECT_LT(run.sink->rows.back().stroke, first_stroke() + 1);
}

}  // namespace
