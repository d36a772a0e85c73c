#include "geometry/outline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace interply::geometry {
namespace {

TEST(Outline, AreaIsThatOfTheOffsetTriangle) {
  // A = sqrt(3)/4 e^2 + 3 e r + pi r^2; a polygon of 3 x 100 parts lacks (2 pi/300)^2/6 of the arcs.
  const double exact = std::sqrt(3.0) / 4 * 1e4 + 3 * 100 * 32 + std::numbers::pi * 32 * 32;
  EXPECT_NEAR(compute_area(trace_opening(100, 32, 100)), exact, 1e-4 * std::numbers::pi * 32 * 32);
}

TEST(Outline, AMeshThatCoversItHoldsAllOfItsAreaAndAHalfMeshHalf) {
  const Outline outline = trace_opening(100, 32, 50);
  const double area = compute_area(outline);
  EXPECT_NEAR(compute_area_inside(mechanics::make_rectangle({-140, 140}, {-140, 140}, 17), outline), area,
              1e-12 * area);
  EXPECT_NEAR(compute_area_inside(mechanics::make_rectangle({-140, 140}, {0, 140}, 17), outline), area / 2,
              1e-12 * area);
  EXPECT_NEAR(compute_area_inside(mechanics::make_rectangle({-9, 9}, {-9, 9}, 5), outline), 18 * 18, 1e-10);
  EXPECT_EQ(compute_area_inside(mechanics::make_rectangle({120, 140}, {-9, 9}, 5), outline), 0);
}

}  // namespace
}  // namespace interply::geometry
