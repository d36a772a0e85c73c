#include "solver_metal/lobatto.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace interply::metal {
namespace {

TEST(LobattoRule, IntegratesPolynomialsUpToDegree2nMinus3) {
  for (int n = 1; n <= 15; ++n) {
    const ThicknessRule rule = make_lobatto_rule(n);
    ASSERT_EQ(rule.size(), n);
    for (int degree = 0; degree <= std::max(1, 2 * n - 3); ++degree) {
      double sum = 0;
      for (int i = 0; i < n; ++i) sum += rule.weight[i] * std::pow(rule.point[i], degree);
      EXPECT_NEAR(sum, degree % 2 ? 0.0 : 1.0 / (degree + 1), 1e-14) << n << " points, degree " << degree;
    }
  }
}

TEST(LobattoRule, HasFacesAscendingPointsAndTheMidsurface) {
  for (int n = 2; n <= 15; ++n) {
    const ThicknessRule rule = make_lobatto_rule(n);
    EXPECT_DOUBLE_EQ(rule.point.front(), -1);
    EXPECT_DOUBLE_EQ(rule.point.back(), 1);
    for (int i = 1; i < n; ++i) EXPECT_LT(rule.point[i - 1], rule.point[i]);
    if (n % 2) {
      EXPECT_EQ(rule.point[n / 2], 0.0);
    }
  }
  EXPECT_NEAR(make_lobatto_rule(5).point[3], std::sqrt(3.0 / 7.0), 1e-15);
  EXPECT_NEAR(make_lobatto_rule(5).weight[2], 16.0 / 45.0, 1e-15);
}

TEST(LobattoRule, SecondMomentIsOneThirdFromThreePointsOn) {
  EXPECT_EQ(make_lobatto_rule(1).second_moment(), 0);
  EXPECT_DOUBLE_EQ(make_lobatto_rule(2).second_moment(), 1);
  for (int n = 3; n <= 15; ++n) EXPECT_NEAR(make_lobatto_rule(n).second_moment(), 1.0 / 3, 1e-14);
}

TEST(LobattoRule, RefusesOtherNumbersOfPoints) {
  EXPECT_THROW(make_lobatto_rule(0), std::invalid_argument);
  EXPECT_THROW(make_lobatto_rule(16), std::invalid_argument);
}

}  // namespace
}  // namespace interply::metal
