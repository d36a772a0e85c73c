/// V8: what the default punch demands of a ply: the angle deficit delta at its apex.
///
/// Around the apex of the sharp pyramid a surface has 360 deg - delta. Warp and weft through the apex divide that into
/// four sectors, each 90 deg before forming, so that the four shear angles add up to delta: delta/4 in the mean. A warp
/// in the plane of symmetry halves the surface, so two of them add up to delta/2, the extreme, if one sector bears it
/// alone.
#include <gtest/gtest.h>

#include <algorithm>

#include "contact/signed_distance.hpp"
#include "support/in_process_run.hpp"
#include "support/results.hpp"

namespace interply {
namespace {

using Eigen::Vector3d;
constexpr double kDegrees = 180 / M_PI;

struct Pyramid {
  double edge = 100, height = 50, radius = 15;  // mm, default punch

  /// From the three face angles at the apex, rad.
  double compute_deficit() const {
    const double flank = std::hypot(height, edge / std::sqrt(3.0));
    return 2 * M_PI - 3 * 2 * std::asin(edge / 2 / flank);
  }
};

/// The same from the tool itself: the normals of its faces span a spherical triangle whose area is the angle deficit
/// (Gauss); Oosterom and Strackee's formula.
double compute_deficit_of_tool(const Pyramid& p) {
  const contact::PyramidPunch punch(p.edge, p.height, p.radius);
  Vector3d n[3];
  for (int i = 0; i < 3; ++i) {
    const double angle = (60 + 120 * i) / kDegrees;  // the faces lie between the base corners at 0, 120 and 240 deg
    // from the middle of the sharp face 30 mm outwards
    const double rise = p.height, run = p.edge / std::sqrt(12.0), slope = std::hypot(rise, run);
    const double r = 2 * run / 3 + 30 * rise / slope, z = p.radius + 2 * rise / 3 - 30 * run / slope;
    n[i] = punch.evaluate({r * std::cos(angle), r * std::sin(angle), z}).gradient;
  }
  const double volume = n[0].dot(n[1].cross(n[2])), sum = 1 + n[0].dot(n[1]) + n[1].dot(n[2]) + n[2].dot(n[0]);
  return 2 * std::atan2(std::abs(volume), sum);
}

TEST(Tetrahedron, AngleDeficitOfThePunchSetsTheShearOfItsFaces) {
  const Pyramid punch;
  const double closed = punch.compute_deficit() * kDegrees, tool = compute_deficit_of_tool(punch) * kDegrees;
  EXPECT_NEAR(closed / 4, 28.7, 0.05);
  EXPECT_NEAR(closed / 2, 57.3, 0.05);
  const auto row = [&](const char* quantity, double part) {
    test::expect_result({.row = "V8",
                         .quantity = quantity,
                         .source = "face angles at the apex, closed form",
                         .reference = closed * part,
                         .ours = tool * part,
                         .unit = "deg",
                         .tolerance = 1e-9,
                         .mesh = "normals of the punch's distance field"});
  };
  row("angle deficit of the default punch", 1);
  row("mean face shear, delta/4", 0.25);
  row("extreme shear, delta/2", 0.5);
}

/// The expected range only: fillets, the stroke and what slips in stay below the sharp apex.
TEST(Tetrahedron, FormedPliesStayBelowTheExtremeShear) {
  const auto scene = test::read_shipped_scene("tetrahedron_fabric_coarse.yaml", {"blank.mesh_size=20"});
  const auto run = test::run_in_process(scene);
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  const double extreme = Pyramid{}.compute_deficit() / 2;
  int plies = 0;
  for (const observe::LayerFrame& frame : run.sink->layers) {
    if (frame.time < scene.end_time() * (1 - 1e-6)) continue;
    ++plies;
    double largest = 0;
    for (const double g : test::field(frame, "shear_angle")) largest = std::max(largest, std::abs(g));
    EXPECT_GT(largest, extreme / 4);
    EXPECT_LT(largest, extreme);
  }
  EXPECT_EQ(plies, 3);
}

}  // namespace
}  // namespace interply
