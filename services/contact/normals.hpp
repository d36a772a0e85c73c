/// Averaged vertex normals: the direction along which gaps are measured.
#pragma once

#include <vector>

#include "contact/quad.hpp"
#include "mechanics/mesh.hpp"

namespace interply::contact {

/// Area-weighted averaged unit normals of a deformed midsurface, n_i = s_i/|s_i| with s_i the sum of the area vectors
/// around node i, pointing up for a flat blank. Nodes of the symmetry plane y = 0 get n_y = 0, as their mirrored other
/// half would give.
///
/// Both directions run over the triangles and add to the corners: every sum has the order of the mesh. What a triangle
/// gives is not kept, for memory is what these loops wait for.
class VertexNormals {
 public:
  using Index = Eigen::Index;
  explicit VertexNormals(const mechanics::TriangleMesh& mesh);

  /// Normals at x(n). @param position  [3 x n_nodes] mm
  /// @param normal  [3 x n_nodes], overwritten   @param turn  [3 x n_nodes], n(n) - n(n - 1), overwritten
  void compute(const mechanics::NodalVectors& position, mechanics::NodalVectors& normal, mechanics::NodalVectors& turn);

  /// Nodal forces of an energy that depends on the normals. `records` [2 x n_nodes] has in 2 i the force on node i,
  /// which is added to, and in 2 i + 1 the pull on its normal, minus the derivative of the energy by it, mJ, which is
  /// overwritten. What is added sums up to zero. @pre compute() was called for the same positions
  void add_forces_of_pulls(const mechanics::NodalVectors& normal, Quad* records) const;

 private:
  void turn_pulls_to_areas(const mechanics::NodalVectors& normal, Quad* records) const;

  const mechanics::TriangleMesh& mesh_;
  std::vector<Quad> position_;   ///< [n_nodes] mm
  std::vector<Quad> area_;       ///< 2 s_i [n_nodes] mm2
  mechanics::Scalars length_;    ///< 2 |s_i| [n_nodes] mm2
  mechanics::Scalars sideways_;  ///< 0 for nodes held in the symmetry plane, else 1 [n_nodes]
};

}  // namespace interply::contact
