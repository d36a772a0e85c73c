/// Shell triangle with one rotation per edge, shared by both solvers: the Morley triangle with large rotations.
///
/// Sources: Morley, Aeronaut. Q. 19 (1968), J. Strain Anal. 6 (1971): constant curvature from the slopes at the middle
/// of the sides; Grinspun, Gingold, Reisman & Zorin, Comput. Graph. Forum 25 (2006): the same as a shape operator of
/// facets and mid-edge normals. Beside its nodes every edge carries phi, the rotation of its normal about the edge
/// relative to the bisector of its two facets. With theta the angle between the facets (> 0 where the surface bends
/// towards +t3), s = +1 for the first and -1 for the second element of an edge, h_k the current height of the triangle
/// over the edge opposite corner k and N_k,a = dN_k/dX_a,
///
///   psi = 2 sin(theta/2) = sin(theta) / cos(theta/2)                                                     (B1)
///   alpha_k = psi/2 + s phi                                                                              (B2)
///   kappa_ab = sum_k 2 h_k alpha_k N_k,a N_k,b                                                           (B3)
///
/// alpha_k is the slope of the middle of edge k against the own facet; psi makes polygons inscribed in a circle exact.
/// kappa > 0 where the surface bends towards +t3 (kappa_ab = x_,ab . t3); rigid motion leaves it alone. Free edge: no
/// facet across, alpha = phi. Symmetry edge (and a clamped one): the facet across is the own mirror image, phi = 0. All
/// gradients refer to an in-plane reference frame turned by `angle` from x (the fibre frame of a ply).
///
/// The forces are the exact gradient of the bending energy. With the moments m = dW/dkappa per reference area A,
///
///   q_k = A m_ab N_k,a N_k,b,    P_k = dW/dalpha_k = 2 h_k q_k                                           (B4)
///   Q = dW/dtheta = 1/2 cos(theta/2) sum P over the two elements,    dW/dphi = sum s P                   (B5)
///   B_k = Q/h_k t3 - 2 alpha_k q_k m_k                                                                   (B6)
///
/// (m_k the outward normal of the edge in the facet): corner k of an element gets B_k, the ends of the edge share -B_k
/// by the lever rule about the foot of corner k. So an element loads its own three nodes only.
///
/// Where we differ: phi is integrated in time with an inertia of its own (edge_motion.hpp), not eliminated.
#pragma once

#include <cmath>
#include <vector>

#include "mechanics/mesh.hpp"
#include "mechanics/shell_rows.hpp"

namespace interply::mechanics {

/// Small numbers of the sides of elements.
using Signs = Eigen::Array<signed char, 3, Eigen::Dynamic, Eigen::RowMajor>;

/// Reference geometry and connectivity; rows over constants, elements innermost.
struct ShellGeometry {
  Triangles nodes;  ///< corners                                                                    [3 x n_el]
  /// dN_k/dX_a, row 2k + a. [6 x n_el] 1/mm
  Eigen::Array<double, 6, Eigen::Dynamic, Eigen::RowMajor> gradient;
  Scalars area;             ///< A, reference                                                           [n_el] mm2
  Triangles neighbour;      ///< element across edge k; itself where mirrored, -1 where free            [3 x n_el]
  Signs hinged;             ///< 1, or 0 at a free edge                                                 [3 x n_el]
  std::vector<int> images;  ///< sides with a mirror image, by element
  /// Normal of the mirror plane of each image, x and y. [2 x images]
  Eigen::Array<double, 2, Eigen::Dynamic, Eigen::RowMajor> image_plane;
  Triangles edge;  ///< number of edge k                                                       [3 x n_el]
  Signs side;      ///< s of (B2): 1, -1, or 0 where mirrored                                  [3 x n_el]
  /// Sides k * n_el + e of the first and second element of an edge; -1: no second. [2 x n_edges]
  Eigen::Array<int, 2, Eigen::Dynamic, Eigen::RowMajor> edge_sides;
  /// Unit normal of the vertical plane of a mirrored edge, x and y; 0 at the others. [2 x n_edges]
  Eigen::Array<double, 2, Eigen::Dynamic, Eigen::RowMajor> mirror;
  Incidence gather;  ///< over 3 slots per element

