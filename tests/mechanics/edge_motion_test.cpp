/// The fictitious inertia of the edges: stable, without a trace in long waves, and honest in its energy.
#include "mechanics/edge_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <numbers>
#include <ostream>

#include "support/bending_sheet.hpp"

namespace interply::mechanics::test {
namespace {

constexpr double kDensity = 7.85e-9, kThickness = 1, kYoung = 210e3;

/// Squared frequencies, ascending, of small normal displacements of the nodes and rotations of the edges. 1/s2
/// @param held           nodes that stay where they are
/// @param inertia_scale  on the inertia of the edges
Eigen::VectorXd compute_frequencies2(BendingSheet& sheet, const std::vector<bool>& held, double inertia_scale = 1) {
  const Scalars mass = compute_lumped_mass(sheet.mesh, kThickness, kDensity);
  const Scalars inertia = inertia_scale * EdgeMotion(sheet.shell, {sheet.stiffness, kDensity * kThickness}).inertia();
  std::vector<Eigen::Index> nodes, edges;
  for (Eigen::Index i = 0; i < mass.size(); ++i)
    if (!held[static_cast<std::size_t>(i)]) nodes.push_back(i);
  for (Eigen::Index i = 0; i < inertia.size(); ++i)
    if (!sheet.is_mirrored(i)) edges.push_back(i);
  const auto n_z = static_cast<Eigen::Index>(nodes.size()), n = n_z + static_cast<Eigen::Index>(edges.size());
  const auto weight = [&](Eigen::Index i) { return i < n_z ? mass(nodes[i]) : inertia(edges[i - n_z]); };
  Eigen::MatrixXd k(n, n);
  const double small = 1e-6;
  for (Eigen::Index j = 0; j < n; ++j) {
    NodalVectors x = sheet.mesh.reference;
    Scalars phi = sheet.zero_angles();
    (j < n_z ? x(2, nodes[j]) : phi(edges[j - n_z])) += small;
    sheet.evaluate(x, phi);
    for (Eigen::Index i = 0; i < n; ++i)
      k(i, j) = (i < n_z ? sheet.force(2, nodes[i]) : sheet.torque(edges[i - n_z])) / small /
                std::sqrt(weight(i) * weight(j));
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(0.5 * (k + k.transpose()), Eigen::EigenvaluesOnly)
      .eigenvalues();
}

std::vector<bool> hold_none(const TriangleMesh& mesh) {
  return std::vector<bool>(static_cast<std::size_t>(mesh.n_nodes()), false);
}

struct BoundCase {
  const char* name;
  TriangleMesh mesh;
  /// Allowed bound / exact. Bending is a few per cent of the squared frequency of a layer, so 1.6 costs 2 % of the
  /// step.
  double looseness;
};
std::ostream& operator<<(std::ostream& out, const BoundCase& c) { return out << c.name; }

class BendingFrequency : public testing::TestWithParam<BoundCase> {};

TEST_P(BendingFrequency, BoundIsAboveTheExactOneAndNotFarAbove) {
  for (const auto& stiffness :
       {make_isotropic_stiffness(2e4, 0.3), Eigen::Matrix3d(Eigen::Vector3d(2.2, 1.4, 0.3).asDiagonal())}) {
    BendingSheet sheet(GetParam().mesh, stiffness, 0.3);
    const Scalars mass = compute_lumped_mass(sheet.mesh, kThickness, kDensity);
    const EdgeMotion edges(sheet.shell, {stiffness, kDensity * kThickness});
    const double bound =
        std::sqrt(compute_bending_frequencies2(sheet.shell, stiffness, mass, edges.inertia()).maxCoeff());
    const double exact = std::sqrt(compute_frequencies2(sheet, hold_none(sheet.mesh)).maxCoeff());
    RecordProperty("bound / exact", std::to_string(bound / exact));
    EXPECT_GE(bound, exact);
    EXPECT_LE(bound, GetParam().looseness * exact);
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, BendingFrequency,
                         testing::Values(BoundCase{"alternating", make_rectangle({0, 24}, {0, 24}, 4), 1.6},
                                         BoundCase{"one_way", make_one_way({0, 24}, {0, 24}, 4), 1.6},
                                         BoundCase{"unstructured", make_unstructured({0, 24}, {0, 24}, 4), 1.6},
                                         BoundCase{"symmetry",
                                                   distort(make_rectangle({0, 24}, {0, 12}, 4, 0, true), 0.8), 1.6}),
                         [](const auto& info) { return info.param.name; });

/// Simply supported strip with nu = 0: omega = (pi/L)^2 sqrt(D/(rho t)).
double compute_strip_error(int cells, double inertia_scale, bool distorted) {
  const double length = 100, h = length / cells, d = kYoung * std::pow(kThickness, 3) / 12;
  TriangleMesh mesh = make_rectangle({0, length}, {0, 2 * h}, h);
  if (distorted) mesh = distort(mesh, 0.2 * h);
  BendingSheet sheet(mesh, make_isotropic_stiffness(d, 0));
  std::vector<bool> held = hold_none(mesh);
  for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i)
    held[static_cast<std::size_t>(i)] = mesh.reference(0, i) < 1e-9 || mesh.reference(0, i) > length - 1e-9;
  const double exact = std::pow(std::numbers::pi / length, 2) * std::sqrt(d / (kDensity * kThickness));
  return std::sqrt(compute_frequencies2(sheet, held, inertia_scale)(0)) / exact - 1;
}

TEST(EdgeInertia, LeavesTheFrequencyOfAStripAlone) {
  for (const bool distorted : {false, true}) {
    const double without = compute_strip_error(16, 1e-3, distorted);
    for (const double scale : {0.25, 1.0, 4.0}) {
      const double with = compute_strip_error(16, scale, distorted);
      RecordProperty("error, inertia x " + std::to_string(scale) + (distorted ? ", distorted" : ""),
                     std::to_string(with) + " without " + std::to_string(without));
      EXPECT_LT(std::abs(with - without), 1e-5 * scale);
    }
    EXPECT_LT(std::abs(without), 0.01);
  }
}

TEST(EdgeInertia, FrequencyOfAStripConvergesWithTheSquareOfTheMesh) {
  const double coarse = compute_strip_error(8, 1, false), fine = compute_strip_error(16, 1, false);
  RecordProperty("errors", std::to_string(coarse) + " " + std::to_string(fine));
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3);
}

/// Nodes held in a twisted shape that the edges do not fit: they ring and come to rest in balance.
struct RelaxingSheet {
  BendingSheet sheet;
  EdgeMotion edges;
  ShellRows rows;
  NodalVectors x;
  double left = 0;

