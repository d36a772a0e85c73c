/// One layer brought to equilibrium by the explicit steps that a run makes, with damping in proportion to the mass.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <vector>

#include "solve/layer_mechanics.hpp"
#include "support/plate_meshes.hpp"

namespace interply::test {

/// What drives a sheet from one equilibrium to the next; `s` goes from 0 to 1 as a smooth step over `ramp`, then stays.
struct Loading {
  /// Adds forces (N) on the nodes; they may follow the position.
  std::function<void(double s, const mechanics::NodalVectors& x, mechanics::NodalVectors& force)> force;
  /// Overwrites positions and velocities of guided nodes after a drift.
  std::function<void(double s, mechanics::NodalVectors& x, mechanics::NodalVectors& v)> guide;
  double damping = 0;       ///< c of the damping force -c m v, 1/s; critical for the frequency c/2
  double ramp = 0;          ///< s
  double tolerance = 1e-4;  ///< unbalanced and damping force against the internal forces, 2-norms
};

/// A layer, its motion and its supports.
class StaticSheet {
 public:
  mechanics::TriangleMesh mesh;
  std::unique_ptr<solve::LayerMechanics> layer;
  mechanics::Scalars mass;
  mechanics::NodalVectors position, velocity, force;  ///< force: internal
  mechanics::NodalVectors is_free;                    ///< 1 where a component moves by its own, else 0
  long steps = 0;

  /// @param make_layer  (mesh) -> std::unique_ptr<solve::LayerMechanics>
  template <typename MakeLayer>
  StaticSheet(mechanics::TriangleMesh m, double thickness, double density, MakeLayer make_layer)
      : mesh(std::move(m)),
        layer(make_layer(mesh)),
        mass(mechanics::compute_lumped_mass(mesh, thickness, density)),
        position(mesh.reference),
        velocity(mechanics::NodalVectors::Zero(3, mesh.n_nodes())),
        force(velocity),
        is_free(mechanics::NodalVectors::Ones(3, mesh.n_nodes())) {
    for (const int node : mesh.symmetry_nodes) is_free(1, node) = 0;
  }

  /// Fixes the components marked of every node for which `where(X, Y)`.
  template <typename Where>
  void hold(Where where, bool x, bool y, bool z) {
    for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i) {
      if (!where(mesh.reference(0, i), mesh.reference(1, i))) continue;
      if (x) is_free(0, i) = 0;
      if (y) is_free(1, i) = 0;
      if (z) is_free(2, i) = 0;
    }
  }

  /// Steps until the ramp is over and the sheet at rest.
  /// @throws std::runtime_error after 300 000 steps
  void run(const Loading& loading) {
    constexpr int kCheckEvery = 20;
    double time = 0, dt = 0, scale = force.matrix().norm();
    mechanics::NodalVectors external = mechanics::NodalVectors::Zero(3, mesh.n_nodes()), unbalanced = external;
    for (long step = 0; step < 300000; ++step, ++steps) {
      if (step % 200 == 0) dt = 0.9 * layer->compute_stable_increment(position);
      time += dt;
      const double a = loading.ramp > 0 ? std::min(1.0, time / loading.ramp) : 1.0;
      const double s = a * a * a * (10 - a * (15 - 6 * a));
      position += dt * velocity;
      if (loading.guide) loading.guide(s, position, velocity);
      layer->compute_internal_forces(position, {.time = time, .dt = dt}, force);
      external.setZero();
      if (loading.force) loading.force(s, position, external);
      unbalanced = is_free * (external - force);
      const double c = 0.5 * loading.damping * dt;
      for (int d = 0; d < 3; ++d)
        velocity.row(d) =
            ((1 - c) * velocity.row(d) + dt * unbalanced.row(d) / mass.transpose()) / (1 + c) * is_free.row(d);
      if (step % kCheckEvery != 0 || a < 1) continue;
      scale = std::max(scale, force.matrix().norm());
      mechanics::NodalVectors drag = loading.damping * velocity;
      for (int d = 0; d < 3; ++d) drag.row(d) *= mass.transpose();
      if (loading.guide) {
        unbalanced *= unguided_;
        drag *= unguided_;
      }
      if (unbalanced.matrix().norm() + drag.matrix().norm() < loading.tolerance * scale) return;
    }
    throw std::runtime_error("the sheet did not come to rest");
  }

  /// Nodes that a guide moves: their reactions are no unbalanced force.
  template <typename Where>
  void mark_guided(Where where) {
    unguided_ = mechanics::NodalVectors::Ones(3, mesh.n_nodes());
    for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i)
      if (where(mesh.reference(0, i), mesh.reference(1, i))) unguided_.col(i) = 0;
  }

 private:
  mechanics::NodalVectors unguided_;
};

}  // namespace interply::test
