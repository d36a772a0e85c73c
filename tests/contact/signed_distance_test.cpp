#include "contact/signed_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace {

using namespace interply::contact;

/// One battery for every tool: the gradient is the gradient, of unit length, and |d(x) - d(y)| <= |x - y|.
void check_distance_field(const SignedDistance& tool, double z_low, double z_high) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> across(-120, 120), up(z_low, z_high);
  int tested = 0;
  Vector3 previous(0, 0, z_high);
  for (int i = 0; i < 4000; ++i) {
    const Vector3 x(across(random), across(random), up(random));
    const Distance d = tool.evaluate(x);
    EXPECT_LE(std::abs(d.value - tool.evaluate(previous).value), (x - previous).norm() + 1e-9);
    previous = x;
    if (d.value < -2) continue;  // deep inside nothing is promised
    const double h = 1e-5;
    Vector3 slope;
    for (int k = 0; k < 3; ++k) {
      const Vector3 e = h * Vector3::Unit(k);
      slope(k) = (tool.evaluate(x + e).value - tool.evaluate(x - e).value) / (2 * h);
    }
    if (std::abs(slope.norm() - 1) > 1e-3) continue;  // a ridge of the field between two nearest points
    EXPECT_NEAR(d.gradient.norm(), 1, 1e-12);
    EXPECT_LT((slope - d.gradient).norm(), 2e-3);
    if (d.value > 0) {  // leads to the surface
      EXPECT_NEAR(tool.evaluate(x - d.value * d.gradient).value, 0, 1e-9);
    }
    ++tested;
  }
  EXPECT_GT(tested, 1000);
}

TEST(PyramidPunch, IsADistanceField) { check_distance_field(PyramidPunch(100, 50, 15), -30, 100); }
TEST(OpeningPlate, IsADistanceFieldFacingUp) { check_distance_field(OpeningPlate(100, 22, 10, true), -30, 40); }
TEST(OpeningPlate, IsADistanceFieldFacingDown) { check_distance_field(OpeningPlate(100, 22, 10, false), -40, 30); }

TEST(PyramidPunch, TipIsABallOfTheGivenRadiusAtTheOrigin) {
  const PyramidPunch punch(100, 50, 15);
  EXPECT_NEAR(punch.evaluate({0, 0, 0}).value, 0, 1e-12);
  EXPECT_NEAR(punch.evaluate({0, 0, -7}).value, 7, 1e-12);
  EXPECT_NEAR(punch.evaluate({3, 4, -1}).value, std::hypot(5, 16) - 15, 1e-12);
}

/// Faces of the default punch are inclined by 60 deg; the outer sharp body has edge 160 and height 80, as in the
/// shipped scenes.
TEST(PyramidPunch, FacesOfTheOuterBodyAreThoseOfTheSharpPyramid) {
  const PyramidPunch punch(100, 50, 15);
  // opposite the edge at +x lies a face whose outer plane crosses the base plane (z = 65) at the inradius of edge 160
  const double inradius = 160 / (2 * std::sqrt(3.0));
  for (const double z : {30.0, 40.0, 50.0}) {
    const double x = -inradius * (1 - (65 - z) / 80);
    EXPECT_NEAR(punch.evaluate({x, 0, z}).value, 0, 1e-9);
    EXPECT_NEAR(punch.evaluate({x, 0, z}).gradient.z(), -0.5, 1e-12);
  }
}

TEST(OpeningPlate, LandWallAndShoulder) {
  const OpeningPlate die(100, 22, 10, true);
  EXPECT_NEAR(die.evaluate({130, 0, 3}).value, 3, 1e-12);
  const double wall = -100 / (2 * std::sqrt(3.0)) - 22;  // flat side of the opening at negative x
  EXPECT_NEAR(die.evaluate({wall + 4, 0, -30}).value, 4, 1e-12);
  const Vector3 centre(wall - 10, 0, -10);
  EXPECT_NEAR(die.evaluate(centre + 14 * Vector3(1, 0, 1).normalized()).value, 4, 1e-12);
}

/// Least distance between punch and die along the flat sides, the clearance of the shipped scenes: 22 - 15 = 7 mm.
TEST(Tools, ClearanceBetweenPunchAndDieIsTheDifferenceOfTheirOffsets) {
  const PyramidPunch punch(100, 50, 15);
  const OpeningPlate die(100, 22, 10, true);
  const double wall = -100 / (2 * std::sqrt(3.0)) - 22;
  EXPECT_NEAR(punch.evaluate({wall, 0, 80}).value, 7, 1e-9);
}

TEST(OpeningArea, EqualsTheNumberOfPointsInside) {
  const OpeningPlate plate(100, 22, 10, true);
  double area = 0;
  const double h = 0.25;
  for (double x = -150 + h / 2; x < 150; x += h)
    for (double y = -150 + h / 2; y < 150; y += h)
      if (plate.evaluate({x, y, 0}).value > 1e-12) area += h * h;  // above the shoulder or the hole
  EXPECT_NEAR(area, compute_opening_area(100, 22, 10), 2e-3 * area);
}

}  // namespace
