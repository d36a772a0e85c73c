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
                               double density) {
    const NodalVectors zero = NodalVectors::Zero(3, mesh.n_nodes());
    LayerGeometry g{.mesh = &mesh, .normals = &normals, .position = mesh.reference};
    g.increment = g.normal = g.turn = zero;
    g.half_thickness = Scalars::Constant(mesh.n_nodes(), 0.5 * thickness);
    g.mass = mechanics::compute_lumped_mass(mesh, thickness, density);
    normals.compute(g.position, g.normal);
    return g;
  }

  /// On to x(n): position, increment, normals and their turn.
  void move_to(const NodalVectors& x) {
    increment = x - position;
    position = x;
    turn = -normal;
    normals->compute(position, normal);
    turn += normal;
  }
};

}  // namespace interply::contact
