/// Averaged vertex normals: the direction along which gaps are measured.
#pragma once

#include "mechanics/mesh.hpp"

namespace interply::contact {

/// Area-weighted averaged unit normals of a deformed midsurface, n_i = s_i/|s_i| with s_i the sum of the area vectors
/// around node i, pointing up for a flat blank. Nodes of the symmetry plane y = 0 get n_y = 0, as their mirrored other
/// half would give.
class VertexNormals {
 public:
  explicit VertexNormals(const mechanics::TriangleMesh& mesh);

  /// @param position  [3 x n_nodes] mm    @param normals  [3 x n_nodes], overwritten
  void compute(const mechanics::NodalVectors& position, mechanics::NodalVectors& normals);

  /// Nodal forces of an energy that depends on the normals: adds sum_i pull_i . dn_i/dx_j to `force`. They add up to
  /// zero. `pull` [3 x n_nodes] mJ is overwritten.
  void add_forces_to(const mechanics::NodalVectors& position, const mechanics::NodalVectors& normals,
                     mechanics::NodalVectors& pull, mechanics::NodalVectors& force) const;

 private:
  const mechanics::TriangleMesh& mesh_;
  mechanics::Incidence around_;
  mechanics::NodalVectors area_vectors_;  ///< twice the area vector of each triangle [3 x n_elements] mm2
  mechanics::Scalars length_;             ///< 2 |s_i| [n_nodes] mm2
};

}  // namespace interply::contact