  explicit RelaxingSheet(const TriangleMesh& mesh)
      : sheet(mesh, make_isotropic_stiffness(2e4, 0.3)),
        edges(sheet.shell, {sheet.stiffness, kDensity * kThickness}),
        rows(sheet.shell, sheet.passes),
        x(map(mesh, [](double X, double Y) { return Vector3(X, Y, 1e-3 * X * Y); })) {}
  double increment() const {
    const Scalars mass = compute_lumped_mass(sheet.mesh, kThickness, kDensity);
    return 1.8 /
           std::sqrt(compute_bending_frequencies2(sheet.shell, sheet.stiffness, mass, edges.inertia()).maxCoeff());
  }
  void step(double dt) {
    const Eigen::Index n = sheet.shell.n_edges();
    edges.advance(dt, 0, n);
    sheet.evaluate(x, edges.angle());
    left += edges.finish(dt, edges.update_torques(rows, dt, 0, n));
  }
};

TEST(EdgeMotion, EdgesBetweenHeldNodesComeToRestInBalance) {
  RelaxingSheet s(make_rectangle({0, 40}, {0, 40}, 4));
  s.step(0);
  const double locked = s.sheet.torque.abs().maxCoeff(), dt = s.increment();
  for (int i = 0; i < 1500; ++i) s.step(dt);
  EXPECT_GT(locked, 1);
  EXPECT_LT(s.sheet.torque.abs().maxCoeff(), 1e-6 * locked);
}

TEST(EdgeMotion, EnergyThatLeavesTheShellIsBookedToRoundOff) {
  RelaxingSheet s(make_unstructured({0, 40}, {0, 40}, 4));
  s.step(0);
  const double dt = s.increment();
  s.step(dt);  // the first kick lasts half an increment
  const double before = s.sheet.energy + s.left;
  for (int i = 0; i < 300; ++i) {
    s.step(dt);
    // the work of the torques over a step is exactly the change of the energy, which is quadratic in phi
    EXPECT_NEAR(s.sheet.energy + s.left, before, 1e-12 * before);
  }
  EXPECT_GT(s.left, 0.01 * before);
}

TEST(EdgeMotion, RigidMotionAndStandingStillMoveNoEdge) {
  RelaxingSheet s(make_unstructured({0, 40}, {0, 40}, 4));
  for (int i = 0; i < 3; ++i) s.step(0);
  EXPECT_EQ(s.edges.angle().abs().maxCoeff(), 0);
  const Eigen::Matrix3d turn(Eigen::AngleAxisd(1.3, Vector3(1, 2, -1).normalized()));
  s.x = (turn * s.sheet.mesh.reference.matrix()).array();
  s.step(0);
  const double dt = s.increment();
  for (int i = 0; i < 10; ++i) s.step(dt);
  EXPECT_LT(s.edges.angle().abs().maxCoeff(), 1e-12);
}

TEST(EdgeMotion, MirroredEdgesStayInTheirPlane) {
  RelaxingSheet s(make_rectangle({0, 40}, {0, 20}, 4, 0, true));
  s.step(0);
  const double dt = s.increment();
  for (int i = 0; i < 50; ++i) s.step(dt);
  for (Eigen::Index i = 0; i < s.sheet.shell.n_edges(); ++i)
    if (s.sheet.is_mirrored(i)) {
      EXPECT_EQ(s.edges.angle()(i), 0);
    }
  EXPECT_GT(s.edges.angle().abs().maxCoeff(), 0);
}

}  // namespace
}  // namespace interply::mechanics::test
