/// The time loop of one layer: arrays, central difference and energy books, without messages.
#pragma once

#include <memory>

#include "exchange/link.hpp"
#include "mechanics/central_difference.hpp"
#include "solve/layer_mechanics.hpp"

namespace interply::solve {

class LayerRun {
 public:
  LayerRun(const scene::Scene& scene, int layer, const mechanics::TriangleMesh& mesh,
           std::unique_ptr<LayerMechanics> mechanics);

  /// What the coordinator must know of the current positions. Filled by drift(); the position lives here.
  exchange::Motion& motion() { return motion_; }

  void drift(double dt);                    ///< x(n) -> x(n + 1), prepares motion()
  void compute_internal_forces();           ///< f_int(x(n)) and the energy stored or spent
  void kick(const exchange::Force& force);  ///< v(n - 1/2) -> v(n + 1/2), energies at n

  observe::LayerMesh describe_mesh() const;
  observe::LayerFrame describe_frame(int frame);
  exchange::Final describe_end();

 private:
  const scene::Scene& scene_;
  int layer_;
  const mechanics::TriangleMesh& mesh_;
  std::unique_ptr<LayerMechanics> mechanics_;
  TrustBook trust_;
  mechanics::Scalars mass_;
  mechanics::NodalMotion nodes_;
  mechanics::NodalVectors internal_force_;
  exchange::Motion motion_;
  exchange::LayerEnergies energies_;
  double time_ = 0;
};

}  // namespace interply::solve
