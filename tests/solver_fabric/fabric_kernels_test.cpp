// The kernels of a ply against the paper's energy and its complex steps, for every target that this machine runs.
#include "solver_fabric/fabric_kernels.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "solver_fabric/membrane_law.hpp"
#include "support/bending_sheet.hpp"
#include "support/woven_paper.hpp"

namespace interply::fabric {
namespace {

using mechanics::NodalVectors;
using mechanics::Scalars;
using mechanics::ShellGeometry;
using mechanics::ShellPasses;
using mechanics::ShellRows;

constexpr double kThickness = 1.2, kAngle = 0.3;
constexpr BendingStiffness kBending{2.2, 3.1, 0.4};

scene::WovenLaw make_law(scene::Variant variant) {
  scene::WovenLaw law;
  law.variant = variant;
  law.a = {5.5e4, 4.1e4};
  law.c = {-60, -45};
  law.p_min = {0.4, 0.6};
  law.strain_cap = {0.05, 0.04};
  if (variant == scene::Variant::Fabric)
    law.tables = {.warp = {{-0.2, -30}, {0, 0}, {0.03, 8}, {0.06, 40}},
                  .weft = {{-0.2, -20}, {-0.01, -2}, {0.02, 4}, {0.05, 30}, {0.08, 90}},
                  .shear = {{0, 0}, {0.04, 0.03}, {0.09, 0.2}, {0.12, 1}}};
  return law;
}

/// Nodes moved at random: stretches, shear and slopes of some per cent, tension and compression mixed.
NodalVectors move_at_random(const mechanics::TriangleMesh& mesh, double amount) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> by(-amount, amount);
  NodalVectors x = mesh.reference;
  for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i)
    for (int d = 0; d < 3; ++d) x(d, i) += by(random);
  return x;
}

/// One evaluation of a ply.
struct Evaluation {
  NodalVectors force;
  Scalars torque;  ///< what drives each edge, N mm
  double energy = 0, bound = 0;
};

struct Ply {
  mechanics::TriangleMesh mesh;
  scene::WovenLaw woven;
  MembraneLaw law;
  ShellGeometry shell;
  NodalVectors x;
  Scalars phi;

  Ply(const mechanics::TriangleMesh& m, scene::Variant variant)
      : mesh(m),
        woven(make_law(variant)),
        law(make_membrane_law(woven)),
        shell(mechanics::make_shell_geometry(m, kAngle)) {
    x = move_at_random(mesh, 0.15);
    phi = 0.02 * Scalars::Random(shell.n_edges());
  }

  /// Membrane by the paper's energy and complex steps, bending by mechanics/edge_shell.hpp.
  Evaluation evaluate_by_the_paper() const {
    ShellPasses passes(shell);
    Evaluation r;
    const Eigen::Index n = mesh.n_elements();
    NodalVectors slots = NodalVectors::Zero(3, 3 * n);
    for (Eigen::Index e = 0; e < n; ++e) {
      passes.store_facet(e, mechanics::compute_surface_gradient(shell, x, e));
      const auto [triangle, corners] = get_triangle(e);
      const Eigen::Vector3cd state = triangle.compute_state(corners.cast<woven_paper::Complex>());
      const Eigen::Vector3d q = state.real();
      const double volume = triangle.area * kThickness;
      const Eigen::Matrix<double, 3, 9> B = triangle.compute_kinematics(corners);
      const Eigen::Vector3d gradient = woven_paper::compute_gradient(woven, q);
      const Eigen::Matrix<double, 9, 1> force = volume * B.transpose() * gradient;
      for (int k = 0; k < 3; ++k) mechanics::add_at(slots, k * n + e, force.segment<3>(3 * k));
      r.energy += volume * woven_paper::compute_energy<double>(woven, q(0) * q(0), q(1) * q(1), q(2));
      r.bound = std::max(r.bound, compute_bound(q, gradient, B, triangle.compute_gradient_products()));
    }
    for (Eigen::Index e = 0; e < n; ++e) {
      const mechanics::Curvature k = mechanics::compute_curvature(shell, passes, phi, e);
      const double m11 = kBending.warp * k.k11, m22 = kBending.weft * k.k22, m12 = 2 * kBending.twist * k.k12;
      mechanics::store_moments(shell, k, m11, m22, m12, e, passes);
      r.energy += shell.area(e) * (m11 * k.k11 + m22 * k.k22 + 2 * m12 * k.k12) / 2;
    }
    for (Eigen::Index e = 0; e < n; ++e) mechanics::add_bending_forces(shell, passes, e, slots);
    r.force.resize(3, mesh.n_nodes());
    mechanics::gather_forces(shell.gather, slots, 0, mesh.n_nodes(), r.force);
    r.torque.resize(shell.n_edges());
    for (Eigen::Index i = 0; i < shell.n_edges(); ++i) r.torque(i) = mechanics::compute_edge_torque(shell, passes, i);
    return r;
  }

