#include "solver_metal/symmetric2.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace interply::metal {
namespace {

Eigen::Matrix2d as_matrix(const Symmetric2& a) {
  Eigen::Matrix2d m;
  m << a.m11, a.m12, a.m12, a.m22;
  return m;
}

TEST(InverseStretch, SquaredInverseIsTheMetric) {
  for (const Symmetric2 c : {Symmetric2{1, 1, 0}, {1.4, 0.6, 0.3}, {9, 0.04, -0.5}}) {
    const Eigen::Matrix2d u = as_matrix(compute_inverse_stretch(c, std::sqrt(c.determinant()))).inverse();
    EXPECT_LT((u * u - as_matrix(c)).norm(), 1e-13 * as_matrix(c).norm());
    EXPECT_GT(u.trace(), 0);
    EXPECT_GT(u.determinant(), 0);
  }
}

TEST(Symmetric2, CongruenceAndPrincipalValuesAgreeWithMatrixAlgebra) {
  const Symmetric2 u{1.3, 0.8, 0.2}, x{-2, 5, 1.5};
  const Eigen::Matrix2d expected = as_matrix(u) * as_matrix(x) * as_matrix(u);
  EXPECT_LT((as_matrix(compute_congruence(u, x)) - expected).norm(), 1e-14);
  const Eigen::Vector2d values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(as_matrix(x)).eigenvalues();
  EXPECT_NEAR(compute_principal(x).first, values(1), 1e-14);
  EXPECT_NEAR(compute_principal(x).second, values(0), 1e-14);
  EXPECT_NEAR(contract(u, x), (as_matrix(u) * as_matrix(x)).trace(), 1e-14);
}

}  // namespace
}  // namespace interply::metal
