/// Rolled sheet (Hill 1948): r-values and yield stresses over the angle, equibiaxial yield, and the return itself.
#include <Eigen/LU>
#include <numbers>
#include <random>

#include "solver_metal/material_point.hpp"
#include "support/metal_sheet.hpp"
#include "support/reference_law.hpp"
#include "support/results.hpp"

namespace interply::metal {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

scene::J2Law make_rolled(double r0, double r45, double r90) {
  scene::J2Law law = test::make_dc04();
  law.hill48 = scene::Hill48{r0, r45, r90};
  return law;
}

/// Every r different: typical of a deep-drawing steel.
scene::J2Law make_deep_drawing_steel() { return make_rolled(1.87, 1.35, 2.24); }

/// s_eq of (R1), MPa.
double compute_hill48(const Hill48Coefficients& c, const Symmetric2& s) {
  return std::sqrt(s.m11 * s.m11 - 2 * c.h * s.m11 * s.m22 + c.p * s.m22 * s.m22 + c.q * s.m12 * s.m12);
}

J2Point make_start(const LawConstants& law) { return {{}, 0, compute_yield_stress(law.hardening, 0)}; }

Symmetric2 compute_elastic_strain(const LawConstants& law, const Symmetric2& s) {
  const double nu = law.poisson;
  return (1 / law.young) * Symmetric2{s.m11 - nu * s.m22, s.m22 - nu * s.m11, (1 + nu) * s.m12};
}

/// A coupon under stress t x factor, t fixed.
struct Coupon {
  J2Point point;
  Symmetric2 strain{};
  double thickness = 0;  ///< strain
};

/// Strain increment with t : de = size that leaves the stress along t: Newton's method on the two stresses across it,
/// tangent by differences.
void pull(const LawConstants& law, const Symmetric2& t, double size, Coupon& coupon) {
  const Eigen::Vector3d along(t.m11, t.m22, 2 * t.m12);
  const Eigen::Vector3d first = Eigen::Vector3d(t.m22, -t.m11, 0) + Eigen::Vector3d(t.m12, t.m12, -t.m11 - t.m22);
  const Eigen::Vector3d stress_along(t.m11, t.m22, t.m12);
  const Eigen::Vector3d second = stress_along.cross(first);
  const auto respond = [&](const Eigen::Vector3d& x, Coupon& c) {
    c.thickness += update_point(law, {x(0), x(1), x(2)}, c.point);
    c.strain = c.strain + Symmetric2{x(0), x(1), x(2)};
    const Eigen::Vector3d s(c.point.stress.m11, c.point.stress.m22, c.point.stress.m12);
    return Eigen::Vector3d(first.dot(s), second.dot(s), law.young * (along.dot(x) - size));
  };
  Eigen::Vector3d x = size * stress_along / along.dot(stress_along);
  for (int i = 0; i < 60; ++i) {
    Coupon trial = coupon;
    const Eigen::Vector3d residual = respond(x, trial);
    if (residual.norm() < 1e-9) break;
    Eigen::Matrix3d tangent;
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d moved = x;
      moved(k) += 1e-8;
      Coupon other = coupon;
      tangent.col(k) = (respond(moved, other) - residual) / 1e-8;
    }
    x -= tangent.partialPivLu().solve(residual);
  }
  respond(x, coupon);
}

Coupon pull_far(const LawConstants& law, const Symmetric2& t, double strain, int steps) {
  Coupon coupon{make_start(law), {}, 0};
  for (int i = 0; i < steps; ++i) pull(law, t, strain / steps, coupon);
  return coupon;
}

Symmetric2 uniaxial(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * c, s * s, c * s};
}

/// Closed form from the quadratic form itself, written independently of the solver: with Hill's F, G, H, N for a unit
/// yield stress along the rolling direction.
struct ClosedForm {
  double F, G, H, N;
  explicit ClosedForm(const scene::Hill48& r)
      : F(r.r0 / (r.r90 * (1 + r.r0))),
        G(1 / (1 + r.r0)),
        H(r.r0 / (1 + r.r0)),
        N((r.r0 + r.r90) * (1 + 2 * r.r45) / (2 * r.r90 * (1 + r.r0))) {}
  double r(double x) const {
    const double s2 = std::pow(std::sin(x), 2), c2 = 1 - s2;
    return (H + (2 * N - F - G - 4 * H) * s2 * c2) / (F * s2 + G * c2);
  }
  double yield(double x) const {
    const double s2 = std::pow(std::sin(x), 2), c2 = 1 - s2;
    return 1 / std::sqrt(F * s2 * s2 + G * c2 * c2 + H * (c2 - s2) * (c2 - s2) + 2 * N * s2 * c2);
  }
  double equibiaxial() const { return 1 / std::sqrt(F + G); }
};

