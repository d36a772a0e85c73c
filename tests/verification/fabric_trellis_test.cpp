/// V6: trellis shear of an aligned mesh, and how much a mesh turned against the fibres locks.
#include <gtest/gtest.h>

#include <cstdio>

#include "solver_fabric/fabric_layer.hpp"
#include "support/fabric_cases.hpp"

namespace interply {
namespace {

using namespace fabric_cases;
using mechanics::NodalVectors;

std::vector<double> get_field(const fabric::FabricLayer& layer, const std::string& name) {
  for (const auto& f : layer.compute_fields())
    if (f.name == name) return f.values;
  throw std::invalid_argument(name);
}

double compute_largest_fibre_strain(const fabric::FabricLayer& layer) {
  double largest = 0;
  for (const char* name : {"stretch_warp", "stretch_weft"})
    for (const double l : get_field(layer, name)) largest = std::max(largest, std::abs(l - 1));
  return largest;
}

TEST(TrellisShear, AlignedMeshKeepsItsFibreLengthTo60Degrees) {
  const auto mesh = mechanics::make_rectangle({-20, 20}, {0, 40}, 4);
  fabric::FabricLayer layer(make_layer(soft()), 1, mesh);
  NodalVectors force;
  for (const double degrees : {-60.0, -20.0, 10.0, 30.0, 60.0}) {
    layer.compute_internal_forces(map_in_plane(mesh, trellis(degrees * kDegree)), 0, force);
    EXPECT_LT(compute_largest_fibre_strain(layer), 1e-12);
    for (const double gamma : get_field(layer, "shear_angle")) EXPECT_NEAR(gamma, degrees * kDegree, 1e-12);
  }
}

TEST(TrellisShear, AlignedMeshFollowsAShearThatVariesFromCellToCellWithoutFibreStrain) {
  const int n = 10;
  const double h = 4;
  const auto mesh = mechanics::make_rectangle({0, n * h}, {0, n * h}, h);
  NodalVectors x = mesh.reference;
  // every column of cells turns its warp edges, every row its weft edges: gamma = 3 (i + j + 1) deg, up to 57
  Eigen::Array2Xd along(2, n + 1), across(2, n + 1);
  along.col(0).setZero();
  across.col(0).setZero();
  for (int i = 0; i < n; ++i) {
    const double turn = 3 * (i + 0.5) * kDegree;
    along.col(i + 1) = along.col(i) + h * Eigen::Array2d(std::cos(turn), std::sin(turn));
    across.col(i + 1) = across.col(i) + h * Eigen::Array2d(std::sin(turn), std::cos(turn));
  }
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) x.col(j * (n + 1) + i).head(2) = along.col(i) + across.col(j);
  fabric::FabricLayer layer(make_layer(soft()), 1, mesh);
  NodalVectors force;
  layer.compute_internal_forces(x, 0, force);
  EXPECT_LT(compute_largest_fibre_strain(layer), 1e-12);
  const auto gammas = get_field(layer, "shear_angle");
  EXPECT_NEAR(*std::max_element(gammas.begin(), gammas.end()), 57 * kDegree, 1e-12);
}

/// A net of inextensible fibres whose shear angle grows from corner to corner: in the fibre frame
///   x(xi, eta) = int (cos, sin)(k xi) dxi + int (sin, cos)(k eta) deta,   gamma = k (xi + eta).
struct CurvedNet {
  double k;      ///< rad/mm
  double angle;  ///< of the warp from x, rad

  double shear_angle(const Eigen::Vector2d& X) const { return k * (Eigen::Rotation2Dd(-angle) * X).sum(); }
  Eigen::Vector2d map(const Eigen::Vector2d& X) const {
    const Eigen::Vector2d r = Eigen::Rotation2Dd(-angle) * X;
    const double a = k * r.x(), b = k * r.y();
    const Eigen::Vector2d x(std::sin(a) + 1 - std::cos(b), 1 - std::cos(a) + std::sin(b));
    return Eigen::Rotation2Dd(angle) * x / k;
  }
};

/// Holds the edge nodes on the net, lets the others find their equilibrium (kinetic damping) and returns the energy
/// over that of the net itself, 1 for a mesh that does not lock.
double compute_energy_ratio(const scene::WovenLaw& law, double angle_deg, double h) {
  const double half = 30;
  const auto mesh = mechanics::make_rectangle({-half, half}, {-half, half}, h);
  const CurvedNet net{0.8 / (2 * half), angle_deg * kDegree};
  fabric::FabricLayer layer(make_layer(law, angle_deg), 1, mesh);
  NodalVectors x = mesh.reference, v = NodalVectors::Zero(3, mesh.n_nodes()), force;
  Eigen::ArrayXd free(mesh.n_nodes());
  double exact = 0;
  const auto mass = mechanics::compute_lumped_mass(mesh, 1.2, 6.19e-10);
  const fabric::MembraneLaw membrane = fabric::make_membrane_law(law);
  for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i) {
    const Eigen::Vector2d X(x(0, i), x(1, i));
    x.col(i).head(2) = net.map(X).array();
    free(i) = X.cwiseAbs().maxCoeff() < half - 1e-9 ? 1 : 0;
  }
  const int n = 200;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const Eigen::Vector2d X((2 * (i + 0.5) / n - 1) * half, (2 * (j + 0.5) / n - 1) * half);
      const double g = net.shear_angle(X);
      exact += std::visit([&](const auto& l) { return l.evaluate(1, 1, g).W; }, membrane) * 1.2;
    }
  exact *= 4 * half * half / (n * n);

  double kinetic = 0, dt = 0;
  for (int step = 0; step < 1200; ++step) {
    layer.compute_internal_forces(x, 0, force);
    if (step % 20 == 0) dt = 0.8 * layer.compute_stable_increment();
    for (int c = 0; c < 2; ++c) v.row(c) -= dt * force.row(c) * (free / mass).transpose();
    const double now = (v.square().colwise().sum() * mass.transpose()).sum();
    if (now < kinetic) v.setZero();
    kinetic = now < kinetic ? 0 : now;
    x += dt * v;
  }
  return layer.internal_energy() / exact;
}

TEST(TrellisShear, MeshTurnedAgainstTheFibresLocks) {
  for (const auto& [name, law] : {std::pair{"soft", soft()}, std::pair{"stiff", stiff()}}) {
    const double aligned = compute_energy_ratio(law, 0, 10);
    const double turned = compute_energy_ratio(law, 22.5, 10), turned_fine = compute_energy_ratio(law, 22.5, 5);
    std::printf("set %s: energy / energy of the net: aligned %.3f, turned 22.5 deg %.2f (10 mm) and %.2f (5 mm)\n",
                name, aligned, turned, turned_fine);
    // below 1: free to stretch a little, the fibres find less energy than the inextensible net
    EXPECT_LT(std::abs(aligned - 1), 0.01);
    EXPECT_GT(turned_fine, 2);
    EXPECT_GT(turned, 2 * turned_fine);
  }
}

}  // namespace
}  // namespace interply
