#include "mechanics/edge_shell.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace interply::mechanics {

namespace {

/// dN_k/dX_a of all triangles in the frame turned by `angle`.
void compute_shape_gradients(const TriangleMesh& mesh, double angle, ShellGeometry& s) {
  Matrix2 to_frame;
  to_frame << std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle);
  for (Eigen::Index e = 0; e < s.n_elements(); ++e)
    for (int k = 0; k < 3; ++k) {
      const Vector3 edge = at(mesh.reference, s.nodes((k + 2) % 3, e)) - at(mesh.reference, s.nodes((k + 1) % 3, e));
      const Vector2 along = to_frame * edge.head<2>();
      s.gradient(2 * k, e) = -along.y() / (2 * s.area(e));
      s.gradient(2 * k + 1, e) = along.x() / (2 * s.area(e));
    }
}

/// Numbers the edges in the order of the elements that see them first.
void number_edges(const TriangleMesh& mesh, ShellGeometry& s) {
  const Eigen::Index n = s.n_elements();
  const auto mark = [&](const std::vector<int>& list) {
    std::vector<bool> marked(static_cast<std::size_t>(mesh.n_nodes()), false);
    for (const int i : list) marked[static_cast<std::size_t>(i)] = true;
    return marked;
  };
  const std::vector<bool> symmetry = mark(mesh.symmetry_nodes), clamped = mark(mesh.clamped_nodes);
  s.edge_sides = decltype(s.edge_sides)::Constant(2, 3 * n, -1);
  s.mirror = decltype(s.mirror)::Zero(2, 3 * n);
  int count = 0;
  for (Eigen::Index e = 0; e < n; ++e)
    for (int k = 0; k < 3; ++k) {
      const int own = static_cast<int>(k * n + e), other = mesh.neighbours(k, e);
      if (other >= 0 && other < e) {  // numbered before
        int j = 0;
        while (mesh.neighbours(j, other) != e) ++j;
        s.edge(k, e) = s.edge(j, other);
        s.edge_sides(1, s.edge(k, e)) = own;
        s.side(k, e) = -1;
        continue;
      }
      s.edge(k, e) = count;
      s.edge_sides(0, count) = own;
      s.side(k, e) = 1;
      const int first = s.nodes((k + 1) % 3, e), second = s.nodes((k + 2) % 3, e);
      const auto both = [&](const std::vector<bool>& marked) {
        return marked[static_cast<std::size_t>(first)] && marked[static_cast<std::size_t>(second)];
      };
      if (other < 0 && (both(symmetry) || both(clamped))) {
        const Vector3 edge = at(mesh.reference, second) - at(mesh.reference, first);
        s.mirror.col(count) = Vector2(edge.y(), -edge.x()).normalized();
        s.side(k, e) = 0;
        s.neighbour(k, e) = static_cast<int>(e);
      }
      ++count;
    }
  s.edge_sides.conservativeResize(2, count);
  s.mirror.conservativeResize(2, count);
}

/// Free and mirrored sides.
void mark_sides(ShellGeometry& s) {
  const Eigen::Index n = s.n_elements();
  s.hinged = (s.neighbour >= 0).cast<signed char>();
  for (Eigen::Index e = 0; e < n; ++e)
    for (int k = 0; k < 3; ++k)
      if (s.neighbour(k, e) == e) s.images.push_back(static_cast<int>(k * n + e));
  s.image_plane.resize(2, static_cast<Eigen::Index>(s.images.size()));
  for (std::size_t i = 0; i < s.images.size(); ++i)
    s.image_plane.col(static_cast<Eigen::Index>(i)) = s.mirror.col(s.edge(s.images[i] / n, s.images[i] % n));
}

/// Vectors along the three edges, from corner k + 1 to k + 2. 2 A (N_k,2 f1 - N_k,1 f2)
void compute_edge_vectors(const ShellGeometry& s, const SurfaceGradient& g, Eigen::Index e, Vector3 edge[3]) {
  for (int k = 0; k < 3; ++k) edge[k] = 2 * s.area(e) * (s.gradient(2 * k + 1, e) * g.f1 - s.gradient(2 * k, e) * g.f2);
}

}  // namespace

ShellGeometry make_shell_geometry(const TriangleMesh& mesh, double angle) {
  const Eigen::Index n = mesh.n_elements();
  ShellGeometry s;
  s.area = compute_areas(mesh);
  for (Eigen::Index e = 0; e < n; ++e)
    if (!(s.area(e) > 0))
      throw std::invalid_argument("element " + std::to_string(e) +
                                  " has no area or clockwise corners; number its corners counter-clockwise");
  s.nodes = mesh.triangles;
  s.neighbour = mesh.neighbours;
  s.gradient.resize(6, n);
  s.edge.resize(3, n);
  s.side.resize(3, n);
  compute_shape_gradients(mesh, angle, s);
  number_edges(mesh, s);
  mark_sides(s);
  s.gather = make_incidence(s.nodes.data(), 3, n, mesh.n_nodes());
  return s;
}

