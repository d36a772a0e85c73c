#include "solver_metal/hardening.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/reference_law.hpp"

namespace interply::metal {
namespace {

const scene::Swift kSwift{530, 0.0065, 0.23};
const scene::Voce kVoce{160, 380, 9};
const scene::HockettSherby kHockettSherby{160, 420, 5, 0.7};
const scene::HardeningTable kTable{{{{0, 160}, {0.05, 230}, {0.2, 300}, {0.6, 350}}}};

TEST(Hardening, StartsAtTheInitialYieldStress) {
  EXPECT_DOUBLE_EQ(compute_yield_stress(kSwift, 0).stress, 530 * std::pow(0.0065, 0.23));
  EXPECT_DOUBLE_EQ(compute_yield_stress(kVoce, 0).stress, 160);
  EXPECT_DOUBLE_EQ(compute_yield_stress(kHockettSherby, 0).stress, 160);
  EXPECT_DOUBLE_EQ(compute_yield_stress(kTable, 0).stress, 160);
}

TEST(Hardening, SaturatesWhereTheLawSaysSo) {
  EXPECT_NEAR(compute_yield_stress(kVoce, 10).stress, 380, 1e-9);
  EXPECT_NEAR(compute_yield_stress(kHockettSherby, 100).stress, 420, 1e-9);
}

TEST(Hardening, TableIsLinearBetweenAndConstantBeyondItsPoints) {
  EXPECT_DOUBLE_EQ(compute_yield_stress(kTable, 0.025).stress, 195);
  EXPECT_DOUBLE_EQ(compute_yield_stress(kTable, 0.2).stress, 300);
  EXPECT_DOUBLE_EQ(compute_yield_stress(kTable, 0.4).stress, 325);
  EXPECT_DOUBLE_EQ(compute_yield_stress(kTable, 2).stress, 350);
  EXPECT_DOUBLE_EQ(compute_yield_stress(kTable, 2).slope, 0);
  EXPECT_DOUBLE_EQ(compute_yield_stress(scene::HardeningTable{{{{0.1, 50.0}}}}, 0).stress, 50);
}

TEST(Hardening, IsTheFormulaOfTheScene) {
  for (const scene::Hardening& h : {scene::Hardening{kSwift}, {kVoce}, {kHockettSherby}, {kTable}})
    for (const double p : {0.0, 1e-9, 1e-5, 0.01, 0.1, 0.37, 2.0})
      EXPECT_NEAR(compute_yield_stress(h, p).stress, test::compute_reference_yield(h, p), 1e-12) << h.index();
}

/// However suddenly the curve rises from there.
TEST(Hardening, BeginsAtTheInitialYieldStressWithASlopeThatIsANumber) {
  for (const double n : {0.01, 0.4, 1.0, 1.5}) {
    const YieldStress<double> y = compute_yield_stress(scene::HockettSherby{160, 420, 5, n}, 0);
    EXPECT_DOUBLE_EQ(y.stress, 160);
    EXPECT_GE(y.slope, 0) << n;
    EXPECT_NEAR(y.slope, 260 * 5, n == 1 ? 1e-9 : INFINITY) << n;
  }
}

TEST(Hardening, SlopeIsTheDerivative) {
  for (const scene::Hardening& h : {scene::Hardening{kSwift}, {kVoce}, {kHockettSherby}, {kTable}})
    for (const double p : {0.01, 0.1, 0.37}) {
      const double d = 1e-6;
      const double difference =
          (compute_yield_stress(h, p + d).stress - compute_yield_stress(h, p - d).stress) / (2 * d);
      EXPECT_NEAR(compute_yield_stress(h, p).slope, difference, 1e-5 * difference) << h.index() << " at " << p;
    }
}

}  // namespace
}  // namespace interply::metal
