#include "coordinator/fastest_mode.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace {

using namespace interply::coordinator;

TEST(FastestMode, OfAMassOnTwoSpringsIsExact) {
  const double m = 2e-6, element = 300, contact = 500;
  Chain chain(1);
  chain.own[0].stiffness = element / m + contact / m;
  EXPECT_NEAR(find_fastest_mode(chain).increment, 2 / std::sqrt((element + contact) / m), 1e-15);
  EXPECT_EQ(find_fastest_mode(Chain(1)).increment, std::numeric_limits<double>::infinity());
}

TEST(FastestMode, OfADampedOscillatorIsTheLimitOfTheLaggedDamper) {
  // u'' = -u - 2 zeta v(n - 1/2): largest dt whose amplification stays at one, found by iterating
  for (const double zeta : {0.0, 0.05, 0.3}) {
    Chain chain(1);
    chain.own[0] = {1, 2 * zeta};
    const double limit = find_fastest_mode(chain).increment;
    EXPECT_NEAR(limit, 2 * (std::sqrt(1 + zeta * zeta) - zeta), 1e-14);
    const auto grows = [&](double dt) {
      double u = 1, v = 0;
      for (int n = 0; n < 20000 && std::abs(u) < 1e6; ++n) {
        v += dt * (-u - 2 * zeta * v);
        u += dt * v;
      }
      return std::abs(u) >= 1e6;
    };
    EXPECT_FALSE(grows(0.999 * limit)) << zeta;
    EXPECT_TRUE(grows(1.001 * limit)) << zeta;
  }
}

TEST(FastestMode, OfEqualMassesBetweenRigidWallsIsThatOfTheChain) {
  const double k = 500, m = 7.4e-10;
  for (const int n : {1, 2, 3, 8}) {
    Chain chain(static_cast<std::size_t>(n));
    for (auto& own : chain.own) own.stiffness = 2 * k / m;
    for (auto& up : chain.up) up.stiffness = k / m;
    chain.down = chain.up;
    const double omega = 2 * std::sqrt(k / m) * std::sin(0.5 * n * std::numbers::pi / (n + 1));
    EXPECT_NEAR(find_fastest_mode(chain).increment, 2 / omega, 1e-12 * 2 / omega) << n;
  }
}

/// Masses joined by springs and dampers of any size. The eigenvalues z of the step, from its companion matrix, leave
/// the unit circle at the increment.
TEST(FastestMode, OfUnlikeMassesSpringsAndDampersIsTheLimitOfTheStep) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.1, 1);
  const Eigen::Index n = 5;
  for (int trial = 0; trial < 20; ++trial) {
    const auto assemble = [&](const Eigen::VectorXd& of_link) {  // link i lies below member i
      Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
      for (Eigen::Index i = 0; i < n; ++i) {
        a(i, i) = of_link(i) + of_link(i + 1);
        if (i > 0) a(i, i - 1) = a(i - 1, i) = -of_link(i);
      }
      return a;
    };
    const auto draw = [&](Eigen::Index size, double scale) {
      return Eigen::VectorXd(Eigen::VectorXd::NullaryExpr(size, [&] { return scale * unit(random); }));
    };
    const Eigen::VectorXd inverse_mass = draw(n, 3);
    const Eigen::MatrixXd k = inverse_mass.asDiagonal() * assemble(draw(n + 1, 1));
    const Eigen::MatrixXd c = inverse_mass.asDiagonal() * assemble(draw(n + 1, 0.3));
    Chain chain(static_cast<std::size_t>(n));
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      chain.own[at] = {k(i, i), c(i, i)};
      if (i + 1 == n) break;
      chain.up[at] = {-k(i, i + 1), -c(i, i + 1)};
      chain.down[at] = {-k(i + 1, i), -c(i + 1, i)};
    }
    const double limit = find_fastest_mode(chain).increment;
    const auto find_growth = [&](double dt) {
      const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n);
      Eigen::MatrixXd step(2 * n, 2 * n);
      step << 2 * one - dt * dt * k - dt * c, dt * c - one, one, Eigen::MatrixXd::Zero(n, n);
      return step.eigenvalues().cwiseAbs().maxCoeff();
    };
    EXPECT_LE(find_growth(0.9999 * limit), 1 + 1e-9);
    EXPECT_GT(find_growth(1.0001 * limit), 1 + 1e-9);
  }
}

TEST(FastestMode, NamesTheMemberThatMovesMost) {
  Chain chain(3);
  for (const std::size_t fast : {0u, 1u, 2u}) {
    for (auto& own : chain.own) own = {1, 0};
    chain.own[fast].stiffness = 4;
    for (auto& link : chain.up) link.stiffness = 0.5;
    chain.down = chain.up;
    EXPECT_EQ(find_fastest_mode(chain).member, static_cast<int>(fast));
  }
}

}  // namespace
