#include "solver_metal/j2_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "solver_metal/material_point.hpp"
#include "support/metal_sheet.hpp"

namespace interply::metal {
namespace {

/// Every law inherits these tests.
class J2Law : public testing::TestWithParam<scene::J2Law> {
 protected:
  LawConstants law{GetParam()};
  J2Point start{{}, 0, compute_yield_stress(law.hardening, 0)};
};

const scene::J2Law kLaws[] = {
    {},
    {70e3, 0.33, scene::Voce{120, 300, 12}},
    {210e3, 0.3, scene::HockettSherby{160, 420, 5, 0.7}},
    {200e3, 0.28, scene::HardeningTable{{{{0, 160}, {0.002, 200}, {0.05, 230}, {0.2, 300}}}}},
    {210e3, 0.3, scene::HardeningTable{{{{0, 200}}}}},  // perfect plasticity
};
INSTANTIATE_TEST_SUITE_P(Hardening, J2Law, testing::ValuesIn(kLaws));

Symmetric2 compute_elastic_stress(const LawConstants& law, const Symmetric2& e) {
  const double d = law.young / (1 - law.poisson * law.poisson);
  return {d * (e.m11 + law.poisson * e.m22), d * (e.m22 + law.poisson * e.m11), law.young / (1 + law.poisson) * e.m12};
}

TEST_P(J2Law, ElasticStepIsHookesLawInPlaneStress) {
  const Symmetric2 e{1e-4, -2e-4, 1.5e-4};
  J2Point point = start;
  const double thickness = update_point(law, e, point);
  const Symmetric2 expected = compute_elastic_stress(law, e);
  EXPECT_NEAR(point.stress.m11, expected.m11, 1e-12);
  EXPECT_NEAR(point.stress.m22, expected.m22, 1e-12);
  EXPECT_NEAR(point.stress.m12, expected.m12, 1e-12);
  EXPECT_NEAR(thickness, -law.poisson / (1 - law.poisson) * (e.m11 + e.m22), 1e-18);
  EXPECT_EQ(point.plastic_strain, 0);
}

/// The discrete equations themselves: flow along 3/2 dev(s)/s_eq, stress from the elastic rest, on the yield surface.
TEST_P(J2Law, PlasticStepFulfilsFlowRuleElasticityAndYieldCondition) {
  for (const double size : {3e-4, 1e-3, 1e-2, 0.2}) {
    J2Point point = start;
    for (const Symmetric2 direction : {Symmetric2{1, 0.2, 0.3}, {-0.5, 1, -0.2}, {1, 1, 0}, {0.1, -0.1, 1}}) {
      const J2Point before = point;
      const Symmetric2 e = (size + 0.01 * size) * direction;
      const double thickness = update_point(law, e, point);
      const double dp = point.plastic_strain - before.plastic_strain, s_eq = compute_von_mises(point.stress);
      if (dp == 0) continue;
      const auto& s = point.stress;
      const double mean = (s.m11 + s.m22) / 3, flow = 1.5 * dp / s_eq;
      const Symmetric2 plastic{flow * (s.m11 - mean), flow * (s.m22 - mean), flow * s.m12};
      const Symmetric2 expected = before.stress + compute_elastic_stress(law, e - plastic);
      const double tolerance = 1e-11 * (s_eq + law.young * size);
      EXPECT_NEAR(s.m11, expected.m11, tolerance);
      EXPECT_NEAR(s.m22, expected.m22, tolerance);
      EXPECT_NEAR(s.m12, expected.m12, tolerance);
      EXPECT_NEAR(s_eq, compute_yield_stress(law.hardening, point.plastic_strain).stress, 1e-11 * s_eq);
      EXPECT_NEAR(point.yield.stress, s_eq, 1e-11 * s_eq);
      const double elastic_trace = (s - before.stress).trace();
      EXPECT_NEAR(thickness, -law.poisson / law.young * elastic_trace - (plastic.m11 + plastic.m22), 1e-13);
    }
  }
}

/// Rate equations by forward Euler with the continuum tangent: an independent integration of the same law.
J2Point integrate_rates(const LawConstants& law, J2Point point, const Symmetric2& e, int steps) {
  const Symmetric2 de = (1.0 / steps) * e;
  for (int i = 0; i < steps; ++i) {
    const Symmetric2 trial = compute_elastic_stress(law, de);
    const auto& s = point.stress;
    const double s_eq = compute_von_mises(s), mean = s.trace() / 3;
    YieldStress<double> y = compute_yield_stress(law.hardening, point.plastic_strain);
    y.slope = compute_yield_stress(law.hardening, point.plastic_strain + 1e-8).slope;  // infinite at 0 for some laws
    double dp = 0;
    Symmetric2 flow{};
    if (s_eq >= y.stress) {
      flow = (1.5 / s_eq) * Symmetric2{s.m11 - mean, s.m22 - mean, s.m12};
      dp = std::fmax(0, contract(flow, trial) / (contract(flow, compute_elastic_stress(law, flow)) + y.slope));
    }
    point.stress = s + trial - dp * compute_elastic_stress(law, flow);
    point.plastic_strain += dp;
  }
  return point;
}

TEST_P(J2Law, ConvergesToTheRateEquationsOnATurningPath) {
  const std::vector<Symmetric2> legs{{0.01, 0, 0}, {0, 0.008, 0.004}, {-0.006, 0, 0.006}};
  J2Point exact = start;
  for (const auto& leg : legs) exact = integrate_rates(law, exact, leg, 200000);
  double last = 0;
  for (const int steps : {100, 200, 400}) {
    J2Point point = start;
    for (const auto& leg : legs)
      for (int i = 0; i < steps; ++i) update_point(law, (1.0 / steps) * leg, point);
    const double error = compute_von_mises(point.stress - exact.stress) / compute_von_mises(exact.stress);
    EXPECT_LT(error, 2.0 / steps);
    if (last > 2e-4) {
      EXPECT_NEAR(last / error, 2, 0.5);  // backward Euler: first order
    }
    last = error;
    EXPECT_NEAR(point.plastic_strain, exact.plastic_strain, 2e-2 * exact.plastic_strain / (steps / 100));
  }
}

TEST_P(J2Law, UnloadsAlongTheElasticLineAndYieldsAgainWhereItLeft) {
  J2Point point = start;
  for (int i = 0; i < 100; ++i) update_point(law, {2e-4, -1e-4, 0}, point);
  const J2Point loaded = point;
  const Symmetric2 back{-1e-4, 0.3e-4, 0};
  update_point(law, back, point);
  EXPECT_EQ(point.plastic_strain, loaded.plastic_strain);
  const Symmetric2 expected = loaded.stress + compute_elastic_stress(law, back);
  EXPECT_NEAR(point.stress.m11, expected.m11, 1e-9);
  update_point(law, -1.0 * back, point);
  EXPECT_NEAR(point.stress.m11, loaded.stress.m11, 1e-9);
  EXPECT_NEAR(point.plastic_strain, loaded.plastic_strain, 1e-14);
}

TEST_P(J2Law, IsIsotropic) {
  J2Point point = start, turned = start;
  const double c = std::cos(0.7), s = std::sin(0.7);
  const auto turn = [&](const Symmetric2& a) {
    return Symmetric2{c * c * a.m11 + s * s * a.m22 + 2 * c * s * a.m12,
                      s * s * a.m11 + c * c * a.m22 - 2 * c * s * a.m12,
                      c * s * (a.m22 - a.m11) + (c * c - s * s) * a.m12};
  };
  for (const Symmetric2 e : {Symmetric2{4e-3, 1e-3, 2e-3}, {-1e-3, 6e-3, 0}}) {
    update_point(law, e, point);
    update_point(law, turn(e), turned);
  }
  EXPECT_LT(compute_von_mises(turn(point.stress) - turned.stress), 1e-9);
  EXPECT_NEAR(point.plastic_strain, turned.plastic_strain, 1e-14);
}

/// Closed forms of rigid-plastic flow, which a very stiff elastic law approaches.
class RigidPlasticSheet : public testing::Test {
 protected:
  LawConstants law{scene::J2Law{2.1e11, 0.3, scene::Swift{}}};
  J2Point pull(const Symmetric2& direction, double strain, double& thickness) {
    J2Point point{{}, 0, compute_yield_stress(law.hardening, 0)};
    thickness = 0;
    for (int i = 0; i < 200; ++i) thickness += update_point(law, (strain / 200) * direction, point);
    return point;
  }
};

TEST_F(RigidPlasticSheet, PlaneStrainTensionNeeds2OverSqrt3OfTheYieldStress) {
  double thickness;
  const J2Point point = pull({1, 0, 0}, 0.2, thickness);
  const double factor = 2 / std::sqrt(3.0), p = factor * 0.2, yield = 530 * std::pow(0.0065 + p, 0.23);
  EXPECT_NEAR(point.plastic_strain, p, 1e-6);
  EXPECT_NEAR(point.stress.m11, factor * yield, 1e-3);
  EXPECT_NEAR(point.stress.m22, 0.5 * factor * yield, 1e-3);
  EXPECT_NEAR(thickness, -0.2, 1e-6);
}

TEST_F(RigidPlasticSheet, EquibiaxialTensionThinsByTheSumOfBothStrains) {
  double thickness;
  const J2Point point = pull({1, 1, 0}, 0.1, thickness);
  const double yield = 530 * std::pow(0.0065 + 0.2, 0.23);
  EXPECT_NEAR(point.plastic_strain, 0.2, 1e-6);
  EXPECT_NEAR(point.stress.m11, yield, 1e-3);
  EXPECT_NEAR(point.stress.m22, yield, 1e-3);
  EXPECT_NEAR(thickness, -0.2, 1e-6);
}

TEST_F(RigidPlasticSheet, PureShearFlowsAtYieldOverSqrt3WithoutThinning) {
  double thickness;
  const J2Point point = pull({0, 0, 1}, 0.1, thickness);
  const double p = 2 / std::sqrt(3.0) * 0.1;
  EXPECT_NEAR(point.stress.m12, 530 * std::pow(0.0065 + p, 0.23) / std::sqrt(3.0), 1e-3);
  EXPECT_NEAR(thickness, 0, 1e-12);
}

}  // namespace
}  // namespace interply::metal