TEST(Hill48, CouponsRecoverTheRValueAtEveryAngle) {
  const scene::J2Law law = make_deep_drawing_steel();
  const LawConstants constants(law);
  const ClosedForm exact(*law.hill48);
  for (const double degrees : {0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0}) {
    const double angle = degrees * kDegree;
    const Coupon coupon = pull_far(constants, uniaxial(angle), 0.15, 30);
    const Symmetric2 plastic = coupon.strain - compute_elastic_strain(constants, coupon.point.stress);
    const double width = contract(uniaxial(angle + std::numbers::pi / 2), plastic);
    const double thickness = coupon.thickness + law.poisson / law.young * coupon.point.stress.trace();
    interply::test::expect_result({.row = "V9",
                                   .quantity = "r-value of a bar at " + std::to_string(int(degrees)) + " deg (Hill48)",
                                   .source = "closed form r(angle) of Hill's F, G, H, N",
                                   .reference = exact.r(angle),
                                   .ours = width / thickness,
                                   .unit = "",
                                   .tolerance = 1e-9,  // proportional loading: the implicit update is exact
                                   .mesh = "material point, 30 steps to 15 %"});
  }
}

TEST(Hill48, YieldStressFollowsTheAngle) {
  const scene::J2Law law = make_deep_drawing_steel();
  const LawConstants constants(law);
  const ClosedForm exact(*law.hill48);
  for (const double degrees : {0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0}) {
    const double angle = degrees * kDegree;
    const Coupon coupon = pull_far(constants, uniaxial(angle), 0.05, 20);
    const double rolling = compute_yield_stress(law.hardening, coupon.point.plastic_strain).stress;
    interply::test::expect_result({.row = "V9",
                                   .quantity = "yield stress at " + std::to_string(int(degrees)) + " deg (Hill48)",
                                   .source = "closed form sigma_y(angle), same plastic work",
                                   .reference = exact.yield(angle) * rolling,
                                   .ours = contract(uniaxial(angle), coupon.point.stress),
                                   .unit = "MPa",
                                   .tolerance = 1e-9,
                                   .mesh = "material point, 20 steps to 5 %"});
  }
}

TEST(Hill48, EquibiaxialTensionYieldsWhereTheClosedFormSays) {
  const scene::J2Law law = make_deep_drawing_steel();
  const LawConstants constants(law);
  const Coupon coupon = pull_far(constants, {1, 1, 0}, 0.1, 20);
  const double rolling = compute_yield_stress(law.hardening, coupon.point.plastic_strain).stress;
  interply::test::expect_result({.row = "V9",
                                 .quantity = "equibiaxial yield stress (Hill48)",
                                 .source = "closed form sigma_y / sqrt(F + G)",
                                 .reference = ClosedForm(*law.hill48).equibiaxial() * rolling,
                                 .ours = coupon.point.stress.m11,
                                 .unit = "MPa",
                                 .tolerance = 1e-9,
                                 .mesh = "material point, 20 steps to 5 %"});
  EXPECT_NEAR(coupon.point.stress.m22, coupon.point.stress.m11, 1e-8);
}

TEST(Hill48, PlasticWorkIsThatOfTheRollingDirection) {
  const scene::J2Law law = make_deep_drawing_steel();
  const LawConstants constants(law);
  const Coupon coupon = pull_far(constants, uniaxial(0), 0.1, 20);
  const Symmetric2 plastic = coupon.strain - compute_elastic_strain(constants, coupon.point.stress);
  EXPECT_NEAR(coupon.point.plastic_strain, plastic.m11, 1e-12);  // p is the plastic strain of a bar along it
  EXPECT_NEAR(coupon.point.stress.m11, compute_yield_stress(law.hardening, plastic.m11).stress, 1e-8);
}

Symmetric2 make_random_increment(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> component(-size, size);
  return {component(random), component(random), component(random)};
}

