#include "mechanics/shell_patch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace {

using namespace interply::mechanics;

/// Moves every interior node of a regular mesh at random by `amount` of the mesh size.
TriangleMesh distort(TriangleMesh mesh, double amount, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const double x0 = mesh.reference.row(0).minCoeff(), x1 = mesh.reference.row(0).maxCoeff();
  const double y0 = mesh.reference.row(1).minCoeff(), y1 = mesh.reference.row(1).maxCoeff();
  for (int i = 0; i < mesh.n_nodes(); ++i) {
    const double x = mesh.reference(0, i), y = mesh.reference(1, i);
    if (x > x0 && x < x1 && y > y0 && y < y1) {
      mesh.reference(0, i) += amount * unit(random);
      mesh.reference(1, i) += amount * unit(random);
    }
  }
  return mesh;
}

bool is_interior(const TriangleMesh& mesh, int e) {
  return mesh.neighbours(0, e) >= 0 && mesh.neighbours(1, e) >= 0 && mesh.neighbours(2, e) >= 0;
}

/// A node field as a function of the reference position.
template <typename F>
NodalVectors map(const TriangleMesh& mesh, F f) {
  NodalVectors x(3, mesh.n_nodes());
  for (int i = 0; i < mesh.n_nodes(); ++i) {
    const Vector3 v = f(mesh.reference(0, i), mesh.reference(1, i));
    for (int d = 0; d < 3; ++d) x(d, i) = v(d);
  }
  return x;
}

TEST(ShellPatch, ConstantCurvatureIsExactOnAStructuredMesh) {
  const TriangleMesh mesh = make_rectangle({0, 6}, {0, 6}, 1);
  for (const double angle : {0.0, 0.3}) {
    const ShellPatches p = make_shell_patches(mesh, angle);
    const double k = 1e-6;  // so small that the normal does not tilt
    const NodalVectors x = map(
        mesh, [&](double X, double Y) { return Vector3(X, Y, 0.5 * k * (2 * X * X + 3 * Y * Y) + 0.7 * k * X * Y); });
    Matrix2 hessian, frame;
    hessian << 2 * k, 0.7 * k, 0.7 * k, 3 * k;
    frame << std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle);
    const Matrix2 expected = frame * hessian * frame.transpose();
    for (int e = 0; e < mesh.n_elements(); ++e) {
      if (!is_interior(mesh, e)) continue;
      const Curvature c = compute_curvature(p, x, e, compute_surface_gradient(p, x, e));
      EXPECT_NEAR(c.k11, expected(0, 0), 1e-9 * k);
      EXPECT_NEAR(c.k22, expected(1, 1), 1e-9 * k);
      EXPECT_NEAR(c.k12, expected(0, 1), 1e-9 * k);
    }
  }
}

TEST(ShellPatch, FlatStatesHaveNoCurvatureHoweverStretchedAndTurned) {
  const TriangleMesh mesh = distort(make_rectangle({0, 6}, {0, 6}, 1), 0.2, 1);
  const ShellPatches p = make_shell_patches(mesh, 0.4);
  const Eigen::Matrix3d turn(Eigen::AngleAxisd(1.1, Vector3(1, 2, 3).normalized()));
  const NodalVectors x = map(mesh, [&](double X, double Y) -> Vector3 {
    return turn * Vector3(1.3 * X + 0.2 * Y, 0.4 * X + 0.8 * Y, 0) + Vector3(5, 6, 7);
  });
  for (int e = 0; e < mesh.n_elements(); ++e) {
    const Curvature c = compute_curvature(p, x, e, compute_surface_gradient(p, x, e));
    EXPECT_NEAR(c.k11, 0, 1e-13);
    EXPECT_NEAR(c.k22, 0, 1e-13);
    EXPECT_NEAR(c.k12, 0, 1e-13);
  }
}

TEST(ShellPatch, MirroredSideSeesTheCurvatureOfTheFullModel) {
  const TriangleMesh half = make_rectangle({0, 6}, {0, 3}, 1, 0, true);
  const ShellPatches p = make_shell_patches(half, 0);
  const NodalVectors x = map(half, [](double X, double Y) { return Vector3(X, Y, 0.5e-6 * Y * Y); });
  int compared = 0;
  for (int e = 0; e < half.n_elements(); ++e) {
    if (p.mirror_y.col(e).minCoeff() > 0) continue;
    bool other_sides_are_inner = true;
    for (int k = 0; k < 3; ++k) other_sides_are_inner &= half.neighbours(k, e) >= 0 || p.mirror_y(k, e) < 0;
    if (!other_sides_are_inner) continue;
    EXPECT_NEAR(compute_curvature(p, x, e, compute_surface_gradient(p, x, e)).k22, 1e-6, 1e-14);
    ++compared;
  }
  EXPECT_GE(compared, 4);
}

TEST(ShellPatch, ForcesAreTheGradientOfTheCurvature) {
  const TriangleMesh mesh = distort(make_rectangle({0, 4}, {0, 4}, 1, 0, true), 0.15, 2);
  const ShellPatches p = make_shell_patches(mesh, 0.25);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-0.2, 0.2);
  NodalVectors x = mesh.reference;
  for (int i = 0; i < x.size(); ++i) x.data()[i] += unit(random);
  const double m[3] = {0.7, -0.4, 0.3};
  for (int e = 0; e < mesh.n_elements(); ++e) {
    const auto energy = [&](const NodalVectors& y) {
      const Curvature c = compute_curvature(p, y, e, compute_surface_gradient(p, y, e));
      return p.area(e) * (m[0] * c.k11 + m[1] * c.k22 + 2 * m[2] * c.k12);
    };
    const SurfaceGradient g = compute_surface_gradient(p, x, e);
    double along[6];
    compute_bending_forces(p, e, compute_curvature(p, x, e, g), m[0], m[1], m[2], along);
    NodalVectors force = NodalVectors::Zero(3, mesh.n_nodes());
    for (int k = 0; k < 6; ++k) {
      Vector3 f = along[k] * g.t3;
      if (k >= 3) f.y() *= p.mirror_y(k - 3, e);
      add_at(force, p.nodes(k, e), f);
    }
    for (int k = 0; k < 6; ++k)
      for (int d = 0; d < 3; ++d) {
        const int node = p.nodes(k, e);
        NodalVectors forward = x, backward = x;
        forward(d, node) += 1e-6;
        backward(d, node) -= 1e-6;
        EXPECT_NEAR(force(d, node), (energy(forward) - energy(backward)) / 2e-6, 1e-8);
      }
  }
}

TEST(ShellPatch, ClockwiseElementIsRefused) {
  TriangleMesh mesh = make_rectangle({0, 1}, {0, 1}, 1);
  std::swap(mesh.triangles(0, 0), mesh.triangles(1, 0));
  EXPECT_THROW(make_shell_patches(mesh, 0), std::invalid_argument);
}

}  // namespace
