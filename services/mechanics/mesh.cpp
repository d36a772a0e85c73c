#include "mechanics/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace interply::mechanics {

namespace {

int count_cells(double length, double h) { return std::max(1, static_cast<int>(std::lround(length / h))); }

/// Nodes at every x and y, x fastest.
/// @param first  0: the diagonal of the first cell starts at its corner (x[0], y[0]); 1: at the next one
TriangleMesh make_grid(const std::vector<double>& x, const std::vector<double>& y, double z, bool symmetric,
                       int first) {
  const int nx = static_cast<int>(x.size()) - 1, ny = static_cast<int>(y.size()) - 1;
  TriangleMesh mesh;
  mesh.reference.resize(3, (nx + 1) * (ny + 1));
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) {
      const int node = j * (nx + 1) + i;
      mesh.reference(0, node) = x[static_cast<std::size_t>(i)];
      mesh.reference(1, node) = y[static_cast<std::size_t>(j)];
      mesh.reference(2, node) = z;
      if (symmetric && j == 0) mesh.symmetry_nodes.push_back(node);
    }
  }
  mesh.triangles.resize(3, 2 * nx * ny);
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const int a = j * (nx + 1) + i, b = a + 1, c = a + nx + 2, d = a + nx + 1;
      const int e = 2 * (j * nx + i);
      if ((i + j + first) % 2 == 0) {  // diagonal a-c
        mesh.triangles.col(e) << a, b, c;
        mesh.triangles.col(e + 1) << a, c, d;
      } else {  // diagonal b-d
        mesh.triangles.col(e) << a, b, d;
        mesh.triangles.col(e + 1) << b, c, d;
      }
    }
  }
  mesh.neighbours = find_neighbours(mesh.triangles, mesh.n_nodes());
  return mesh;
}

/// n + 1 coordinates from `from` to `to`.
std::vector<double> divide(double from, double to, int n) {
  std::vector<double> at;
  for (int i = 0; i <= n; ++i) at.push_back(from + (to - from) * i / n);
  return at;
}

/// Coordinates of n cells to either side of 0, or to the right only: each the exact negative of its mirror image.
std::vector<double> divide_from_centre(double half_length, int n, bool only_right) {
  std::vector<double> at;
  for (int i = only_right ? 0 : -n; i <= n; ++i) at.push_back(half_length * i / n);
  return at;
}

/// Diagonal of the box around the points, mm.
double compute_size(const std::vector<std::array<double, 2>>& points) {
  double low[2] = {0, 0}, high[2] = {0, 0};
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t d = 0; d < 2; ++d) {
      low[d] = i == 0 ? points[i][d] : std::min(low[d], points[i][d]);
      high[d] = i == 0 ? points[i][d] : std::max(high[d], points[i][d]);
    }
  return std::hypot(high[0] - low[0], high[1] - low[1]);
}

std::string to_text(const std::array<double, 2>& point) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "(%.6g, %.6g) mm", point[0], point[1]);
  return buffer;
}

}  // namespace

int count_cells_from_centre(double side, double h) { return count_cells(0.5 * side, h); }

TriangleMesh make_blank(double length, double width, double h, double z, bool half, Diagonals diagonals) {
  const int nx = count_cells_from_centre(length, h), ny = count_cells_from_centre(width, h);
  const int cells_before_centre = nx + (half ? 0 : ny);
  return make_grid(divide_from_centre(0.5 * length, nx, false), divide_from_centre(0.5 * width, ny, half), z, half,
                   (cells_before_centre + (diagonals == Diagonals::Around ? 1 : 0)) % 2);
}

TriangleMesh make_rectangle(std::array<double, 2> x, std::array<double, 2> y, double h, double z, bool symmetric) {
  return make_grid(divide(x[0], x[1], count_cells(x[1] - x[0], h)), divide(y[0], y[1], count_cells(y[1] - y[0], h)), z,
                   symmetric, 0);
}

TriangleMesh make_mesh(const std::vector<std::array<double, 2>>& points,
                       const std::vector<std::array<int, 3>>& triangles, double z, bool half) {
  const double on_plane = 1e-6 * compute_size(points);
  TriangleMesh mesh;
  mesh.reference.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto node = static_cast<int>(i);
    const bool held = half && std::abs(points[i][1]) <= on_plane;
    if (half && points[i][1] < -on_plane)
      throw std::invalid_argument("the node at " + to_text(points[i]) +
                                  " lies at y < 0; a half model holds y >= 0 only: cut the mesh at y = 0, or take the "
                                  "whole blank with symmetry: full");
    mesh.reference(0, node) = points[i][0];
    mesh.reference(1, node) = held ? 0.0 : points[i][1];
    mesh.reference(2, node) = z;
    if (held) mesh.symmetry_nodes.push_back(node);
  }
  if (half && mesh.symmetry_nodes.size() < 2)
    throw std::invalid_argument(
        "the mesh does not reach y = 0, the symmetry plane of a half model; move the mesh, "
        "or take the whole blank with symmetry: full");
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t e = 0; e < triangles.size(); ++e)
    for (std::size_t k = 0; k < 3; ++k)
      mesh.triangles(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(e)) = triangles[e][k];
  mesh.neighbours = find_neighbours(mesh.triangles, mesh.n_nodes());
  return mesh;
}

