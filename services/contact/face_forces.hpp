/// Forces of an interface on one of its layers: what acts on the nodes, and what turns their normals.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "contact/layer_geometry.hpp"

namespace interply::contact {

/// What an interface needs only while it is updated. Those of a stack come one after the other and share it, so that
/// it stays in the cache.
struct Scratch {
  std::vector<Quad> lower, upper;  ///< records of the two faces
  std::vector<Quad> points;        ///< forces of some points on the corners they face, kernels.hpp
};

class FaceForces {
 public:
  /// @param records  grown to what the layer needs; the same for all its uses
  FaceForces(const LayerGeometry& layer, std::vector<Quad>& records);

  /// To be filled in each step: force on node i in 2 i, and in 2 i + 1 the pull on its normal, minus the derivative of
  /// the energy by it. [2 x n_nodes] N, mJ
  Quad* records() { return records_.data(); }
  void clear_records() { std::fill_n(records(), 2 * layer_.n_nodes(), Quad{}); }

  /// Turns the records into nodal forces. @param acting  nodes that have records; nothing acts on the others
  /// @returns work of the forces in the step, trapezoid over the layer's displacement increment, mJ
  double finish(const Span& acting);

  const NodalVectors& force() const { return force_; }  ///< [3 x n_nodes] N

 private:
  const LayerGeometry& layer_;
  NodalVectors force_;
  std::vector<Quad>& records_;
  Span acted_;  ///< nodes of which force_ is not zero
};

}  // namespace interply::contact