  Eigen::Index n_elements() const { return area.size(); }
  Eigen::Index n_edges() const { return edge_sides.cols(); }
  /// The same edge as seen from the other side of it, for `side` k * n_el + e: itself where mirrored, -1 where free.
  int find_opposite(int k, Eigen::Index e) const {
    if (neighbour(k, e) < 0) return -1;
    const int own = static_cast<int>(k * n_elements() + e), i = edge(k, e);
    if (edge_sides(1, i) < 0) return own;
    return edge_sides(0, i) == own ? edge_sides(1, i) : edge_sides(0, i);
  }
};

/// @param angle  direction of the frame's first axis from x, rad
/// @throws std::invalid_argument for an element without area or with clockwise corners
ShellGeometry make_shell_geometry(const TriangleMesh& mesh, double angle);

/// Height of the triangle over edge k in the reference, mm.
inline double compute_reference_height(const ShellGeometry& s, int k, Eigen::Index e) {
  return 1 / std::hypot(s.gradient(2 * k, e), s.gradient(2 * k + 1, e));
}

/// Deformation of one triangle: columns of F and its unit normal.
struct SurfaceGradient {
  Vector3 f1, f2;         ///< F e1, F e2
  Vector3 t3;             ///< unit normal f1 x f2 / |f1 x f2|
  double area_ratio = 0;  ///< J = |f1 x f2|
};

/// F = sum_k x_k (x) dN_k of element `e`.
inline SurfaceGradient compute_surface_gradient(const ShellGeometry& s, const NodalVectors& x, Eigen::Index e) {
  SurfaceGradient g{Vector3::Zero(), Vector3::Zero(), Vector3::Zero(), 0};
  for (int k = 0; k < 3; ++k) {
    const Vector3 xk = at(x, s.nodes(k, e));
    g.f1 += s.gradient(2 * k, e) * xk;
    g.f2 += s.gradient(2 * k + 1, e) * xk;
  }
  const Vector3 n = g.f1.cross(g.f2);
  g.area_ratio = n.norm();
  g.t3 = n / g.area_ratio;
  return g;
}

/// Columns of what one pass hands to the next: element e lies in column e % size, of rows that are `stride` long.
struct Ring {
  Eigen::Index size, stride;
};
struct Rings {
  Ring facets, moments, corners;
};
inline Rings make_whole_rings(Eigen::Index n_elements) {
  const Ring all{n_elements, n_elements};
  return {all, all, all};
}

/// What the elements of a shell tell each other within one evaluation: three passes over the elements (1: facet, 2:
/// curvature and moments, 3: forces), each complete in an element and its neighbours before the next.
///
/// Passes that trail each other closely need only rings of a few elements, which stay in the cache (solve/trail.hpp):
/// element e lies in column e % size, its side k in column k * stride + e % size. The kernels of shell_passes.hpp find
/// their neighbours there. The functions on single elements below want rings of all elements, where that is e.
struct ShellPasses {
  explicit ShellPasses(const ShellGeometry& shell) : ShellPasses(shell, make_whole_rings(shell.n_elements())) {}
  ShellPasses(const ShellGeometry& shell, const Rings& rings);

  Rings rings;
  // ring of facets; n: its stride
  NodalVectors f1, f2;  ///< 1: SurfaceGradient                                            [3 x n]
  NodalVectors t3;      ///< 1, and behind the ring the mirror images of facets         [3 x n + images]
  Scalars area_ratio;   ///< 1                                                             [n]
  /// A n_ab = A (n11, n22, n12), membrane forces per reference width as work conjugate to E_ab. [3 x n] N mm
  NodalVectors membrane;
  // ring of moments; n: its stride
  Scalars slope_moment;  ///< 2: P_k of (B4); the last stays 0                            [3 n + 1] N mm
  Scalars hinge_factor;  ///< 2: 1/2 cos(theta/2) of (B5), 0 at a free edge               [3 n]
  Scalars height_force;  ///< 2: 2 alpha_k q_k of (B6)                                    [3 n] N
  // ring of corners; n: its stride
  NodalVectors corner_force;  ///< 3: force on corner k, of membrane and bending          [3 x 3 n] N

  // where in the rings
  Triangles across;              ///< t3 across edge k: facet, image where mirrored, own where free       [3 x n_el]
  Triangles opposite;            ///< slope_moment of find_opposite(), of the own side where free         [3 x n_el]
  std::vector<int> image_facet;  ///< t3 of the facet of each image                                       [images]
  /// slope_moment of the sides of each edge; second: that of the last, which is 0, where there is none. [n_edges]
  std::vector<int> first_side, second_side;
  std::vector<int> gather_entry;  ///< corner_force of the entries of ShellGeometry::gather

  SurfaceGradient facet(Eigen::Index e) const { return {at(f1, e), at(f2, e), at(t3, e), area_ratio(e)}; }
  void store_facet(Eigen::Index e, const SurfaceGradient& g);
};

/// kappa = (kappa_11, kappa_22, kappa_12), 1/mm, and what the moments on it need.
struct Curvature {
  double k11 = 0, k22 = 0, k12 = 0;
  double height[3] = {};        ///< h_k, mm
  double slope[3] = {};         ///< alpha_k
  double hinge_factor[3] = {};  ///< 1/2 cos(theta/2), 0 at a free edge
};

/// (B1) to (B3). @pre pass 1 of the element and its neighbours; rings of all elements here and below
/// @param phi  rotation of each edge [n_edges]
Curvature compute_curvature(const ShellGeometry& s, const ShellPasses& passes, const Scalars& phi, Eigen::Index e);

/// (B4): second pass of element `e` under the moments m = (m11, m22, m12) per unit reference width, N, whose work rate
/// per reference area is m11 k11' + m22 k22' + 2 m12 k12'.
void store_moments(const ShellGeometry& s, const Curvature& c, double m11, double m22, double m12, Eigen::Index e,
                   ShellPasses& passes);

/// (B5), (B6): adds the forces of element `e` on its corners to the slots k * n_el + e of `slot_force`.
/// @pre pass 2 of the element and its neighbours
void add_bending_forces(const ShellGeometry& s, const ShellPasses& passes, Eigen::Index e, NodalVectors& slot_force);

/// -dW/dphi of (B5), N mm; drives phi.
inline double compute_edge_torque(const ShellGeometry& s, const ShellPasses& passes, Eigen::Index edge) {
  const int first = s.edge_sides(0, edge), second = s.edge_sides(1, edge);
  return (second < 0 ? 0.0 : passes.slope_moment(second)) - passes.slope_moment(first);
}

}  // namespace interply::mechanics