TEST(Hill48, RandomPathsStayInsideTheYieldSurfaceAndDissipate) {
  for (const scene::J2Law& law : {make_deep_drawing_steel(), make_rolled(0.3, 2.5, 0.6), make_rolled(5, 0.2, 1)}) {
    const LawConstants constants(law);
    J2Point point = make_start(constants);
    std::mt19937 random(3);
    for (int i = 0; i < 5000; ++i) {
      const J2Point before = point;
      const Symmetric2 de = make_random_increment(random, 4e-3);
      update_point(constants, de, point);
      const double equivalent = compute_hill48(constants.coefficients, point.stress);
      const double yield = compute_yield_stress(law.hardening, point.plastic_strain).stress;
      ASSERT_LE(equivalent, yield * (1 + 1e-12));
      ASSERT_GE(point.plastic_strain, before.plastic_strain);
      const Symmetric2 plastic = de - compute_elastic_strain(constants, point.stress - before.stress);
      const double dp = point.plastic_strain - before.plastic_strain;
      ASSERT_NEAR(contract(point.stress, plastic), equivalent * dp, 1e-10);  // dissipation, MPa
    }
  }
}

TEST(Hill48, RatiosOfOneAreJ2) {
  const LawConstants hill(make_rolled(1, 1, 1)), j2(test::make_dc04());
  J2Point a = make_start(hill), b = a;
  std::mt19937 random(5);
  double thickness_a = 0, thickness_b = 0;
  for (int i = 0; i < 2000; ++i) {
    const Symmetric2 de = make_random_increment(random, i % 10 ? 2e-3 : 5e-2);
    thickness_a += update_point(hill, de, a);
    thickness_b += update_point(j2, de, b);
    const double scale = 1e-10 * b.yield.stress;
    ASSERT_NEAR(a.stress.m11, b.stress.m11, scale);
    ASSERT_NEAR(a.stress.m22, b.stress.m22, scale);
    ASSERT_NEAR(a.stress.m12, b.stress.m12, scale);
    ASSERT_NEAR(a.plastic_strain, b.plastic_strain, 1e-10 * b.plastic_strain);
    ASSERT_NEAR(thickness_a, thickness_b, 1e-10 * (1 + std::abs(thickness_b)));
  }
}

/// The discrete equations themselves, for steps up to 2 and the largest anisotropy that a scene may have.
TEST(Hill48, LargeIncrementsFulfilFlowRuleElasticityAndYieldCondition) {
  for (const scene::J2Law& law : {make_deep_drawing_steel(), make_rolled(0.01, 100, 0.01), make_rolled(100, 0.01, 100),
                                  make_rolled(0.01, 0.01, 100), make_rolled(100, 100, 0.01)}) {
    const LawConstants constants(law);
    const auto& c = constants.coefficients;
    for (const double size : {1e-3, 1e-2, 0.2, 2.0}) {
      for (const Symmetric2 direction : {Symmetric2{1, 0.2, 0.3}, {-0.5, 1, -0.2}, {1, 1, 0}, {0.1, -0.1, 1}}) {
        J2Point point = make_start(constants);
        const Symmetric2 de = size * direction;
        const double thickness = update_point(constants, de, point);
        const Symmetric2& s = point.stress;
        const double equivalent = compute_hill48(c, s), flow = point.plastic_strain / equivalent;
        const Symmetric2 plastic{flow * (s.m11 - c.h * s.m22), flow * (c.p * s.m22 - c.h * s.m11),
                                 flow * c.q * s.m12 / 2};
        const Symmetric2 total = plastic + compute_elastic_strain(constants, s);
        EXPECT_NEAR(total.m11, de.m11, 1e-11 * size);
        EXPECT_NEAR(total.m22, de.m22, 1e-11 * size);
        EXPECT_NEAR(total.m12, de.m12, 1e-11 * size);
        const double yield = compute_yield_stress(law.hardening, point.plastic_strain).stress;
        EXPECT_LE(equivalent, yield * (1 + 1e-11));
        if (point.plastic_strain > 0) {
          EXPECT_NEAR(equivalent, yield, 1e-11 * yield);
        }
        EXPECT_NEAR(thickness, -law.poisson / law.young * s.trace() - plastic.trace(), 1e-11 * size);
      }
    }
  }
}

