/// A linear elastic shell without a membrane: energy and forces of mechanics/edge_shell.hpp alone, and its meshes.
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <random>

#include "mechanics/edge_motion.hpp"

namespace interply::mechanics::test {

/// Moves every node inside a rectangular mesh at random by up to `amount` (mm) in each direction.
inline TriangleMesh distort(TriangleMesh mesh, double amount, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> move(-amount, amount);
  const Eigen::ArrayXXd r = mesh.reference;
  for (int d = 0; d < 2; ++d)
    for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i) {
      const double by = move(random);
      const bool inside = r(0, i) > r.row(0).minCoeff() && r(0, i) < r.row(0).maxCoeff() &&
                          r(1, i) > r.row(1).minCoeff() && r(1, i) < r.row(1).maxCoeff();
      if (inside) mesh.reference(d, i) += by;
    }
  return mesh;
}

/// A grid with all diagonals in one direction.
inline TriangleMesh make_one_way(std::array<double, 2> x, std::array<double, 2> y, double h, bool symmetric = false) {
  TriangleMesh mesh = make_rectangle(x, y, h, 0, symmetric);
  for (Eigen::Index e = 0; e < mesh.n_elements(); e += 2) {
    const auto lower = mesh.triangles.col(e), upper = mesh.triangles.col(e + 1);
    const int a = lower(0), b = lower(1), d = upper(2), c = upper(1) == lower(2) ? lower(2) : upper(1);
    const std::array<int, 3> first{a, b, c}, second{a, c, d};
    for (int k = 0; k < 3; ++k) {
      mesh.triangles(k, e) = first[k];
      mesh.triangles(k, e + 1) = second[k];
    }
  }
  mesh.neighbours = find_neighbours(mesh.triangles, mesh.n_nodes());
  return mesh;
}

/// The same rectangle at random: nodes moved by up to 0.3 h, then sides flipped at random wherever the two triangles
/// form a convex quadrangle, so that 4 to 8 triangles meet in a node.
inline TriangleMesh make_unstructured(std::array<double, 2> x, std::array<double, 2> y, double h, unsigned seed = 1) {
  TriangleMesh mesh = distort(make_rectangle(x, y, h), 0.3 * h, seed);
  std::mt19937 random(seed + 100);
  const auto cross = [&](int a, int b, int c) {
    return (at(mesh.reference, b) - at(mesh.reference, a)).cross(at(mesh.reference, c) - at(mesh.reference, a)).z();
  };
  for (int flips = 0; flips < static_cast<int>(mesh.n_elements()); ++flips) {
    const int e = static_cast<int>(random() % static_cast<unsigned>(mesh.n_elements())),
              k = static_cast<int>(random() % 3);
    const int other = mesh.neighbours(k, e);
    if (other < 0) continue;
    const int own = mesh.triangles(k, e), p = mesh.triangles((k + 1) % 3, e), q = mesh.triangles((k + 2) % 3, e);
    int far = 0;
    for (int j = 0; j < 3; ++j)
      if (mesh.triangles(j, other) != p && mesh.triangles(j, other) != q) far = mesh.triangles(j, other);
    if (cross(own, p, far) < 0.3 * h * h || cross(own, far, q) < 0.3 * h * h) continue;
    mesh.triangles.col(e) << own, p, far;
    mesh.triangles.col(other) << own, far, q;
    mesh.neighbours = find_neighbours(mesh.triangles, mesh.n_nodes());
  }
  return mesh;
}

/// x(X, Y) at every node.
template <typename F>
NodalVectors map(const TriangleMesh& mesh, const F& f) {
  NodalVectors x(3, mesh.n_nodes());
  for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i) {
    const Vector3 v = f(mesh.reference(0, i), mesh.reference(1, i));
    for (int d = 0; d < 3; ++d) x(d, i) = v(d);
  }
  return x;
}

inline Eigen::Matrix3d make_isotropic_stiffness(double bending, double poisson) {
  Eigen::Matrix3d d;
  d << 1, poisson, 0, poisson, 1, 0, 0, 0, 0.5 * (1 - poisson);
  return bending * d;
}

struct BendingSheet {
  TriangleMesh mesh;
  Eigen::Matrix3d stiffness;  ///< D over (k11, k22, 2 k12), N mm
  ShellGeometry shell;
  ShellPasses passes;
  // of the last evaluate()
  double energy = 0;           ///< mJ
  NodalVectors force;          ///< dE/dx, N
  Scalars torque;              ///< dE/dphi, N mm
  Eigen::Matrix3Xd curvature;  ///< k11, k22, k12 [3 x n_el]

  BendingSheet(const TriangleMesh& m, const Eigen::Matrix3d& d, double angle = 0)
      : mesh(m), stiffness(d), shell(make_shell_geometry(m, angle)), passes(shell) {}

  void evaluate(const NodalVectors& x, const Scalars& phi) {
    const Eigen::Index n = mesh.n_elements();
    for (Eigen::Index e = 0; e < n; ++e) passes.store_facet(e, compute_surface_gradient(shell, x, e));
    energy = 0;
    curvature.resize(3, n);
    for (Eigen::Index e = 0; e < n; ++e) {
      const Curvature c = compute_curvature(shell, passes, phi, e);
      curvature.col(e) << c.k11, c.k22, c.k12;
      const Eigen::Vector3d k(c.k11, c.k22, 2 * c.k12), m = stiffness * k;
      energy += 0.5 * shell.area(e) * m.dot(k);
      store_moments(shell, c, m(0), m(1), m(2), e, passes);
    }
    finish();
  }
  /// Forces of given moments, whatever the curvature.
  void apply_moments(const NodalVectors& x, const Scalars& phi, double m11, double m22, double m12) {
    evaluate(x, phi);
    for (Eigen::Index e = 0; e < mesh.n_elements(); ++e)
      store_moments(shell, compute_curvature(shell, passes, phi, e), m11, m22, m12, e, passes);
    finish();
  }
  Scalars zero_angles() const { return Scalars::Zero(shell.n_edges()); }
  bool is_mirrored(Eigen::Index edge) const { return !shell.mirror.col(edge).isZero(0); }
  bool is_free(Eigen::Index edge) const { return shell.edge_sides(1, edge) < 0 && !is_mirrored(edge); }

 private:
  void finish() {
    NodalVectors slots = NodalVectors::Zero(3, 3 * mesh.n_elements());
    for (Eigen::Index e = 0; e < mesh.n_elements(); ++e) add_bending_forces(shell, passes, e, slots);
    force.resize(3, mesh.n_nodes());
    gather_forces(shell.gather, slots, 0, mesh.n_nodes(), force);
    torque.resize(shell.n_edges());
    for (Eigen::Index i = 0; i < shell.n_edges(); ++i) torque(i) = -compute_edge_torque(shell, passes, i);
  }
};

}  // namespace interply::mechanics::test
