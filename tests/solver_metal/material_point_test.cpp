#include "solver_metal/material_point.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solver_metal/hardening.hpp"

namespace interply::metal {
namespace {

TEST(UniaxialPath, IsElasticBelowYield) {
  const auto path = follow_uniaxial_path({}, {0, 2e-4, 5e-4, -3e-4});
  ASSERT_EQ(path.size(), 4u);
  for (const MetalPoint& p : path) {
    EXPECT_NEAR(p.stress, 210e3 * p.strain, 1e-9);
    EXPECT_NEAR(p.width_strain, -0.3 * p.strain, 1e-14);
    EXPECT_NEAR(p.thickness_strain, -0.3 * p.strain, 1e-14);
    EXPECT_EQ(p.plastic_strain, 0);
  }
}

TEST(UniaxialPath, StressIsTheHardeningCurveAndPlasticStrainTheRest) {
  for (const scene::Hardening& h : {scene::Hardening{scene::Swift{}},
                                    {scene::Voce{160, 380, 9}},
                                    {scene::HockettSherby{160, 420, 5, 0.7}},
                                    {scene::HardeningTable{{{{0, 160}, {0.05, 230}, {0.2, 300}}}}}}) {
    for (const MetalPoint& p : follow_uniaxial_path({210e3, 0.3, h}, {0.01, 0.05, 0.3})) {
      EXPECT_NEAR(p.stress, compute_yield_stress(h, p.plastic_strain).stress, 1e-9);
      EXPECT_NEAR(p.plastic_strain, p.strain - p.stress / 210e3, 1e-12);
      // half of the plastic and 0.3 of the elastic strain across the bar, both ways alike
      EXPECT_NEAR(p.width_strain, -0.5 * p.plastic_strain - 0.3 * p.stress / 210e3, 1e-12);
      EXPECT_NEAR(p.thickness_strain, p.width_strain, 1e-12);
    }
  }
}

TEST(UniaxialPath, DoesNotDependOnHowTheStrainIsDivided) {
  std::vector<double> fine;
  for (int i = 1; i <= 1000; ++i) fine.push_back(0.2 * i / 1000);
  const MetalPoint a = follow_uniaxial_path({}, fine).back(), b = follow_uniaxial_path({}, {0.2}).back();
  EXPECT_NEAR(a.stress, b.stress, 1e-9);
  EXPECT_NEAR(a.width_strain, b.width_strain, 1e-12);
}

TEST(UniaxialPath, ReverseLoadingYieldsAtTheSameStressInCompression) {
  const auto path = follow_uniaxial_path({}, {0.05, 0.05 - 0.001, 0.03});
  EXPECT_NEAR(path[1].stress, path[0].stress - 210, 1e-8);
  EXPECT_LT(path[2].stress, 0);
  EXPECT_NEAR(-path[2].stress, compute_yield_stress(scene::Swift{}, path[2].plastic_strain).stress, 1e-9);
  EXPECT_GT(path[2].plastic_strain, path[0].plastic_strain);
}

}  // namespace
}  // namespace interply::metal