TEST(Hill48, StrainPathsConvergeToTheRateEquationsAtFirstOrder) {
  const scene::J2Law steel = make_deep_drawing_steel();
  const LawConstants law(steel);
  const auto direction = [](double x) { return Symmetric2{std::cos(x), 0.2, std::sin(x)}; };
  const auto follow = [&](int steps) {  // a quarter turn from tension across to shear
    J2Point point = make_start(law);
    for (int i = 0; i < steps; ++i)
      update_point(law, (0.1 / steps) * direction(std::numbers::pi / 2 * (i + 0.5) / steps), point);
    return point;
  };
  constexpr int kRates = 400000;
  const test::ReferenceLaw reference(steel);
  test::ReferenceLaw::Point exact;
  for (int i = 0; i < kRates; ++i) {
    const Symmetric2 de = (0.1 / kRates) * direction(std::numbers::pi / 2 * (i + 0.5) / kRates);
    reference.integrate_rates({de.m11, de.m22, 2 * de.m12}, 1, exact);
  }
  const auto error = [&](int steps) {
    const Symmetric2 s = follow(steps).stress;
    return (Eigen::Vector3d(s.m11, s.m22, s.m12) - exact.stress).norm();
  };
  const double order = interply::test::compute_order({1.0 / 160, 1.0 / 320}, {error(160), error(320)});
  EXPECT_NEAR(order, 1, 0.05);
  EXPECT_NEAR(follow(10240).plastic_strain, exact.plastic_strain, 1e-4 * exact.plastic_strain);
}

/// Random increments from the edge of yield to very large, against a bisection of the discrete equations.
TEST(Hill48, IncrementsAreThoseOfTheReferenceLaw) {
  for (const scene::J2Law& rolled : {make_deep_drawing_steel(), make_rolled(0.3, 2.5, 0.6), make_rolled(5, 0.2, 1)}) {
    const LawConstants law(rolled);
    const test::ReferenceLaw reference(rolled);
    J2Point point = make_start(law);
    test::ReferenceLaw::Point exact;
    std::mt19937 random(11);
    for (int i = 0; i < 500; ++i) {
      const Symmetric2 de = make_random_increment(random, i % 10 ? 2e-3 : 5e-2);
      const double thickness = update_point(law, de, point);
      ASSERT_NEAR(thickness, reference.advance({de.m11, de.m22, 2 * de.m12}, exact), 1e-13);
      ASSERT_NEAR(point.stress.m11, exact.stress(0), 1e-9);
      ASSERT_NEAR(point.stress.m22, exact.stress(1), 1e-9);
      ASSERT_NEAR(point.stress.m12, exact.stress(2), 1e-9);
      ASSERT_NEAR(point.plastic_strain, exact.plastic_strain, 1e-12 * (1 + exact.plastic_strain));
    }
  }
}

/// The layer turns with its orientation: the same strain path in the rolling frame of a point.
TEST(Hill48, OrientationOfTheLayerIsTheRollingDirection) {
  const scene::J2Law law = make_deep_drawing_steel();
  const LawConstants constants(law);
  const double angle = 30 * kDegree, c = std::cos(angle), s = std::sin(angle);
  const mechanics::TriangleMesh mesh = test::make_distorted_square(10, 2.5, 0.1);
  scene::Layer layer = test::make_sheet(law);
  layer.orientation_deg = 30;
  test::Sheet sheet(layer, mesh);
  J2Point point = make_start(constants);
  const int steps = 2000;
  for (int i = 1; i <= steps; ++i) {  // stretch along x, nothing across: U and its rate have the same axes
    mechanics::NodalVectors x = mesh.reference;
    x.row(0) *= std::exp(0.1 * i / steps);
    sheet.advance(x);
    const double de = 0.1 / steps;
    update_point(constants, {c * c * de, s * s * de, -c * s * de}, point);
  }
  const auto s11 = sheet.field("sigma_11"), s22 = sheet.field("sigma_22"), s12 = sheet.field("sigma_12");
  for (std::size_t e = 0; e < s11.size(); ++e) {
    ASSERT_NEAR(s11[e], point.stress.m11, 1e-6 * point.yield.stress);
    ASSERT_NEAR(s22[e], point.stress.m22, 1e-6 * point.yield.stress);
    ASSERT_NEAR(s12[e], point.stress.m12, 1e-6 * point.yield.stress);
  }
}

TEST(Hill48, PointFollowsTheRollingDirection) {
  const scene::J2Law law = make_deep_drawing_steel();
  const MetalPoint end = follow_uniaxial_path(law, {0.1}).back();
  const double elastic = end.stress / law.young;
  const double width = end.width_strain + law.poisson * elastic;
  const double thickness = end.thickness_strain + law.poisson * elastic;
  EXPECT_NEAR(width / thickness, law.hill48->r0, 1e-9);
  EXPECT_NEAR(end.stress, compute_yield_stress(law.hardening, end.plastic_strain).stress, 1e-8);
}

}  // namespace
}  // namespace interply::metal
