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

#include "contact/blocks.hpp"
#include "contact/face_forces.hpp"
#include "contact/kernels.hpp"
#include "contact/layer_geometry.hpp"
#include "contact/pairing.hpp"
#include "contact/points.hpp"
#include "contact/smooth_facet.hpp"

namespace interply::contact {

class LayerInterface {
 public:
  /// Pairs every node of `lower` with the triangle of `upper` it faces. Both stay where they are for the whole run.
  /// @param scratch  shared with interfaces that are not updated at the same time
  LayerInterface(const InterfaceLaw& law, const LayerGeometry& lower, const LayerGeometry& upper,
                 std::shared_ptr<Scratch> scratch = std::make_shared<Scratch>());

  /// Advances all points to the layers' current positions and fills the forces on both faces.
  /// @param dt   increment that led here, s; 0 for the initial state
  /// @param run  blocks.hpp; the results do not depend on it
  void update(double dt, const BlockRunner& run = {});

  /// The same point by point in the plain form of the equations: what update() must agree with to round-off.
  void update_plainly(double dt);

  struct LayerRates {
    Rates& within;  ///< of the layer's nodes with each other
    Rates& across;  ///< with the partner's
  };
  /// Adds the row sums of all paired points, touching or not, for each node of both partners: upper bounds where the
  /// facets are flat (THEORY.md 3).
  void add_rates_to(LayerRates lower, LayerRates upper) const;

  const InterfaceLaw& law() const { return law_; }
  const Points& points() const { return points_; }
  const LayerGeometry& lower() const { return lower_; }
  const LayerGeometry& upper() const { return upper_; }
  /// Triangle of the upper layer that node i of the lower one faces.
  int facing(Eigen::Index i) const { return triangle_[static_cast<std::size_t>(i)]; }
  const InterfaceEnergies& energies() const { return energies_; }
  const NodalVectors& force_on_lower() const { return on_lower_.force(); }  ///< [3 x n_nodes of lower] N
  const NodalVectors& force_on_upper() const { return on_upper_.force(); }  ///< [3 x n_nodes of upper] N

 private:
  /// Node i against the facet it faces now.
  struct Approach {
    Facing facing;
    SmoothFacet facet;
    Rise rise;
    double distance = 0, height = 0;  ///< l and h, mm
  };
  Approach approach(Eigen::Index i, const Facing& facing) const;
  /// Follows node i to the triangle it faces now. Adds the spring energy that it gains by facing another triangle
  /// beyond the edge to `edge`.
  Facing follow(Eigen::Index i, double& edge);
  PairRows describe(double dt);
  Quad* forces_of(Eigen::Index block) { return &scratch_->points[static_cast<std::size_t>(6 * kBlockSize * block)]; }
  void update_point(Eigen::Index i, double dt);

  InterfaceLaw law_;
  const ContactKernels& kernels_;
  const LayerGeometry& lower_;
  const LayerGeometry& upper_;
  Points points_;
  std::vector<int> triangle_;  ///< that each node of the lower layer faces
  std::shared_ptr<Scratch> scratch_;
  FaceForces on_lower_, on_upper_;
  std::vector<unsigned char> touches_;  ///< 0: nothing acts at the point
  std::vector<InterfaceEnergies> block_energies_;
  InterfaceEnergies energies_;
};

}  // namespace interply::contact
