/// A run whose elements cannot go on ends with exit 3 and says which layer, element, time, quantity, and what to
/// change.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/in_process_run.hpp"
#include "support/point_masses.hpp"

namespace {

using namespace interply;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;

void expect_sentence(const test::InProcessResult& run, const std::string& layer) {
  EXPECT_EQ(run.outcome.exit_code, 3);
  EXPECT_THAT(run.outcome.message, AllOf(ContainsRegex(layer), HasSubstr("element "), ContainsRegex("t = [0-9.e+-]+ s"),
                                         testing::AnyOf(HasSubstr("lower "), HasSubstr("refine"), HasSubstr("check"))));
  EXPECT_EQ(run.sink->end.status, "diverged");
  EXPECT_EQ(run.sink->end.message, run.outcome.message);
}

/// No energy limit, so that the elements themselves must notice.
scene::Scene make_scene(const std::vector<std::string>& overrides) {
  scene::Scene scene = test::read_test_scene("flat_stack.yaml", overrides);
  scene.time.energy_limit = std::numeric_limits<double>::infinity();
  return scene;
}

TEST(Divergence, IncrementFarBeyondTheLimitIsFoundByAnElement) {
  scene::Scene scene = make_scene({"motion.stroke=10"});
  scene.time.safety = 2.5;
  expect_sentence(test::run_in_process(scene), "sheet_|ply_");
}

TEST(Divergence, PunchThatShootsThroughThePliesFoldsAnElement) {
  scene::Scene scene = make_scene({"motion.stroke=110", "motion.forming_time=0.1e-3",
                                   "layers.sheet_lower.density=6e-10", "layers.sheet_upper.density=6e-10"});
  scene.layers.erase(scene.layers.begin());
  scene.layers.pop_back();  // three plies alone
  expect_sentence(test::run_in_process(scene), "ply_");
}

/// Positions that are no numbers: the first element that sees one ends the run, and nobody else goes on with it.
class NotANumber : public test::PointMasses {
 public:
  using PointMasses::PointMasses;
  void compute_internal_forces(const mechanics::NodalVectors& x, const solve::Instant& now,
                               mechanics::NodalVectors& f) override {
    PointMasses::compute_internal_forces(x, now, f);
    if (now.time > 1e-4) f(2, 5) = std::numeric_limits<double>::quiet_NaN();
  }
};

TEST(Divergence, NaNInALayerWithoutElementsStopsTheRunByItsEnergy) {
  const scene::Scene scene = test::read_test_scene("flat_stack.yaml", {"motion.forming_time=5e-4"});
  const auto make = [](const scene::Scene&, int layer,
                       const mechanics::TriangleMesh& mesh) -> std::unique_ptr<solve::LayerMechanics> {
    if (layer == 2) return std::make_unique<NotANumber>(mesh.n_nodes());
    return std::make_unique<test::PointMasses>(mesh.n_nodes());
  };
  const auto run = test::run_in_process(scene, {.factory = make});
  EXPECT_EQ(run.outcome.exit_code, 3);
  EXPECT_THAT(run.outcome.message, HasSubstr("energy residual nan"));
  EXPECT_THAT(run.outcome.message, HasSubstr("ply_2"));
}

}  // namespace