  std::pair<woven_paper::Triangle, Eigen::Matrix3d> get_triangle(Eigen::Index e) const {
    Eigen::Matrix3d reference, current;
    for (int k = 0; k < 3; ++k) {
      reference.col(k) = mesh.reference.col(mesh.triangles(k, e)).matrix();
      current.col(k) = x.col(mesh.triangles(k, e)).matrix();
    }
    return {woven_paper::Triangle(reference.topRows<2>(), kAngle), current};
  }

  /// Larger stiffness of a fibre on the two sides of l = 1, MPa.
  double get_floor(bool warp) const {
    const auto side = [&](double h) {
      return woven_paper::compute_hessian(woven, {warp ? 1 + h : 1, warp ? 1 : 1 + h, 0}, 1e-9)(warp ? 0 : 1,
                                                                                                warp ? 0 : 1);
    };
    return std::max(side(-4e-9), side(4e-9));
  }

  /// The bound of stable_increment.hpp, its eigenvalues by Eigen. @param q  (la, lb, gamma)
  double compute_bound(const Eigen::Vector3d& q, const Eigen::Vector3d& gradient, const Eigen::Matrix<double, 3, 9>& B,
                       const Eigen::Matrix2d& G) const {
    const auto largest = [](const auto& m) { return m.eigenvalues().real().maxCoeff(); };
    Eigen::Matrix3d H = woven_paper::compute_hessian(woven, q);
    for (int i = 0; i < 2; ++i) H(i, i) = std::max(H(i, i), get_floor(i == 0));
    const Eigen::Vector2d inverse(1 / q(0), 1 / q(1));
    const double across = std::max({0.0, gradient(0) / q(0), gradient(1) / q(1)});
    Eigen::Matrix2d C;
    C << q(0) * q(0), q(0) * q(1) * std::sin(q(2)), q(0) * q(1) * std::sin(q(2)), q(1) * q(1);
    const double in_plane = std::max(0.0, largest((H * B * B.transpose()).eval())) + across * largest(G) +
                            std::abs(gradient(2)) * largest((inverse.asDiagonal() * G * inverse.asDiagonal()).eval());
    return std::max(in_plane, largest((woven_paper::compute_stress(woven, C) * G).eval()));
  }

  template <class Target>
  Evaluation evaluate() const {
    const FabricKernels& fabric = get_fabric_kernels<Target>();
    const mechanics::ShellPassKernels& common = mechanics::get_shell_pass_kernels<Target>();
    ShellPasses passes(shell);
    const ShellRows rows(shell, passes);
    const Eigen::Index n = mesh.n_elements(), n_edges = shell.n_edges();
    const double* const at[3] = {&x(0, 0), &x(1, 0), &x(2, 0)};
    Evaluation r;
    // blocks of an odd size, so that packs end everywhere
    for (Eigen::Index begin = 0; begin < n; begin += 37) {
      const Eigen::Index end = std::min(n, begin + 37);
      const MembraneResult m = fabric.stretch(rows, at, law, kThickness, begin, end);
      EXPECT_EQ(m.failed, -1);
      r.energy += m.energy;
      r.bound = std::max(r.bound, fabric.bound(rows, at, law, begin, end));
    }
    common.reflect_facets(rows, 0, static_cast<std::ptrdiff_t>(shell.images.size()));
    for (Eigen::Index begin = 0; begin < n; begin += 37)
      r.energy += fabric.bend(rows, phi.data(), kBending, begin, std::min(n, begin + 37));
    for (Eigen::Index begin = 0; begin < n; begin += 37)
      common.compute_corner_forces(rows, begin, std::min(n, begin + 37));
    r.force.resize(3, mesh.n_nodes());
    double* const force[3] = {&r.force(0, 0), &r.force(1, 0), &r.force(2, 0)};
    common.gather_forces(rows, force, 0, mesh.n_nodes());
    r.torque.resize(n_edges);
    for (Eigen::Index i = 0; i < n_edges; ++i) r.torque(i) = mechanics::compute_edge_torque(shell, passes, i);
    return r;
  }
};

