/// Averaged vertex normals: the direction along which gaps are measured (PITFALLS 1).
#pragma once

#include "mechanics/mesh.hpp"

namespace interply::contact {

/// Computes area-weighted averaged unit normals of a deformed midsurface, pointing up for a flat blank. Nodes of the
/// symmetry plane y = 0 get n_y = 0, as their mirrored other half would give.
class VertexNormals {
 public:
  explicit VertexNormals(const mechanics::TriangleMesh& mesh);
  /// @param position  [3 x n_nodes] mm    @param normals  [3 x n_nodes], overwritten
  void compute(const mechanics::NodalVectors& position, mechanics::NodalVectors& normals);

 private:
  const mechanics::TriangleMesh& mesh_;
  mechanics::Incidence around_;
  mechanics::NodalVectors area_vectors_;  ///< twice the area vector of each triangle [3 x n_elements] mm2
};

}  // namespace interply::contact
