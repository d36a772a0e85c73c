/// V4: bias extension of an aligned mesh, nearly inextensible fibres, against the kinematics of the net.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/bias_extension.hpp"
#include "support/fabric_cases.hpp"
#include "support/results.hpp"

namespace interply {
namespace {

using namespace fabric_cases;
using test::BiasTest;
using test::BiasZone;

constexpr double kWidth = 40, kDiagonal = 40.0 / 6;  // mm
constexpr double kFibreOverShear = 1e5;              // the fibres stretch by less than 1e-4
const char* kMesh = "legs 4.7 mm, aligned";

/// H = 2 W: every fibre that is free at both ends crosses the middle zone along the same length, so the equilibrium of
/// inextensible fibres is uniform in each zone, and the mesh, whose sides run along the zones, can represent it.
TEST(BiasExtension, AlignedMeshShearsAsTheNetDoesTo30Degrees) {
  const double height = 2 * kWidth;
  BiasTest test(test::make_bias_strip(6, 12, kDiagonal), test::make_net_law(kFibreOverShear));
  for (const int degrees : {10, 20, 30}) {
    const double gamma = degrees * kDegree, angle = std::numbers::pi / 4 - gamma / 2;
    test.extend(test::compute_bias_extension(kWidth, height, gamma), 1e-3);
    EXPECT_LT(test.ply.largest_fibre_strain(), 1e-4);
    EXPECT_LT(test.read_shear(BiasZone::Rigid) / kDegree, 0.01);
    const std::string at = fmt::format(", net sheared by {} deg", degrees);
    const test::Result common{
        .row = "V4", .source = "gamma = 90 deg - 2 acos((L0 + d)/(sqrt2 L0))", .unit = "deg", .mesh = kMesh};
    test::Result middle = common, side = common, force = common;
    middle.quantity = "bias extension, H = 2 W, shear in the middle" + at;
    middle.reference = degrees;
    middle.ours = test.read_shear(BiasZone::Full) / kDegree;
    test::expect_result(middle);
    side.quantity = "bias extension, H = 2 W, shear at the sides" + at;
    side.reference = degrees / 2.0;
    side.ours = test.read_shear(BiasZone::Half) / kDegree;
    test::expect_result(side);
    // power of the grip = power of the shear: F d' = t G (W^2/2 gamma + W^2 (gamma/2)/2) gamma', d' from V4
    force.quantity = "bias extension, H = 2 W, force of the grip" + at;
    force.source = "power of the shear of all zones, closed form";
    force.reference = 1.2 * 0.1 * 0.75 * kWidth * kWidth * gamma / (std::sqrt(2.0) * kWidth * std::sin(angle) / 2);
    force.ours = test.force();
    force.unit = "N";
    test::expect_result(force);
  }
}

/// H = 3 W, the usual strip: fibres near the grips cross less of the middle zone and turn more (8.2 to 11.6 deg at 10),
/// so the formula holds for the mean along the axis, which crosses every free fibre once.
TEST(BiasExtension, OfALongStripShearsInTheMeanOfItsAxisAsTheNetDoes) {
  const double height = 3 * kWidth;
  BiasTest test(test::make_bias_strip(6, 18, kDiagonal), test::make_net_law(kFibreOverShear));
  for (const int degrees : {15, 30}) {
    test.extend(test::compute_bias_extension(kWidth, height, degrees * kDegree), 1e-2);
    test::expect_result(
        {.row = "V4",
         .quantity = fmt::format("bias extension, H = 3 W, mean shear along the axis, net sheared by {} deg", degrees),
         .source = "gamma = 90 deg - 2 acos((L0 + d)/(sqrt2 L0))",
         .reference = static_cast<double>(degrees),
         .ours = test.read_shear(BiasZone::Full, kDiagonal / 2) / kDegree,
         .unit = "deg",
         .mesh = kMesh});
  }
}

}  // namespace
}  // namespace interply
