#include "solver_metal/stable_increment.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <iostream>

#include "support/metal_sheet.hpp"

namespace interply::metal::test {
namespace {

/// 2/sqrt(largest eigenvalue of M^-1 K), K by central differences of the forces about the state that `amount` of
/// make_curved_shape() leaves.
double compute_exact_increment(const TriangleMesh& mesh, const scene::Layer& layer, double amount, int steps) {
  const Eigen::Index n = 3 * mesh.n_nodes();
  const NodalVectors x = make_curved_shape(mesh, amount);
  const mechanics::Scalars mass = mechanics::compute_lumped_mass(mesh, layer.thickness, layer.density);
  Eigen::MatrixXd k(n, n);
  const double h = 1e-6;
  for (Eigen::Index j = 0; j < n; ++j) {
    NodalVectors f[2];
    for (const int side : {0, 1}) {
      Sheet sheet(layer, mesh);
      if (amount != 0) sheet.bend(mesh, amount, steps);
      NodalVectors moved = x;
      moved.data()[j] += side ? h : -h;
      f[side] = sheet.advance(moved);
    }
    const NodalVectors column = (f[1] - f[0]) / (2 * h);
    for (Eigen::Index i = 0; i < n; ++i)
      k(i, j) = column.data()[i] / std::sqrt(mass(i % mesh.n_nodes()) * mass(j % mesh.n_nodes()));
  }
  const Eigen::MatrixXd symmetric = 0.5 * (k + k.transpose());
  return 2 / std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric).eigenvalues().maxCoeff());
}

struct Case {
  const char* name;
  double mesh_size, thickness, distortion, amount;
  int steps;
};

class StableIncrement : public testing::TestWithParam<Case> {};

TEST_P(StableIncrement, IsBelowTheExactOneAndNotFarBelow) {
  const Case c = GetParam();
  const TriangleMesh mesh = make_distorted_square(6 * c.mesh_size, c.mesh_size, c.distortion);
  const scene::Layer layer = make_sheet(make_elastic(), 5, c.thickness);
  Sheet sheet(layer, mesh);
  if (c.amount != 0) sheet.bend(mesh, c.amount, c.steps);
  const double bound = sheet.layer.compute_stable_increment();
  const double exact = compute_exact_increment(mesh, layer, c.amount, c.steps);
  std::cout << c.name << ": bound " << bound << " exact " << exact << " ratio " << exact / bound << "\n";
  EXPECT_LE(bound, exact);
  EXPECT_LE(exact, 1.3 * bound);
}

INSTANTIATE_TEST_SUITE_P(Sheets, StableIncrement,
                         testing::Values(Case{"flat 4 mm", 4, 1, 0, 0, 1}, Case{"flat 10 mm", 10, 1, 0, 0, 1},
                                         Case{"distorted", 4, 1, 0.15, 0, 1}, Case{"curved", 10, 1, 0.1, 0.5, 5},
                                         Case{"far", 10, 1, 0, 2, 10}, Case{"flat 2 mm", 2, 1, 0, 0, 1}),
                         [](const auto& info) { return std::to_string(info.index); });

}  // namespace
}  // namespace interply::metal::test
