/// Forces of an interface on one of its layers: what acts on the nodes, and what turns their normals.
#pragma once

#include <vector>

#include "contact/layer_geometry.hpp"

namespace interply::contact {

class FaceForces {
 public:
  explicit FaceForces(const LayerGeometry& layer);

  /// To be filled in each step: force on node i in 2 i, and in 2 i + 1 the pull on its normal, minus the derivative of
  /// the energy by it. [2 x n_nodes] N, mJ
  Quad* records() { return records_.data(); }
  void clear_records() { std::fill(records_.begin(), records_.end(), Quad{}); }

  /// Turns the records into nodal forces.
  /// @returns work of the forces in the step, trapezoid over the layer's displacement increment, mJ
  double finish();
  /// The same where nothing acts.
  double finish_without_forces();

  const NodalVectors& force() const { return force_; }  ///< [3 x n_nodes] N

 private:
  const LayerGeometry& layer_;
  NodalVectors force_;
  std::vector<Quad> records_;  ///< [2 x n_nodes]
  bool is_zero_ = true;        ///< of force_
};

}  // namespace interply::contact
