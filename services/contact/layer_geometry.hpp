/// What contact needs to know of one layer at one instant.
#pragma once

#include "contact/normals.hpp"
#include "mechanics/mesh.hpp"

namespace interply::contact {

using mechanics::NodalVectors;
using mechanics::Scalars;
using mechanics::Vector3;

struct LayerGeometry {
  const mechanics::TriangleMesh* mesh = nullptr;
  VertexNormals* normals = nullptr;
  NodalVectors position;   ///< x(n)                        [3 x n_nodes] mm
  NodalVectors increment;  ///< x(n) - x(n - 1)             [3 x n_nodes] mm
  NodalVectors normal;     ///< n, averaged vertex normals, up  [3 x n_nodes]
  NodalVectors turn;       ///< n(n) - n(n - 1)             [3 x n_nodes]
  Scalars half_thickness;  ///< current                     [n_nodes]     mm
  Scalars mass;            ///< lumped                      [n_nodes]     t

  /// A flat layer at rest in its reference position; keeps pointers to both. @param thickness, density  mm, t/mm3
  static LayerGeometry at_rest(const mechanics::TriangleMesh& mesh, VertexNormals& normals, double thickness,
                               double density);

  /// On to x(n): position, increment, normals and their turn.
  void move_to(const NodalVectors& x);
};

}  // namespace interply::contact
