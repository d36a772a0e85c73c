/// The half model is one half of the full model.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "support/in_process_run.hpp"

namespace {

using namespace interply;

const mechanics::NodalVectors& position_of(const test::MemorySink& sink, const std::string& layer) {
  return sink.last_of_layer(layer).position;
}

/// Largest distance between a layer of the half model and the same nodes, and their mirror images, of the full model.
double compare(const test::MemorySink& half, const test::MemorySink& full, const std::string& layer) {
  const auto key = [](double x, double y) { return std::pair{std::lround(100 * x), std::lround(100 * y)}; };
  const auto &X_full = full.mesh_of(layer).reference, &X = half.mesh_of(layer).reference;
  const auto &x_full = position_of(full, layer), &x = position_of(half, layer);
  std::map<std::pair<long, long>, Eigen::Index> node;
  for (Eigen::Index i = 0; i < X_full.cols(); ++i) node[key(X_full(0, i), X_full(1, i))] = i;
  double largest = 0;
  for (Eigen::Index i = 0; i < X.cols(); ++i) {
    const mechanics::Vector3 mine = mechanics::at(x, i);
    const mechanics::Vector3 same = mechanics::at(x_full, node.at(key(X(0, i), X(1, i))));
    const mechanics::Vector3 other = mechanics::at(x_full, node.at(key(X(0, i), -X(1, i))));
    largest =
        std::max({largest, (mine - same).norm(), (mine - other.cwiseProduct(mechanics::Vector3(1, -1, 1))).norm()});
  }
  return largest;
}

/// With an even number of elements across the half width the alternating diagonals of the full mesh are mirror images
/// in y = 0 and its upper half is the half model's mesh: both are the same mechanics. Not the same bits: a node of the
/// full model on y = 0 faces one of two mirrored triangles, so that its smooth surface has a one-sided slope, and slack
/// plies that touch and part amplify that. Tolerance: 0.5 % of the stroke, 0.5 % of forces and energies.
void expect_half_of_full(bool with_sheets) {
  const auto form = [&](const std::string& symmetry) {
    scene::Scene scene = test::read_test_scene(
        "flat_stack.yaml", {"blank.mesh_size=17.5", "motion.stroke=4", "motion.forming_time=2.4e-3", "record.frames=1",
                            "blank.symmetry=" + symmetry});
    if (!with_sheets) scene.layers = {scene.layers[1], scene.layers[2], scene.layers[3]};
    return test::run_in_process(scene);
  };
  const auto half = form("half"), full = form("full");
  ASSERT_EQ(half.outcome.exit_code, 0) << half.outcome.message;
  ASSERT_EQ(full.outcome.exit_code, 0) << full.outcome.message;
  for (const observe::LayerMesh& mesh : half.sink->meshes) {
    const double deepest = (mesh.reference - position_of(*half.sink, mesh.layer)).row(2).maxCoeff();
    const double difference = compare(*half.sink, *full.sink, mesh.layer);
    testing::Test::RecordProperty(mesh.layer, std::to_string(difference));
    EXPECT_NEAR(deepest, 4, 0.2) << mesh.layer;
    EXPECT_LT(difference, 4 * 5e-3) << mesh.layer;
  }
  const auto &h = half.sink->rows.back(), &f = full.sink->rows.back();
  EXPECT_NEAR(f.blank_holder_target, 2 * h.blank_holder_target, 1e-9 * f.blank_holder_target);
  EXPECT_NEAR(f.punch_force, 2 * h.punch_force, 5e-3 * f.punch_force);
  EXPECT_NEAR(f.external, 2 * h.external, 5e-3 * f.external);
  EXPECT_NEAR(f.internal, 2 * h.internal, 5e-3 * f.internal);
}

TEST(Symmetry, HalfModelOfThePliesMovesAsTheFullModel) { expect_half_of_full(false); }
TEST(Symmetry, HalfModelOfTheLaminateMovesAsTheFullModel) { expect_half_of_full(true); }

}  // namespace
