/// Meshes of flat sheets for verification: structured and unstructured.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "mechanics/mesh.hpp"

namespace interply::test {

enum class Pattern { Alternating, Unstructured };

inline std::string to_text(Pattern p) { return p == Pattern::Alternating ? "alternating" : "unstructured"; }
/// As GoogleTest names its parameters.
inline std::string to_name(const ::testing::TestParamInfo<Pattern>& p) {
  return p.param == Pattern::Alternating ? "Alternating" : "Unstructured";
}
/// "2.5 mm, unstructured"
inline std::string describe_mesh(double h, Pattern p) {
  std::ostringstream text;
  text << h << " mm, " << to_text(p);
  return text.str();
}

/// Swaps the diagonal of every pair of triangles that is not Delaunay until all are: some four to eight meet in a node.
inline void make_delaunay(mechanics::TriangleMesh& mesh) {
  const auto angle = [&](int at, int a, int b) {
    const Eigen::Vector2d u = (mesh.reference.col(a) - mesh.reference.col(at)).head(2);
    const Eigen::Vector2d v = (mesh.reference.col(b) - mesh.reference.col(at)).head(2);
    return std::acos(u.dot(v) / (u.norm() * v.norm()));
  };
  for (bool changed = true; changed;) {
    changed = false;
    mesh.neighbours = mechanics::find_neighbours(mesh.triangles, mesh.n_nodes());
    std::vector<bool> touched(static_cast<std::size_t>(mesh.n_elements()), false);
    for (int e = 0; e < mesh.n_elements(); ++e) {
      for (int k = 0; k < 3; ++k) {
        const int other = mesh.neighbours(k, e);
        if (other < 0 || touched[e] || touched[other]) continue;
        const int p = mesh.triangles(k, e), a = mesh.triangles((k + 1) % 3, e), b = mesh.triangles((k + 2) % 3, e);
        int q = 0;
        while (mesh.triangles(q, other) == a || mesh.triangles(q, other) == b) ++q;
        const int far = mesh.triangles(q, other);
        if (angle(p, a, b) + angle(far, a, b) <= std::numbers::pi + 1e-9) continue;
        mesh.triangles.col(e) << p, a, far;
        mesh.triangles.col(other) << p, far, b;
        touched[e] = touched[other] = changed = true;
      }
    }
  }
}

/// Rectangle with legs of h. Unstructured: nodes moved by up to 0.3 h (those of a side along it), then Delaunay; the
/// corners and the nodes for which `keep(X, Y)` stay. The same on every machine.
/// @param symmetric  hold the nodes at y = 0 in the plane y = 0
template <typename Keep>
mechanics::TriangleMesh make_sheet_mesh(Pattern pattern, std::array<double, 2> x, std::array<double, 2> y, double h,
                                        bool symmetric, Keep keep) {
  mechanics::TriangleMesh mesh = mechanics::make_rectangle(x, y, h, 0, symmetric);
  if (pattern != Pattern::Unstructured) return mesh;
  std::mt19937 random(2024);
  const auto offset = [&] { return 0.6 * h * (random() / 4294967295.0 - 0.5); };
  for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i) {
    const double dx = offset(), dy = offset(), at_x = mesh.reference(0, i), at_y = mesh.reference(1, i);
    const bool on_x = at_x == x[0] || at_x == x[1], on_y = at_y == y[0] || at_y == y[1];
    if (keep(at_x, at_y)) continue;
    if (!on_x) mesh.reference(0, i) += dx;
    if (!on_y) mesh.reference(1, i) += dy;
  }
  make_delaunay(mesh);
  return mesh;
}

inline mechanics::TriangleMesh make_sheet_mesh(Pattern pattern, std::array<double, 2> x, std::array<double, 2> y,
                                               double h, bool symmetric = false) {
  return make_sheet_mesh(pattern, x, y, h, symmetric, [](double, double) { return false; });
}

/// Makes every boundary side with both ends `where(X, Y)` keep its slope: a clamped edge, or a line of symmetry.
template <typename Where>
void clamp(mechanics::TriangleMesh& mesh, Where where) {
  for (int i = 0; i < mesh.n_nodes(); ++i)
    if (where(mesh.reference(0, i), mesh.reference(1, i))) mesh.clamped_nodes.push_back(i);
}

}  // namespace interply::test
