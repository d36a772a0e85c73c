/// The first regression test of any contact: the flat stack under the blank holder, punch at rest.
#include <gtest/gtest.h>

#include <cmath>

#include "support/in_process_run.hpp"

namespace {

using namespace interply;
using test::field;

/// Mean over the frames of the second half of a run of the sum of pressure x tributary area, N.
double mean_resultant(const test::MemorySink& sink, const std::string& interface, double end_time) {
  double sum = 0;
  int frames = 0;
  for (const observe::InterfaceFrame& frame : sink.interfaces) {
    if (frame.interface != interface || frame.time < 0.5 * end_time) continue;
    const observe::LayerMesh& layer = sink.mesh_of(frame.nodes_of);
    const mechanics::TriangleMesh mesh{.reference = layer.reference, .triangles = layer.triangles};
    const mechanics::Scalars areas = mechanics::compute_tributary_areas(mesh);
    const auto& pressure = field(frame, "pressure");
    for (std::size_t i = 0; i < pressure.size(); ++i) sum += pressure[i] * areas(static_cast<Eigen::Index>(i));
    ++frames;
  }
  return sum / frames;
}

double mean_die_force(const test::MemorySink& sink, double end_time) {
  double sum = 0;
  int frames = 0;
  for (const observe::ToolFrame& frame : sink.tools) {
    if (frame.tool != "die" || frame.time < 0.5 * end_time) continue;
    sum -= frame.force[2];
    ++frames;
  }
  return sum / frames;
}

TEST(FlatStack, SqueezedFor5000StepsKeepsItsEnergyAndPassesTheBlankHolderForceOn) {
  const scene::Scene scene =
      test::read_test_scene("flat_stack.yaml", {"motion.forming_time=13e-3", "record.frames=130"});
  const auto run = test::run_in_process(scene);
  const coordinator::Measures& m = run.outcome.measures;
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  RecordProperty("largest_residual", std::to_string(m.largest_residual));

  EXPECT_GE(m.steps, 5000);
  EXPECT_LT(m.largest_residual, 1e-3);
  EXPECT_LT(std::abs(m.final_residual), 1e-3);
  const observe::HistoryRow& end = run.sink->rows.back();
  for (const double residual : end.interface_residual) EXPECT_LT(std::abs(residual), 1e-3 * end.external);
  for (const double residual : end.layer_residual) EXPECT_LT(std::abs(residual), 1e-3 * end.external);

  // the flange is what the opening, widened by its shoulder radius, leaves of the blank
  const double r = 22 + 10, flange = 0.5 * (280 * 280 - (std::sqrt(3.0) / 4 * 1e4 + 300 * r + M_PI * r * r));
  const double force = 2 * flange;  // 2 MPa
  EXPECT_NEAR(end.blank_holder_target, force, 1e-9 * force);
  EXPECT_NEAR(m.holder_mean, force, 0.01 * force);
  for (const std::string name : {"sheet_lower|ply_1", "ply_1|ply_2", "ply_2|ply_3", "ply_3|sheet_upper"})
    EXPECT_NEAR(mean_resultant(*run.sink, name, scene.end_time()), force, 0.01 * force) << name;
  EXPECT_NEAR(mean_die_force(*run.sink, scene.end_time()), force, 0.01 * force);

  for (const observe::LayerFrame& frame : run.sink->layers)
    EXPECT_LT((frame.position - run.sink->mesh_of(frame.layer).reference).abs().maxCoeff(), 0.1) << frame.layer;
}

}  // namespace
