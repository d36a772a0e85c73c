/// Moments of the shell against plate theory and through-thickness closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "support/metal_sheet.hpp"

namespace interply::metal::test {
namespace {

constexpr double kSide = 4;

/// A strip rolled onto a prism: every column of cells turned by `angle` against the one before. No side changes its
/// length, so there is no membrane strain; each element with a fold at its upright side has kappa_11 = sin(angle)/h.
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
  double curvature(double angle) const { return std::sin(angle) / kSide; }
  /// Area of the elements with a fold: all but one per cell of the two end columns.
  double bent_area() const { return (columns - 1) * rows * kSide * kSide; }
  /// Moment per width from the forces: f . dx/dangle = M area dkappa/dangle.
  double compute_moment(const NodalVectors& force, double angle) const {
    const double d = 1e-5;
    const double rate = (force * (roll(angle + d) - roll(angle - d))).sum() / (2 * d);
    return rate / (bent_area() * std::cos(angle) / kSide);
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

TEST(MetalBending, PureTwistHasThePlateStiffness) {
  const TriangleMesh mesh = mechanics::make_rectangle({-20, 20}, {-20, 20}, kSide);
  const double twist = 1e-6, modulus = 210e3 / (12 * (1 - 0.09)) * (1 - 0.3);
  NodalVectors x = mesh.reference;
  x.row(2) = twist * x.row(0) * x.row(1);
  Sheet sheet(make_sheet(make_elastic()), mesh);
  sheet.advance(x);
  // inner elements see kappa_12 = twist exactly, and constant moments leave the inner nodes in balance
  const auto patches = mechanics::make_shell_patches(mesh, 0);
  double expected = 0;
  for (Eigen::Index e = 0; e < mesh.n_elements(); ++e) {
    const auto k = mechanics::compute_curvature(patches, x, e, mechanics::compute_surface_gradient(patches, x, e));
    if (mesh.neighbours.col(e).minCoeff() >= 0) {
      EXPECT_NEAR(k.k12, twist, 1e-6 * twist);
    }
    const double sum = k.k11 + k.k22,
                 bending = modulus / 0.7 * 0.5 * (sum * sum - 1.4 * (k.k11 * k.k22 - k.k12 * k.k12));
    expected += patches.area(e) * bending;
  }
  EXPECT_NEAR(sheet.layer.internal_energy(), expected, 1e-5 * expected);
  for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i)
    if (mesh.reference.col(i).head(2).abs().maxCoeff() < 20 - 2.5 * kSide) {
      EXPECT_LT(std::abs(sheet.force(2, i)), 1e-6 * sheet.force.row(2).abs().maxCoeff());
    }
}

/// Elastic, perfectly plastic and incompressible (nu = 1/2): in plane strain s22 = s11/2 in both ranges, so bending is
/// one-dimensional with modulus E/(1 - nu^2) and yield stress 2/sqrt(3) s0:
///   M = M_e (3 - (kappa_e/kappa)^2)/2,   M_e = 2/sqrt(3) s0 t^2/6,   beyond kappa_e.
double compute_closed_form_moment(double kappa, double young, double s0) {
  const double yield = 2 / std::sqrt(3.0) * s0, elastic_limit = 2 * yield / (young / 0.75), m = yield / 6;
  return kappa < elastic_limit ? m * kappa / elastic_limit : 0.5 * m * (3 - std::pow(elastic_limit / kappa, 2));
}

double compute_shell_moment(int points, double angle, double young, double s0) {
  const RolledStrip strip(6, 2);
  Sheet sheet(make_sheet({young, 0.5, scene::HardeningTable{{{{0, s0}}}}}, points), strip.mesh);
  for (int s = 1; s <= 200; ++s) sheet.advance(strip.roll(angle * s / 200));
  return strip.compute_moment(sheet.force, angle);
}

TEST(MetalBending, ElasticPlasticMomentConvergesToTheClosedFormWithThePoints) {
  const double young = 210e3, s0 = 200;
  const auto error = [&](int points) {  // largest for curvatures of two to ten times the elastic limit
    double largest = 0;
    for (const double angle : {0.015, 0.03, 0.05, 0.075}) {
      const double exact = compute_closed_form_moment(std::sin(angle) / kSide, young, s0);
      largest = std::max(largest, std::abs(compute_shell_moment(points, angle, young, s0) / exact - 1));
    }
    return largest;
  };
  const double three = error(3), five = error(5), nine = error(9);
  RecordProperty("relative errors at 3, 5 and 9 points",
                 std::to_string(three) + " " + std::to_string(five) + " " + std::to_string(nine));
  EXPECT_LT(five, three);
  EXPECT_LT(nine, five);
  EXPECT_LT(nine, 0.05);
}

TEST(MetalBending, ElasticPlasticMomentIsTheThroughThicknessIntegral) {
  const double angle = 0.2;
  const int steps = 100;
  const RolledStrip strip(6, 2);
  Sheet sheet(make_sheet(make_dc04(), 7), strip.mesh);
  const ThicknessRule rule = make_lobatto_rule(7);
  const J2Constants law(make_dc04());
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

TEST(MetalBending, SpringsBackElastically) {
  const RolledStrip strip(6, 2);
  Sheet sheet(make_sheet(make_dc04(), 9), strip.mesh);
  const double stiffness = 210e3 / (12 * (1 - 0.09)), angle = 0.1;
  for (int s = 1; s <= 100; ++s) sheet.advance(strip.roll(angle * s / 100));
  const double moment = strip.compute_moment(sheet.force, angle), kappa = strip.curvature(angle);
  // the curvature at which an elastic unloading has no moment left: kappa - M/D
  const double rest = std::asin((kappa - moment / stiffness) * kSide);
  sheet.advance(strip.roll(rest));
  EXPECT_GT(moment, 0);
  EXPECT_NEAR(strip.compute_moment(sheet.force, rest), 0, 2e-3 * moment);  // t differs from 1 by the elastic thinning
}

}  // namespace
}  // namespace interply::metal::test
