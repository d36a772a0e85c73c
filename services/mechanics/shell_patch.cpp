#include "mechanics/shell_patch.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace interply::mechanics {

namespace {

using Corners = std::array<Vector2, 3>;

/// dN_k/dX_a of a flat triangle, one row per corner.
Eigen::Matrix<double, 3, 2> compute_shape_gradients(const Corners& c) {
  Eigen::Matrix<double, 3, 2> g;
  const double twice_area = (c[1] - c[0]).x() * (c[2] - c[0]).y() - (c[1] - c[0]).y() * (c[2] - c[0]).x();
  for (int k = 0; k < 3; ++k) {
    const Vector2 side = c[(k + 2) % 3] - c[(k + 1) % 3];
    g(k, 0) = -side.y() / twice_area;
    g(k, 1) = side.x() / twice_area;
  }
  return g;
}

}  // namespace

ShellPatches make_shell_patches(const TriangleMesh& mesh, double angle) {
  const Eigen::Index n = mesh.n_elements();
  ShellPatches p;
  p.nodes.resize(6, n);
  p.mirror_y = decltype(p.mirror_y)::Ones(3, n);
  p.gradient.resize(6, n);
  p.side_gradient = decltype(p.side_gradient)::Zero(18, n);
  p.area = compute_areas(mesh);
  std::vector<bool> in_symmetry(static_cast<std::size_t>(mesh.n_nodes()), false);
  for (const int i : mesh.symmetry_nodes) in_symmetry[static_cast<std::size_t>(i)] = true;

  Matrix2 to_frame;
  to_frame << std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle);
  const auto flat = [&](int node, double mirror) -> Vector2 {
    return to_frame * Vector2(mesh.reference(0, node), mirror * mesh.reference(1, node));
  };

  for (Eigen::Index e = 0; e < n; ++e) {
    if (!(p.area(e) > 0))
      throw std::invalid_argument("element " + std::to_string(e) +
                                  " has no area or clockwise corners; number its corners counter-clockwise");
    std::array<int, 3> own{};
    for (int k = 0; k < 3; ++k) own[k] = p.nodes(k, e) = mesh.triangles(k, e);
    const auto own_gradient = compute_shape_gradients({flat(own[0], 1), flat(own[1], 1), flat(own[2], 1)});
    for (int k = 0; k < 3; ++k)
      for (int a = 0; a < 2; ++a) p.gradient(2 * k + a, e) = own_gradient(k, a);

    for (int k = 0; k < 3; ++k) {
      const int first = own[(k + 1) % 3], second = own[(k + 2) % 3];
      const int neighbour = mesh.neighbours(k, e);
      int far = own[k];
      bool free = false;
      if (neighbour >= 0) {
        for (int m = 0; m < 3; ++m) {
          const int corner = mesh.triangles(m, neighbour);
          if (corner != first && corner != second) far = corner;
        }
      } else if (in_symmetry[static_cast<std::size_t>(first)] && in_symmetry[static_cast<std::size_t>(second)]) {
        p.mirror_y(k, e) = -1;  // the neighbour is the own mirror image
      } else {
        free = true;
      }
      p.nodes(3 + k, e) = far;
      if (free) continue;
      const auto g = compute_shape_gradients({flat(first, 1), flat(second, 1), flat(far, p.mirror_y(k, e))});
      for (int m = 0; m < 3; ++m)
        for (int a = 0; a < 2; ++a) p.side_gradient(6 * k + 2 * m + a, e) = g(m, a);
    }
  }
  p.gather = make_incidence(p.nodes.data(), 6, n, mesh.n_nodes());
  return p;
}

Curvature compute_curvature(const ShellPatches& p, const NodalVectors& x, Eigen::Index e, const SurfaceGradient& g) {
  // dual vectors of f1, f2 in the tangent plane
  const double inv_j = 1 / g.area_ratio;
  const Vector3 dual1 = g.f2.cross(g.t3) * inv_j;
  const Vector3 dual2 = g.t3.cross(g.f1) * inv_j;
  Curvature c;
  double k21 = 0;
  for (int side = 0; side < 3; ++side) {
    Vector3 phi[2] = {Vector3::Zero(), Vector3::Zero()};
    const Vector3 first = at(x, p.nodes((side + 1) % 3, e)), second = at(x, p.nodes((side + 2) % 3, e));
    Vector3 far = at(x, p.nodes(3 + side, e));
    far.y() *= p.mirror_y(side, e);
    for (int b = 0; b < 2; ++b) {
      phi[b] = p.side_gradient(6 * side + b, e) * first + p.side_gradient(6 * side + 2 + b, e) * second +
               p.side_gradient(6 * side + 4 + b, e) * far;
      c.rho[side](b, 0) = phi[b].dot(dual1);
      c.rho[side](b, 1) = phi[b].dot(dual2);
    }
    const double l1 = -p.gradient(2 * side, e), l2 = -p.gradient(2 * side + 1, e);
    const double z1 = phi[0].dot(g.t3), z2 = phi[1].dot(g.t3);
    c.k11 += l1 * z1;  // (B1)
    c.k22 += l2 * z2;
    c.k12 += l1 * z2;
    k21 += l2 * z1;
  }
  c.k12 = 0.5 * (c.k12 + k21);
  return c;
}

void compute_bending_forces(const ShellPatches& p, Eigen::Index e, const Curvature& k, double m11, double m22,
                            double m12, double along_t3[6]) {
  double f[6] = {};
  const double area = p.area(e);
  for (int side = 0; side < 3; ++side) {
    const double l1 = -p.gradient(2 * side, e), l2 = -p.gradient(2 * side + 1, e);
    // work per unit of (phi^I_,b . t3): -area * m_ab L^I_a
    const double w[2] = {area * (m11 * l1 + m12 * l2), area * (m12 * l1 + m22 * l2)};
    for (int b = 0; b < 2; ++b) {
      f[(side + 1) % 3] += w[b] * p.side_gradient(6 * side + b, e);
      f[(side + 2) % 3] += w[b] * p.side_gradient(6 * side + 2 + b, e);
      f[3 + side] += w[b] * p.side_gradient(6 * side + 4 + b, e);
      // the own normal turns with the own gradients: delta t3 = -sum_c dual_c (delta f_c . t3)
      for (int c = 0; c < 2; ++c)
        for (int node = 0; node < 3; ++node) f[node] -= w[b] * k.rho[side](b, c) * p.gradient(2 * node + c, e);
    }
  }
  for (int i = 0; i < 6; ++i) along_t3[i] = f[i];
}

Scalars compute_curvature_operator_norms(const ShellPatches& p) {
  Scalars norms(p.n_elements());
  Curvature flat;
  for (int side = 0; side < 3; ++side) flat.rho[side].setIdentity();
  for (Eigen::Index e = 0; e < p.n_elements(); ++e) {
    Curvature own = flat;
    for (int side = 0; side < 3; ++side)  // a free side contributes nothing, not the identity
      if (p.side_gradient.block(6 * side, e, 6, 1).isZero(0)) own.rho[side].setZero();
    double sum = 0;
    const double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int c = 0; c < 3; ++c) {
      double f[6];
      compute_bending_forces(p, e, own, unit[c][0], unit[c][1], unit[c][2], f);
      double square = 0;
      for (const double v : f) square += v * v;
      // m12 works on 2 k12, so its force is 2 dk12; dk12^2 counts twice in the norm
      sum += (c == 2 ? 0.5 : 1.0) * square;
    }
    norms(e) = sum / (p.area(e) * p.area(e));
  }
  return norms;
}

}  // namespace interply::mechanics
