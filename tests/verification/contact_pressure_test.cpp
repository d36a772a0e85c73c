/// V13: the five-layer stack carries the blank holder's pressure, uniformly away from the opening.
#include <gtest/gtest.h>

#include <cmath>

#include "support/in_process_run.hpp"

namespace {

using namespace interply;

/// Away from the opening and the rim the stack carries what the blank holder presses with. Mean over the second half of
/// a run in which it has come to rest.
TEST(FiveLayerStack, PressureIsUniformAndTheBlankHoldersThroughEveryInterface) {
  const scene::Scene scene =
      test::read_test_scene("flat_stack.yaml", {"motion.forming_time=3e-3", "record.frames=30", "contact.damping=0.3"});
  const auto run = test::run_in_process(scene);
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  const auto& reference = run.sink->mesh_of("ply_1").reference;
  for (const std::string name : {"sheet_lower|ply_1", "ply_1|ply_2", "ply_2|ply_3", "ply_3|sheet_upper"}) {
    mechanics::Scalars mean = mechanics::Scalars::Zero(reference.cols());
    int frames = 0;
    for (const observe::InterfaceFrame& frame : run.sink->interfaces) {
      if (frame.interface != name || frame.frame <= 15) continue;
      const auto& pressure = test::field(frame, "pressure");
      mean += Eigen::Map<const mechanics::Scalars>(pressure.data(), static_cast<Eigen::Index>(pressure.size()));
      ++frames;
    }
    mean /= frames;
    // Two elements (40 mm) away from the opening's farthest corner, 58 + 32 mm from its centre, and off the rim
    int nodes = 0;
    for (Eigen::Index i = 0; i < mean.size(); ++i) {
      const double x = reference(0, i), y = reference(1, i);
      if (std::hypot(x, y) < 58 + 32 + 40 || std::abs(x) > 140 - 19 || y > 140 - 19) continue;
      EXPECT_NEAR(mean(i), 2.0, 0.04) << name << " at " << x << ", " << y;
      ++nodes;
    }
    EXPECT_GE(nodes, 5);
  }
}

}  // namespace
