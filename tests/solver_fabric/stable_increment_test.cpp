/// The bound of the stable increment against the exact largest eigenvalue of the assembled M^-1 K.
#include "solver_fabric/stable_increment.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cstdio>

#include "solver_fabric/fabric_layer.hpp"
#include "support/fabric_cases.hpp"
#include "support/woven_paper.hpp"

namespace interply {
namespace {

using namespace fabric_cases;
using fabric::FabricLayer;
using mechanics::NodalVectors;

/// 2 / omega_max of the tangent by differences of the force.
double compute_exact_increment(FabricLayer& layer, const mechanics::TriangleMesh& mesh, const NodalVectors& x,
                               double density) {
  const Eigen::Index n = x.cols();
  const auto mass = mechanics::compute_lumped_mass(mesh, 1.2, density);
  Eigen::MatrixXd K(3 * n, 3 * n);
  const double h = 1e-5;
  NodalVectors moved = x, above, below;
  for (int c = 0; c < 3; ++c)
    for (Eigen::Index i = 0; i < n; ++i) {
      moved(c, i) = x(c, i) + h;
      layer.compute_internal_forces(moved, {}, above);
      moved(c, i) = x(c, i) - h;
      layer.compute_internal_forces(moved, {}, below);
      moved(c, i) = x(c, i);
      for (int d = 0; d < 3; ++d)
        for (Eigen::Index j = 0; j < n; ++j)
          K(d * n + j, c * n + i) = (above(d, j) - below(d, j)) / (2 * h) / std::sqrt(mass(i) * mass(j));
    }
  const Eigen::MatrixXd symmetric = (K + K.transpose()) / 2;
  layer.compute_internal_forces(x, {}, above);
  return 2 / std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly)
                           .eigenvalues()
                           .maxCoeff());
}

mechanics::Matrix2 deform(double la, double lb, double gamma) {
  mechanics::Matrix2 F;
  F << la, lb * std::sin(gamma), 0, lb * std::cos(gamma);
  return F;
}

struct Case {
  const char* name;
  mechanics::Matrix2 F;
};

std::vector<Case> flat_states() {
  return {{"undeformed", deform(1, 1, 0)},
          {"warp 5 %", deform(1.05, 1, 0)},
          {"weft 2 %", deform(1, 1.02, 0)},
          {"biaxial 3 %", deform(1.03, 1.03, 0)},
          {"free width", deform(1.03, 0.985, 0)},
          {"shear 30 deg", deform(1, 1, 30 * kDegree)},
          {"shear -50 deg", deform(1, 1, -50 * kDegree)},
          {"shear and tension", deform(1.03, 1.01, 40 * kDegree)}};
}

/// The worst mode of an element in biaxial tension with coupling cannot be that of its neighbours too, which makes the
/// bound looser there than elsewhere.
TEST(StableIncrement, BoundsTheExactOneCloselyOnFlatStates) {
  const auto mesh = mechanics::make_rectangle({0, 16}, {0, 16}, 4);
  for (const auto variant : kVariants)
    for (const auto& set : all_sets(variant)) {
      auto law = set;
      law.d = law.b;  // one stiffness on both sides of l = 1, so that the differences see what the floor assumes
      const auto ply = make_layer(law);
      FabricLayer layer(ply, 1, mesh);
      double largest = 0;
      for (const Case& state : flat_states()) {
        const NodalVectors x = map_in_plane(mesh, state.F);
        NodalVectors force;
        const double exact = compute_exact_increment(layer, mesh, x, ply.density);
        const double bound = layer.compute_stable_increment(x);
        EXPECT_LE(bound, exact * (1 + 1e-6)) << name_of(variant) << ", " << state.name;
        EXPECT_LE(exact, (is_biaxial(variant) ? 1.4 : 1.25) * bound) << name_of(variant) << ", " << state.name;
        largest = std::max(largest, exact / bound);
      }
      std::printf("%s: exact / bound at most %.3f\n", name_of(variant).c_str(), largest);
    }
}

