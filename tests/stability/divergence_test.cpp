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
using testing::Not;

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
  explicit NotANumber(Eigen::Index n_nodes, double from) : PointMasses(n_nodes), from_(from) {}
  void compute_internal_forces(const mechanics::NodalVectors& x, const solve::Instant& now,
                               mechanics::NodalVectors& f) override {
    PointMasses::compute_internal_forces(x, now, f);
    if (now.time > from_) f(2, 5) = std::numeric_limits<double>::quiet_NaN();
  }

 private:
  double from_;  ///< s
};

/// Layers that are masses only; one of them has a NaN when nine tenths of the time are over.
test::InProcessResult run_until_nan(const scene::Scene& scene) {
  const auto make = [](const scene::Scene& s, int layer,
                       const mechanics::TriangleMesh& mesh) -> std::unique_ptr<solve::LayerMechanics> {
    if (layer == 2) return std::make_unique<NotANumber>(mesh.n_nodes(), 0.9 * s.end_time());
    return std::make_unique<test::PointMasses>(mesh.n_nodes());
  };
  return test::run_in_process(scene, {.factory = make});
}

TEST(Divergence, NaNInALayerWithoutElementsStopsTheRunAtItsNode) {
  const auto run = run_until_nan(test::read_test_scene("flat_stack.yaml", {"motion.forming_time=5e-4"}));
  EXPECT_EQ(run.outcome.exit_code, 3);
  EXPECT_THAT(run.outcome.message, AllOf(HasSubstr("layer ply_2: its node 5 is at ("), HasSubstr("nan) mm at step"),
                                         Not(HasSubstr("midsurfaces"))));
}

/// A layer whose law has no tangent any more.
class WithoutIncrement : public test::PointMasses {
 public:
  using PointMasses::PointMasses;
  double compute_stable_increment(const mechanics::NodalVectors&) override {
    return std::numeric_limits<double>::quiet_NaN();
  }
};

TEST(Divergence, IncrementThatIsNoNumberStopsTheRun) {
  const auto make = [](const scene::Scene&, int layer,
                       const mechanics::TriangleMesh& mesh) -> std::unique_ptr<solve::LayerMechanics> {
    if (layer == 1) return std::make_unique<WithoutIncrement>(mesh.n_nodes());
    return std::make_unique<test::PointMasses>(mesh.n_nodes());
  };
  const auto run = test::run_in_process(test::read_test_scene("flat_stack.yaml"), {.factory = make});
  EXPECT_EQ(run.outcome.exit_code, 3);
  EXPECT_THAT(run.outcome.message, HasSubstr("layer ply_1: its stable increment is nan s"));
}

/// 2 % of a thickness at 0.03 MPa are 133 % at the 2 MPa of the blank holder.
TEST(Divergence, AfterContactThatWasTooSoftSaysSo) {
  const scene::Scene scene = test::read_test_scene(
      "flat_stack.yaml", {"motion.forming_time=5e-4", "contact.reference_pressure=0.03", "time.vote_every=1"});
  const auto run = run_until_nan(scene);
  EXPECT_EQ(run.outcome.exit_code, 3);
  EXPECT_THAT(run.outcome.message,
              AllOf(HasSubstr("layer ply_2: its node 5"), ContainsRegex("interface [a-z_0-9]*[|][a-z_0-9]* was pressed"),
                    HasSubstr("past the midsurfaces: contact.reference_pressure = 0.03 MPa is too soft")));
  EXPECT_EQ(run.sink->end.message, run.outcome.message);
}

}  // namespace
