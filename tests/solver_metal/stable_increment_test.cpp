#include "solver_metal/stable_increment.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <memory>
#include <ostream>

#include "support/metal_sheet.hpp"

namespace interply::metal::test {
namespace {

/// A sheet formed to `amount` of make_curved_shape() and unloaded a little, so that its tangent is elastic.
struct FormedSheet {
  TriangleMesh mesh;
  scene::Layer layer;
  double amount;

  NodalVectors position() const { return make_curved_shape(mesh, 0.995 * amount); }
  std::unique_ptr<Sheet> form() const {
    auto sheet = std::make_unique<Sheet>(layer, mesh);
    if (amount != 0) sheet->bend(mesh, amount, 20);
    sheet->advance(position());
    return sheet;
  }
};

/// 2/sqrt(largest eigenvalue of M^-1 K), K by central differences of the forces.
double compute_exact_increment(const FormedSheet& formed) {
  const Eigen::Index nodes = formed.mesh.n_nodes(), n = 3 * nodes;
  const mechanics::Scalars mass =
      mechanics::compute_lumped_mass(formed.mesh, formed.layer.thickness, formed.layer.density);
  Eigen::MatrixXd k(n, n);
  const double h = 1e-6;
  for (Eigen::Index j = 0; j < n; ++j) {
    NodalVectors f[2];
    for (const int side : {0, 1}) {
      const auto sheet = formed.form();
      NodalVectors moved = formed.position();
      moved.data()[j] += side ? h : -h;
      f[side] = sheet->advance(moved);
    }
    const NodalVectors column = (f[1] - f[0]) / (2 * h);
    for (Eigen::Index i = 0; i < n; ++i) k(i, j) = column.data()[i] / std::sqrt(mass(i % nodes) * mass(j % nodes));
  }
  const Eigen::MatrixXd symmetric = 0.5 * (k + k.transpose());
  return 2 / std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric).eigenvalues().maxCoeff());
}

struct Case {
  const char* name;
  double mesh_size, thickness, distortion, amount;
  double looseness;  ///< allowed exact / bound
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

class StableIncrement : public testing::TestWithParam<Case> {};

TEST_P(StableIncrement, IsBelowTheExactOneAndNotFarBelow) {
  const Case c = GetParam();
  const FormedSheet formed{make_distorted_square(6 * c.mesh_size, c.mesh_size, c.distortion),
                           make_sheet(make_dc04(), 5, c.thickness), c.amount};
  const double bound = formed.form()->layer.compute_stable_increment(formed.position()),
               exact = compute_exact_increment(formed);
  RecordProperty("exact / bound", std::to_string(exact / bound));
  EXPECT_LE(bound, exact);
  EXPECT_LE(exact, c.looseness * bound);
}

INSTANTIATE_TEST_SUITE_P(Sheets, StableIncrement,
                         testing::Values(Case{"flat_4_mm", 4, 1, 0, 0, 1.3}, Case{"flat_10_mm", 10, 1, 0, 0, 1.3},
                                         Case{"flat_2_mm", 2, 1, 0, 0, 1.35}, Case{"distorted", 4, 1, 0.15, 0, 1.35},
                                         Case{"formed", 10, 1, 0, 1, 1.4},
                                         Case{"formed_distorted", 10, 1, 0.1, 1, 1.4}),
                         [](const auto& info) { return info.param.name; });

TEST(MembraneFrequency, IsTheExactElementEigenvalueOnEvenShares) {
  // one right triangle with legs h: G = sum g g' (3/m) with equal shares m/3; its element stiffness assembled by hand
  const double h = 4, t = 1, young = 210e3, poisson = 0.3, area = h * h / 2, mass = kDensity * area * t / 3;
  const double g[3][2] = {{-1 / h, -1 / h}, {1 / h, 0}, {0, 1 / h}};
  Symmetric2 gram{};
  Eigen::Matrix<double, 3, 6> b = Eigen::Matrix<double, 3, 6>::Zero();
  for (int k = 0; k < 3; ++k) {
    gram = gram + (area * t / mass) * Symmetric2{g[k][0] * g[k][0], g[k][1] * g[k][1], g[k][0] * g[k][1]};
    b(0, 2 * k) = b(2, 2 * k + 1) = g[k][0];
    b(1, 2 * k + 1) = b(2, 2 * k) = g[k][1];
  }
  Eigen::Matrix3d d;
  d << 1, poisson, 0, poisson, 1, 0, 0, 0, (1 - poisson) / 2;
  d *= young / (1 - poisson * poisson);
  const Eigen::Matrix<double, 6, 6> k = area * t / mass * b.transpose() * d * b;
  const double exact = Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(k).eigenvalues()(5);
  EXPECT_NEAR(bound_membrane_frequency2(gram, young, poisson, 0.0), exact, 1e-10 * exact);
}

}  // namespace
}  // namespace interply::metal::test
