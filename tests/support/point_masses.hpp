/// A stand-in layer: free point masses without internal forces, for the loop and for contact without elements.
#pragma once

#include "solve/session.hpp"

namespace interply::test {

/// Nodes have the mass of their layer and feel nothing but contact. Its vote is no limit: contact alone sets the pace.
class PointMasses : public solve::LayerMechanics {
 public:
  explicit PointMasses(Eigen::Index n_nodes) : n_nodes_(n_nodes) {}
  void compute_internal_forces(const mechanics::NodalVectors&, const solve::Instant&,
                               mechanics::NodalVectors& force) override {
    force.setZero(3, n_nodes_);
  }
  double internal_energy() const override { return 0; }
  double compute_stable_increment(const mechanics::NodalVectors&) override { return 1; }
  std::vector<observe::Field> compute_fields(const mechanics::NodalVectors&) const override { return {}; }
  std::vector<exchange::SummaryItem> summarise(const mechanics::NodalVectors&) const override { return {}; }
  void add_state_to(mechanics::Digest&) const override {}

 private:
  Eigen::Index n_nodes_;
};

inline std::unique_ptr<solve::LayerMechanics> make_point_masses(const scene::Scene&, int,
                                                                const mechanics::TriangleMesh& mesh) {
  return std::make_unique<PointMasses>(mesh.n_nodes());
}

}  // namespace interply::test