TEST(StableIncrement, KinematicProductsAreThoseOfTheGradientsOfStretchAndShear) {
  const auto mesh = distort(mechanics::make_rectangle({0, 4}, {0, 4}, 4), 0.8);
  const auto shell = mechanics::make_shell_geometry(mesh, 0.3);
  NodalVectors x = map_in_plane(mesh, deform(1.1, 0.9, -0.6));
  x.row(2) = 0.3 * x.row(0) - 0.2 * x.row(1);
  for (Eigen::Index e = 0; e < mesh.n_elements(); ++e) {
    Eigen::Matrix3d reference, current;
    mechanics::Gradient<double> n;
    for (int k = 0; k < 3; ++k) {
      reference.col(k) = mesh.reference.col(mesh.triangles(k, e)).matrix();
      current.col(k) = x.col(mesh.triangles(k, e)).matrix();
      n.n1[k] = shell.gradient(2 * k, e);
      n.n2[k] = shell.gradient(2 * k + 1, e);
    }
    const auto B = woven_paper::Triangle(reference.topRows<2>(), 0.3).compute_kinematics(current);
    const auto f = mechanics::compute_surface_gradient(shell, x, e);
    const auto state = fabric::compute_fibre_state<double>({.f1 = {f.f1.x(), f.f1.y(), f.f1.z()},
                                                            .f2 = {f.f2.x(), f.f2.y(), f.f2.z()},
                                                            .t3 = {},
                                                            .area_ratio = f.area_ratio});
    const auto [q] = fabric::compute_kinematic_products(state, fabric::compute_gradient_products(n));
    Eigen::Matrix3d Q;
    Q << q[0], q[3], q[4], q[3], q[1], q[5], q[4], q[5], q[2];
    EXPECT_LT((Q - B * B.transpose()).cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST(StableIncrement, HoldsOnDistortedWavyMeshesOfAnyOrientation) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const auto mesh = distort(mechanics::make_rectangle({0, 16}, {0, 12}, 4, 0, seed % 2 == 0), 0.8, seed);
    auto law = seed % 3 == 0 ? stiff() : lopsided();
    law.d = law.b;
    const auto ply = make_layer(law, 17.0 * seed);
    FabricLayer layer(ply, 1, mesh);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> move(-0.08, 0.08);
    NodalVectors x = map_in_plane(mesh, deform(1.04, 1.03, 0.1 * seed));
    for (Eigen::Index i = 0; i < x.size(); ++i) x(i) += move(random);
    const double exact = compute_exact_increment(layer, mesh, x, ply.density);
    const double bound = layer.compute_stable_increment(x);
    EXPECT_LE(bound, exact);
    std::printf("seed %u: exact / bound %.3f\n", seed, exact / bound);
  }
}

/// Without a membrane the increment is that of the bending alone (mechanics/edge_motion_test.cpp compares it with the
/// exact one, edges included). The edges stand still here, so the exact one is that of the nodes.
TEST(StableIncrement, BendingAloneIsBounded) {
  for (const bool symmetric : {false, true}) {
    const auto mesh = distort(mechanics::make_rectangle({0, 16}, {0, 16}, 4, 0, symmetric), 0.5);
    auto ply = make_layer(soft(scene::Variant::Uncoupled));
    scene::WovenLaw none = soft(scene::Variant::Uncoupled);
    none.a = none.b = none.d = {1e-6, 1e-6};
    none.s = {1e-6, 0, 0};
    ply.law = none;
    FabricLayer layer(ply, 1, mesh);
    const double exact = compute_exact_increment(layer, mesh, mesh.reference, ply.density);
    const double bound = layer.compute_stable_increment(mesh.reference);
    EXPECT_LE(bound, exact);
    std::printf("bending: exact / bound %.3f; bending increment %.3g s\n", exact / bound, bound);
  }
}

TEST(StableIncrement, SlackFibresDoNotVoteForALargerIncrement) {
  const auto mesh = mechanics::make_rectangle({0, 16}, {0, 16}, 4);
  auto law = soft();
  law.d = {1, 1};  // almost no compressive stiffness
  FabricLayer layer(make_layer(law), 1, mesh);
  const double reference = layer.compute_stable_increment(mesh.reference);
  NodalVectors force;
  const NodalVectors x = map_in_plane(mesh, deform(0.98, 0.98, 0));
  layer.compute_internal_forces(x, {}, force);
  EXPECT_NEAR(layer.compute_stable_increment(x), reference, 0.03 * reference);
}

TEST(StableIncrement, FollowsTheCurrentTangent) {
  const auto mesh = mechanics::make_rectangle({0, 16}, {0, 16}, 4);
  FabricLayer layer(make_layer(soft()), 1, mesh);
  const double reference = layer.compute_stable_increment(mesh.reference);
  NodalVectors force;
  const NodalVectors x = map_in_plane(mesh, deform(1.05, 1, 0));
  layer.compute_internal_forces(x, {}, force);
  // W_aa goes from 2 b = 200 to 6 a e + 2 b = 1850 MPa
  EXPECT_NEAR(reference / layer.compute_stable_increment(x), std::sqrt(1850.0 / 200), 0.15 * std::sqrt(1850.0 / 200));
}

}  // namespace
}  // namespace interply