ShellPasses::ShellPasses(const ShellGeometry& shell, const Rings& r)
    : rings(r),
      f1(3, rings.facets.stride),
      f2(3, rings.facets.stride),
      t3(3, rings.facets.stride + static_cast<Eigen::Index>(shell.images.size())),
      area_ratio(rings.facets.stride),
      membrane(NodalVectors::Zero(3, rings.facets.stride)),
      slope_moment(Scalars::Zero(3 * rings.moments.stride + 1)),
      hinge_factor(Scalars::Zero(3 * rings.moments.stride)),
      height_force(Scalars::Zero(3 * rings.moments.stride)),
      corner_force(NodalVectors::Zero(3, 3 * rings.corners.stride)),
      across(3, shell.n_elements()),
      opposite(3, shell.n_elements()) {
  const Eigen::Index n = shell.n_elements();
  const auto find = [n](Eigen::Index side, const Ring& ring) {
    return static_cast<int>(side / n * ring.stride + side % n % ring.size);
  };
  for (Eigen::Index e = 0; e < n; ++e)
    for (int k = 0; k < 3; ++k) {
      const int other = shell.find_opposite(k, e);
      across(k, e) = static_cast<int>((other < 0 ? e : shell.neighbour(k, e)) % rings.facets.size);
      opposite(k, e) = find(other < 0 ? k * n + e : other, rings.moments);
    }
  for (const int side : shell.images) {
    across(side / n, side % n) = static_cast<int>(rings.facets.stride + static_cast<Eigen::Index>(image_facet.size()));
    image_facet.push_back(static_cast<int>(side % n % rings.facets.size));
  }
  for (Eigen::Index i = 0; i < shell.n_edges(); ++i) {
    first_side.push_back(find(shell.edge_sides(0, i), rings.moments));
    const int beyond = shell.edge_sides(1, i);
    second_side.push_back(beyond < 0 ? static_cast<int>(3 * rings.moments.stride) : find(beyond, rings.moments));
  }
  for (const int corner : shell.gather.entry) gather_entry.push_back(find(corner, rings.corners));
}

void ShellPasses::store_facet(Eigen::Index e, const SurfaceGradient& g) {
  for (int c = 0; c < 3; ++c) {
    f1(c, e) = g.f1(c);
    f2(c, e) = g.f2(c);
    t3(c, e) = g.t3(c);
  }
  area_ratio(e) = g.area_ratio;
}

Curvature compute_curvature(const ShellGeometry& s, const ShellPasses& passes, const Scalars& phi, Eigen::Index e) {
  const SurfaceGradient g = passes.facet(e);
  Vector3 edge[3];
  compute_edge_vectors(s, g, e, edge);
  Curvature c;
  for (int k = 0; k < 3; ++k) {
    const double per_length = 1 / edge[k].norm();
    c.height[k] = 2 * s.area(e) * g.area_ratio * per_length;
    c.slope[k] = s.side(k, e) * phi(s.edge(k, e));
    if (const int across = s.neighbour(k, e); across >= 0) {
      Vector3 normal = at(passes.t3, across);
      if (across == e) {
        const auto plane = s.mirror.col(s.edge(k, e));
        const double twice = 2 * (plane(0) * normal.x() + plane(1) * normal.y());
        normal.x() -= twice * plane(0);
        normal.y() -= twice * plane(1);
      }
      const double cosine = std::sqrt(0.5 * (1 + g.t3.dot(normal)));  // of theta/2
      const double sine = edge[k].dot(normal.cross(g.t3)) * per_length;
      c.slope[k] += 0.5 * sine / cosine;  // (B1), (B2)
      c.hinge_factor[k] = 0.5 * cosine;
    }
    const double n1 = s.gradient(2 * k, e), n2 = s.gradient(2 * k + 1, e), a = 2 * c.height[k] * c.slope[k];
    c.k11 += a * n1 * n1;  // (B3)
    c.k22 += a * n2 * n2;
    c.k12 += a * n1 * n2;
  }
  return c;
}

void store_moments(const ShellGeometry& s, const Curvature& c, double m11, double m22, double m12, Eigen::Index e,
                   ShellPasses& passes) {
  for (int k = 0; k < 3; ++k) {
    const double n1 = s.gradient(2 * k, e), n2 = s.gradient(2 * k + 1, e);
    const double q = s.area(e) * (m11 * n1 * n1 + m22 * n2 * n2 + 2 * m12 * n1 * n2);  // (B4)
    const Eigen::Index side = k * s.n_elements() + e;
    passes.slope_moment(side) = 2 * c.height[k] * q;
    passes.height_force(side) = 2 * c.slope[k] * q;
    passes.hinge_factor(side) = c.hinge_factor[k];
  }
}

void add_bending_forces(const ShellGeometry& s, const ShellPasses& passes, Eigen::Index e, NodalVectors& slot_force) {
  const SurfaceGradient g = passes.facet(e);
  Vector3 edge[3];
  compute_edge_vectors(s, g, e, edge);
  Vector3 force[3] = {Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Eigen::Index side = k * s.n_elements() + e;
    const int opposite = s.find_opposite(k, e);
    double hinge = 0;
    if (opposite >= 0)
      hinge = passes.hinge_factor(side) * (passes.slope_moment(side) + passes.slope_moment(opposite));  // (B5)
    const double length2 = edge[k].squaredNorm(), length = std::sqrt(length2);
    const double per_height = length / (2 * s.area(e) * g.area_ratio);
    const Vector3 outward = edge[k].cross(g.t3) / length;
    const Vector3 b = hinge * per_height * g.t3 - passes.height_force(side) * outward;  // (B6)
    const double at_i = -edge[i].dot(edge[k]) / length2;                                // lever rule
    force[k] += b;
    force[i] -= at_i * b;
    force[j] -= (1 - at_i) * b;
  }
  for (int k = 0; k < 3; ++k) add_at(slot_force, k * s.n_elements() + e, force[k]);
}

}  // namespace interply::mechanics
