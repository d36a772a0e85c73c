/// What a solver process knows about its layer beyond nodes, masses and time: the two solvers implement this.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "exchange/link.hpp"
#include "mechanics/digest.hpp"
#include "mechanics/failure.hpp"
#include "mechanics/mesh.hpp"
#include "observe/frames.hpp"
#include "scene/scene.hpp"
#include "solve/trust.hpp"

namespace interply::solve {

/// When a layer computes its forces.
struct Instant {
  double time = 0;  ///< t(n), s
  double dt = 0;    ///< t(n) - t(n - 1), s; 0 at the start and for a position that is not part of a motion
};

class LayerMechanics {
 public:
  virtual ~LayerMechanics() = default;

  /// f_int(x) of every node, N, into `force` (overwritten). History-dependent layers advance from the position of the
  /// previous call to `position`; called once per step. Also refreshes internal_energy().
  /// The force pulls the nodes: a = (f_contact - f_int) / m.
  /// What moves inside the layer beside its nodes (the edges of mechanics/edge_shell.hpp) moves by `now.dt` with them.
  /// @throws mechanics::Divergence for a NaN or an inverted (folded) element; `now.time` goes into its message
  virtual void compute_internal_forces(const mechanics::NodalVectors& position, const Instant& now,
                                       mechanics::NodalVectors& force) = 0;

  /// Energy stored (fabric) or stress work spent (metal) up to the last compute_internal_forces(), with what moves
  /// inside the layer: the kinetic energy and the damping of its edges; mJ.
  virtual double internal_energy() const = 0;

  /// Largest stable increment of the layer alone from the current tangent, s; no safety factor.
  /// @param position  here and below: that of the last compute_internal_forces(), or the reference before the first
  virtual double compute_stable_increment(const mechanics::NodalVectors& position) = 0;

  /// Current thickness at the nodes, mm [n_nodes], or empty if the thickness is constant.
  virtual mechanics::Scalars compute_nodal_thickness() const { return {}; }

  /// Fields of a frame, without the position.
  virtual std::vector<observe::Field> compute_fields(const mechanics::NodalVectors& position) const = 0;

  /// Limits of what may be believed of this layer, and the quantities that they are for, of every element
  /// [n_limits x n_elements]. Evaluated at frames and at the end.
  virtual std::vector<TrustLimit> trust_limits() const { return {}; }
  virtual Eigen::ArrayXXd compute_trust_quantities(const mechanics::NodalVectors& position) const {
    return Eigen::ArrayXXd(0, position.cols());
  }

  /// The few numbers a person wants at the end (largest shear angle, thinning, ...).
  virtual std::vector<exchange::SummaryItem> summarise(const mechanics::NodalVectors& position) const = 0;

  /// Adds history (plastic strain, stress, ...) to the digest of the final state.
  virtual void add_state_to(mechanics::Digest& digest) const = 0;
};

/// Mesh of any layer of a scene, its own or the blank's; z is the midsurface in the touching stack.
/// @throws scene::SceneError  its file is gone or has changed since the scene was resolved
mechanics::TriangleMesh make_layer_mesh(const scene::Scene& scene, int layer);

}  // namespace interply::solve