Triangles find_neighbours(const Triangles& triangles, Eigen::Index n_nodes) {
  const int n = static_cast<int>(triangles.cols());
  const auto side_of = [&](int e, int k) -> std::pair<int, int> {
    return std::minmax(triangles((k + 1) % 3, e), triangles((k + 2) % 3, e));
  };
  struct Side {
    int upper, element, corner;  ///< the other node; corner opposite the side
  };
  std::vector<std::size_t> start(static_cast<std::size_t>(n_nodes) + 1, 0);  // of the sides of each lower node
  for (int e = 0; e < n; ++e)
    for (int k = 0; k < 3; ++k) {
      const auto [lower, upper] = side_of(e, k);
      if (lower < 0 || upper >= n_nodes || lower == upper)
        throw std::invalid_argument("element " + std::to_string(e) + " has corners outside the mesh or twice the same");
      ++start[static_cast<std::size_t>(lower) + 1];
    }
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Side> sides(start.back());
  std::vector<std::size_t> end = start;
  Triangles neighbours = Triangles::Constant(3, n, -1);
  for (int e = 0; e < n; ++e)
    for (int k = 0; k < 3; ++k) {
      const auto [lower, upper] = side_of(e, k);
      const auto node = static_cast<std::size_t>(lower);
      const auto first = sides.begin() + static_cast<std::ptrdiff_t>(start[node]);
      const auto last = sides.begin() + static_cast<std::ptrdiff_t>(end[node]);
      const auto other = std::find_if(first, last, [&](const Side& s) { return s.upper == upper; });
      if (other == last) {
        sides[end[node]++] = {upper, e, k};
        continue;
      }
      if (neighbours(other->corner, other->element) != -1)
        throw std::invalid_argument("the side between nodes " + std::to_string(lower) + " and " +
                                    std::to_string(upper) + " belongs to three elements");
      neighbours(k, e) = other->element;
      neighbours(other->corner, other->element) = e;
    }
  return neighbours;
}

Scalars compute_areas(const TriangleMesh& mesh) {
  Scalars areas(mesh.n_elements());
  for (Eigen::Index e = 0; e < mesh.n_elements(); ++e) {
    const auto corner = [&](int k) { return at(mesh.reference, mesh.triangles(k, e)); };
    areas(e) = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).z();
  }
  return areas;
}

Scalars compute_tributary_areas(const TriangleMesh& mesh) {
  const Scalars areas = compute_areas(mesh);
  Scalars tributary = Scalars::Zero(mesh.n_nodes());
  for (Eigen::Index e = 0; e < mesh.n_elements(); ++e)
    for (int k = 0; k < 3; ++k) tributary(mesh.triangles(k, e)) += areas(e) / 3;
  return tributary;
}

Scalars compute_lumped_mass(const TriangleMesh& mesh, double thickness, double density) {
  return density * thickness * compute_tributary_areas(mesh);
}

Incidence make_incidence(const int* nodes, int slots, Eigen::Index n_elements, Eigen::Index n_nodes) {
  Incidence incidence;
  incidence.start.assign(static_cast<std::size_t>(n_nodes) + 1, 0);
  const Eigen::Index total = slots * n_elements;
  for (Eigen::Index i = 0; i < total; ++i)
    if (nodes[i] >= 0) ++incidence.start[static_cast<std::size_t>(nodes[i]) + 1];
  for (Eigen::Index n = 0; n < n_nodes; ++n) incidence.start[n + 1] += incidence.start[n];
  incidence.entry.resize(static_cast<std::size_t>(incidence.start.back()));
  std::vector<int> next(incidence.start.begin(), incidence.start.end() - 1);
  for (Eigen::Index e = 0; e < n_elements; ++e)  // elements ascending within each node
    for (int s = 0; s < slots; ++s) {
      const Eigen::Index i = s * n_elements + e;
      if (nodes[i] >= 0) incidence.entry[static_cast<std::size_t>(next[nodes[i]]++)] = static_cast<int>(i);
    }
  return incidence;
}

void gather_forces(const Incidence& incidence, const NodalVectors& slot_force, Eigen::Index begin, Eigen::Index end,
                   NodalVectors& force) {
  for (Eigen::Index i = begin; i < end; ++i) {
    Vector3 sum = Vector3::Zero();
    const auto node = static_cast<std::size_t>(i);
    for (int k = incidence.start[node]; k < incidence.start[node + 1]; ++k)
      sum += at(slot_force, incidence.entry[static_cast<std::size_t>(k)]);
    for (int d = 0; d < 3; ++d) force(d, i) = sum(d);
  }
}

}  // namespace interply::mechanics