std::vector<mechanics::TriangleMesh> make_meshes() {
  return {mechanics::test::make_unstructured({0, 43}, {0, 31}, 4),
          mechanics::make_rectangle({0, 30}, {0, 22}, 4, 0, true)};
}

void expect_close(const Evaluation& a, const Evaluation& b, double tolerance) {
  EXPECT_LT((a.force - b.force).abs().maxCoeff(), tolerance * b.force.abs().maxCoeff());
  EXPECT_LT((a.torque - b.torque).abs().maxCoeff(), tolerance * b.torque.abs().maxCoeff());
  EXPECT_NEAR(a.energy, b.energy, tolerance * b.energy);
}

class FabricKernelsOfAVariant : public testing::TestWithParam<scene::Variant> {};

template <class Target>
void compare(scene::Variant variant) {
  for (const auto& mesh : make_meshes()) {
    const Ply ply(mesh, variant);
    const Evaluation paper = ply.evaluate_by_the_paper(), kernels = ply.evaluate<Target>();
    expect_close(kernels, paper, 1e-12);
    // Newton's method for the eigenvalue ends above the root
    EXPECT_GE(kernels.bound, paper.bound * (1 - 1e-8));
    EXPECT_LE(kernels.bound, paper.bound * (1 + 5e-3));
  }
}

TEST_P(FabricKernelsOfAVariant, ScalarAgreesWithThePaper) { compare<simd::Scalar>(GetParam()); }

TEST_P(FabricKernelsOfAVariant, PacksAgreeWithThePaperAndHaveTheSameBitsAtAnyWidth) {
#if defined(__x86_64__)
  compare<simd::Avx2>(GetParam());
  if (simd::choose_target() != simd::Choice::Avx512) GTEST_SKIP() << "this machine has no AVX-512";
  compare<simd::Avx512>(GetParam());
  for (const auto& mesh : make_meshes()) {
    const Ply ply(mesh, GetParam());
    const Evaluation four = ply.evaluate<simd::Avx2>(), eight = ply.evaluate<simd::Avx512>();
    EXPECT_TRUE((four.force == eight.force).all());
    EXPECT_TRUE((four.torque == eight.torque).all());
    EXPECT_EQ(four.energy, eight.energy);
  }
#endif
}

INSTANTIATE_TEST_SUITE_P(All, FabricKernelsOfAVariant,
                         testing::Values(scene::Variant::Uncoupled, scene::Variant::Full, scene::Variant::Biaxial,
                                         scene::Variant::NormalShear, scene::Variant::Fabric));

TEST(FabricKernels, NameTheFirstElementThatIsFolded) {
  Ply ply(mechanics::make_rectangle({0, 40}, {0, 40}, 4), scene::Variant::Full);
  ply.x = ply.mesh.reference;
  const int folded = 101;
  // its third corner comes to lie on the side across
  const int a = ply.mesh.triangles(0, folded), b = ply.mesh.triangles(1, folded), c = ply.mesh.triangles(2, folded);
  ply.x.col(c) = 0.5 * (ply.x.col(a) + ply.x.col(b));
  ShellPasses passes(ply.shell);
  const ShellRows rows(ply.shell, passes);
  const double* const at[3] = {&ply.x(0, 0), &ply.x(1, 0), &ply.x(2, 0)};
  const MembraneResult m = choose_fabric_kernels().stretch(rows, at, ply.law, kThickness, 0, ply.mesh.n_elements());
  EXPECT_EQ(m.failed, folded);
}

}  // namespace
}  // namespace interply::fabric
