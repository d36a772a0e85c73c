/// Moments of the shell against plate theory and through-thickness closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "solver_metal/material_point.hpp"
#include "support/metal_sheet.hpp"

namespace interply::metal::test {
namespace {

constexpr double kSide = 4;

/// A strip rolled onto a prism: every column of cells turned by `angle` against the one before. No side changes its
/// length, so there is no membrane strain; each element with a fold at its upright side has kappa_11 = 2
/// sin(angle/2)/h, that of the circle through its nodes.
struct RolledStrip {
  int columns, rows;
  TriangleMesh mesh;

  RolledStrip(int columns_, int rows_)
      : columns(columns_),
        rows(rows_),
        mesh(mechanics::make_rectangle({0, columns_ * kSide}, {0, rows_ * kSide}, kSide)) {}

  NodalVectors roll(double angle) const {
    NodalVectors x = mesh.reference;
    std::vector<double> a(columns + 1, 0.0), b(columns + 1, 0.0);
    for (int i = 0; i < columns; ++i) {
      a[i + 1] = a[i] + kSide * std::cos(i * angle);
      b[i + 1] = b[i] + kSide * std::sin(i * angle);
    }
    for (Eigen::Index n = 0; n < x.cols(); ++n) {
      const int i = static_cast<int>(n % (columns + 1));
      x(0, n) = a[i];
      x(2, n) = b[i];
    }
    return x;
  }
  double curvature(double angle) const { return 2 * std::sin(0.5 * angle) / kSide; }
  /// Area of the elements with a fold: all but one per cell of the two end columns.
  double bent_area() const { return (columns - 1) * rows * kSide * kSide; }
  /// Moment per width from the forces: f . dx/dangle = M area dkappa/dangle.
  double compute_moment(const NodalVectors& force, double angle) const {
    const double d = 1e-5;
    const double rate = (force * (roll(angle + d) - roll(angle - d))).sum() / (2 * d);
    return rate / (bent_area() * std::cos(0.5 * angle) / kSide);
  }
};

TEST(MetalBending, CylindricalBendingHasThePlateStiffness) {
  const RolledStrip strip(10, 3);
  for (const int points : {3, 5, 9}) {
    const double t = 0.8, stiffness = 210e3 * t * t * t / (12 * (1 - 0.09));
    Sheet sheet(make_sheet(make_elastic(), points, t), strip.mesh);
    for (const double angle : {0.01, 0.1}) {
      sheet.advance(strip.roll(angle));
      const double kappa = strip.curvature(angle);
      EXPECT_NEAR(sheet.layer.internal_energy(), 0.5 * stiffness * kappa * kappa * strip.bent_area(),
                  1e-9 * sheet.layer.internal_energy());
      EXPECT_NEAR(strip.compute_moment(sheet.force, angle), stiffness * kappa, 1e-7 * stiffness * kappa);
    }
    for (const double s : sheet.field("sigma_11")) EXPECT_NEAR(s, 0, 1e-6);  // midsurface
  }
}

TEST(MetalBending, OnePointIsAMembraneWithoutBendingStiffness) {
  const RolledStrip strip(4, 2);
  Sheet sheet(make_sheet(make_elastic(), 1), strip.mesh);
  sheet.advance(strip.roll(0.1));
  EXPECT_NEAR(sheet.layer.internal_energy(), 0, 1e-12);
}

TEST(MetalBending, BothSensesOfBendingAreAlike) {
  const RolledStrip strip(4, 2);
  Sheet up(make_sheet(make_dc04()), strip.mesh), down(make_sheet(make_dc04()), strip.mesh);
  NodalVectors x = strip.roll(0.02);
  x.row(1) *= 1.001;  // and yields across
  up.advance(x);
  x.row(2) *= -1;
  down.advance(x);
  EXPECT_NEAR(up.layer.internal_energy(), down.layer.internal_energy(), 1e-10 * up.layer.internal_energy());
  EXPECT_LT((up.force.row(2) + down.force.row(2)).abs().maxCoeff(), 1e-10 * up.force.abs().maxCoeff());
}

TEST(MetalBending, ElasticPlasticMomentIsTheThroughThicknessIntegral) {
  const double angle = 0.2;
  const int steps = 100;
  const RolledStrip strip(6, 2);
  Sheet sheet(make_sheet(make_dc04(), 7), strip.mesh);
  const ThicknessRule rule = make_lobatto_rule(7);
  const LawConstants law(make_dc04());
  std::vector<J2Point> points(7, {{}, 0, compute_yield_stress(law.hardening, 0)});
  double t = 1, kappa = 0, moment = 0;
  for (int s = 1; s <= steps; ++s) {
    sheet.advance(strip.roll(angle * s / steps));
    const double next = strip.curvature(angle * s / steps);
    double thickness = 0, sum = 0;
    for (int i = 0; i < 7; ++i) {
      const double z = 0.5 * t * rule.point[i];
      thickness += rule.weight[i] * update_point(law, {z * (next - kappa), 0, 0}, points[i]);
      sum += rule.weight[i] * rule.point[i] * points[i].stress.m11;
    }
    t *= std::exp(thickness);
    kappa = next;
    moment = 0.5 * t * t * sum;
  }
  EXPECT_NEAR(strip.compute_moment(sheet.force, angle), moment, 1e-6 * moment);
}

}  // namespace
}  // namespace interply::metal::test
