/// V13: the five-layer stack carries the blank holder's pressure, uniformly away from the opening.
#include <gtest/gtest.h>

#include <cmath>

#include "support/in_process_run.hpp"
#include "support/results.hpp"

namespace {

using namespace interply;
using mechanics::Scalars;

constexpr int kFrames = 150;  ///< of which the second half is averaged: the stack has come to rest but for ripples

bool is_late(int frame) { return frame > kFrames / 2; }

/// Mean over the late frames of the pressure at each node of an interface, MPa.
Scalars compute_mean_pressure(const test::MemorySink& sink, const std::string& interface) {
  Scalars mean;
  int frames = 0;
  for (const observe::InterfaceFrame& frame : sink.interfaces) {
    if (frame.interface != interface || !is_late(frame.frame)) continue;
    const auto& p = test::field(frame, "pressure");
    const Eigen::Map<const Scalars> pressure(p.data(), static_cast<Eigen::Index>(p.size()));
    mean = frames++ ? Scalars(mean + pressure) : Scalars(pressure);
  }
  return mean / frames;
}

double compute_mean_force(const test::MemorySink& sink, const std::string& tool) {
  double sum = 0;
  int frames = 0;
  for (const observe::ToolFrame& frame : sink.tools) {
    if (frame.tool != tool || !is_late(frame.frame)) continue;
    sum += frame.force[2];
    ++frames;
  }
  return sum / frames;
}

/// Away from the opening and the rim the stack carries what the blank holder presses with, and every interface carries
/// the whole of the tools' forces.
TEST(FiveLayerStack, PressureIsUniformAndTheBlankHoldersThroughEveryInterface) {
  const scene::Scene scene =
      test::read_test_scene("flat_stack.yaml", {"blank.mesh_size=14", "motion.forming_time=3e-3",
                                                "record.frames=" + std::to_string(kFrames), "contact.damping=0.3"});
  const auto run = test::run_in_process(scene);
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  const auto& layer = run.sink->mesh_of("ply_1");
  const auto& reference = layer.reference;
  const mechanics::TriangleMesh mesh{.reference = reference, .triangles = layer.triangles};
  const Scalars areas = mechanics::compute_tributary_areas(mesh);
  const double holder = compute_mean_force(*run.sink, "blank_holder"), die = -compute_mean_force(*run.sink, "die");
  double least = 1e300, largest = 0;
  for (const std::string name : {"sheet_lower|ply_1", "ply_1|ply_2", "ply_2|ply_3", "ply_3|sheet_upper"}) {
    const Scalars mean = compute_mean_pressure(*run.sink, name);
    // 40 mm away from the opening's farthest corner, 58 + 32 mm from its centre, and off the rim
    int nodes = 0;
    for (Eigen::Index i = 0; i < mean.size(); ++i) {
      const double x = reference(0, i), y = reference(1, i);
      if (std::hypot(x, y) < 58 + 32 + 40 || std::abs(x) > 140 - 19 || y > 140 - 19) continue;
      least = std::min(least, mean(i));
      largest = std::max(largest, mean(i));
      ++nodes;
    }
    EXPECT_GE(nodes, 5);
    test::expect_result({.row = "V13",
                         .quantity = "resultant of " + name + " under the blank holder",
                         .source = "mean force of blank holder and die",
                         .reference = 0.5 * (holder + die),
                         .ours = (mean * areas).sum(),
                         .unit = "N",
                         .tolerance = 1e-3,
                         .mesh = "14 mm, matching"});
  }
  test::expect_result({.row = "V13",
                       .quantity = "interior pressure of the flat stack, all interfaces",
                       .source = "blank-holder pressure",
                       .reference = 2.0,
                       .ours = 0.5 * (least + largest),
                       .unit = "MPa",  // the land's edge is met to within the nodes that lie on it
                       .mesh = "14 mm, matching"});
  test::expect_result({.row = "V13",
                       .quantity = "interior pressure of the flat stack: (largest - least)/mean over all interfaces",
                       .source = "uniform",
                       .reference = 0,
                       .ours = 2 * (largest - least) / (largest + least),
                       .tolerance = 0.01,
                       .absolute = true,
                       .mesh = "14 mm, matching"});
}

}  // namespace
