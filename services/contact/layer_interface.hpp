/// Contact between two neighbouring layers: the nodes of the lower one against the smooth surface of the upper one.
///
/// The distance of node p is measured along its averaged vertex normal n to the facet it faces, plus the rise r of a
/// smooth surface above that facet, the cubic over each side that is tangent to the planes across the vertex normals:
///
///   l = ((x_1 - x_p).N)/(n.N) + r                                                                           (C1)
///   r = 1/2 sum_{i<j} w_i w_j [ d.(n_j - n_i) - (w_i - w_j) d.(n_i + n_j) ],   d = x_j - x_i
///
/// The normal force is the exact gradient of the penalty energy 1/2 k s A (h - l)^2 by all nodal positions, those that
/// only turn a normal or change the share s at the partner's edge included. Friction and damper act at one point that
/// both sides share, between the midsurfaces (C4). So, whatever the meshes, pressure neither creates nor loses energy
/// when nodes slide over facets, and linear and angular momentum are conserved.
#pragma once

#include <vector>

#include "contact/layer_geometry.hpp"
#include "contact/pairing.hpp"
#include "contact/points.hpp"
#include "contact/smooth_facet.hpp"

namespace interply::contact {

class LayerInterface {
 public:
  /// Pairs every node of `lower` with the triangle of `upper` it faces. Both stay where they are for the whole run.
  LayerInterface(const InterfaceLaw& law, const LayerGeometry& lower, const LayerGeometry& upper);

  /// Advances all points to the layers' current positions and fills the forces on both faces.
  /// @param dt  increment that led here, s; 0 for the initial state
  void update(double dt);

  /// For each node of both partners, the row sum of M^-1 K of all paired points, touching or not: what contact adds to
  /// omega^2 there, an upper bound where the facets are flat (THEORY.md 3). Adds to `lower_rate` and `upper_rate`,
  /// 1/s2.
  void add_rates_to(Scalars& lower_rate, Scalars& upper_rate) const;

  const Points& points() const { return points_; }
  const InterfaceEnergies& energies() const { return energies_; }
  const NodalVectors& force_on_lower() const { return force_on_lower_; }  ///< [3 x n_nodes of lower] N
  const NodalVectors& force_on_upper() const { return force_on_upper_; }  ///< [3 x n_nodes of upper] N

 private:
  /// Node i against the facet it faces now.
  struct Approach {
    Facing facing;
    SmoothFacet facet;
    Rise rise;
    double distance = 0, height = 0;  ///< l and h, mm
  };
  Approach approach(Eigen::Index i, const Facing& facing) const;
  /// Adds the spring energy that node i gains by facing another triangle beyond the edge to `edge`.
  void book_change_of_triangle(Eigen::Index i, int before, const Approach& now);
  void update_point(Eigen::Index i, double dt);

  InterfaceLaw law_;
  const LayerGeometry& lower_;
  const LayerGeometry& upper_;
  Points points_;
  std::vector<Facing> facing_;
  NodalVectors force_on_lower_, force_on_upper_;
  NodalVectors old_force_on_lower_, old_force_on_upper_;
  NodalVectors pull_on_lower_, pull_on_upper_;  ///< minus the derivative of the energy by the normals [3 x n_nodes] mJ
  InterfaceEnergies energies_;
};

}  // namespace interply::contact
