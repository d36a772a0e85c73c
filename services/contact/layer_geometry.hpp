/// What contact needs to know of one layer at one instant.
#pragma once

#include <vector>

#include "contact/cells.hpp"
#include "contact/node.hpp"
#include "mechanics/mesh.hpp"

namespace interply::contact {

using mechanics::NodalVectors;
using mechanics::Scalars;
using mechanics::Vector3;

inline Vector3 to_vector(const Quad& q) { return {q.x, q.y, q.z}; }
inline void set(Quad& q, const Vector3& a) {
  q.x = a.x();
  q.y = a.y();
  q.z = a.z();
}

/// Nodes of a layer with the direction along which gaps are measured: area-weighted averaged unit normals of the
/// deformed midsurface, pointing up for a flat blank. Nodes of the symmetry plane y = 0 get n_y = 0, as their mirrored
/// other half would give.
///
/// The loops over the triangles add to their corners: every sum has the order of the cells. What a triangle gives is
/// not kept, for memory is what these loops wait for.
class LayerGeometry {
 public:
  using Index = Eigen::Index;
  LayerGeometry() = default;
  /// A flat layer at rest in its reference position. Keeps a pointer to the mesh.
  /// @param thickness, density  mm, t/mm3
  LayerGeometry(const mechanics::TriangleMesh& mesh, double thickness, double density);

  /// On to x(n): position, increment, normals and their turn. @param x  [3 x n_nodes] mm
  void move_to(const NodalVectors& x);
  /// @param half  current, mm [n_nodes]
  void set_half_thickness(const Scalars& half);

  const mechanics::TriangleMesh& mesh() const { return *mesh_; }
  Index n_nodes() const { return static_cast<Index>(nodes_.size()); }
  const Node* nodes() const { return nodes_.data(); }
  const Node& node(Index i) const { return nodes_[static_cast<std::size_t>(i)]; }
  Node& node(Index i) { return nodes_[static_cast<std::size_t>(i)]; }
  Vector3 position(Index i) const { return to_vector(node(i).position); }    ///< x(n), mm
  Vector3 increment(Index i) const { return to_vector(node(i).increment); }  ///< x(n) - x(n - 1), mm
  Vector3 normal(Index i) const { return to_vector(node(i).normal); }        ///< n, unit
  Vector3 turn(Index i) const { return to_vector(node(i).turn); }            ///< n(n) - n(n - 1)
  double half_thickness(Index i) const { return node(i).position.w; }        ///< current, mm
  const Scalars& mass() const { return mass_; }                              ///< lumped [n_nodes] t
  NodalVectors positions() const;                                            ///< [3 x n_nodes] mm
  Scalars compute_tributary_areas() const;  ///< a third of the deformed triangles around each node [n_nodes] mm2

  /// Triangles around the nodes of a range.
  Cells::Reach find_reach(const Span& nodes) const { return cells_.find_reach(nodes); }
  /// Nodal forces of an energy that depends on the normals. `records` [2 x n_nodes] has in 2 i the force on node i,
  /// which is added to, and in 2 i + 1 the pull on its normal, minus the derivative of the energy by it, mJ, which is
  /// overwritten. What is added sums up to zero. Only the nodes and triangles within `reach` are looked at.
  /// @pre the last move_to() was to the positions of that energy
  void add_forces_of_pulls(Quad* records, const Cells::Reach& reach) const;

 private:
  const mechanics::TriangleMesh* mesh_ = nullptr;
  Cells cells_;
  std::vector<Node> nodes_;
  Scalars mass_;
  std::vector<Quad> area_;  ///< 2 s_i, s_i the sum of the area vectors around node i; n_i = s_i/|s_i| [n_nodes] mm2
  Scalars inverse_length_;  ///< 1/(2 |s_i|) [n_nodes] 1/mm2
  Scalars sideways_;        ///< 0 for nodes held in the symmetry plane, else 1 [n_nodes]
};

}  // namespace interply::contact
