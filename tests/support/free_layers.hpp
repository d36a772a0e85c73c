/// Two layers in free flight, with contact between them and nothing else: no tools, no processes.
#pragma once

#include <memory>

#include "contact/layer_interface.hpp"
#include "mechanics/central_difference.hpp"
#include "solve/layer_mechanics.hpp"

namespace interply::test {

using mechanics::NodalVectors;
using mechanics::Vector3;

/// One layer with everything that the loop needs.
struct FreeLayer {
  mechanics::TriangleMesh mesh;
  std::unique_ptr<solve::LayerMechanics> mechanics;
  contact::LayerGeometry geometry;
  mechanics::NodalMotion motion;
  NodalVectors position, internal_force;

  FreeLayer(mechanics::TriangleMesh m, std::unique_ptr<solve::LayerMechanics> law, double thickness, double density,
            const Vector3& velocity)
      : mesh(std::move(m)),
        mechanics(std::move(law)),
        motion(mechanics::make_motion_at_rest(mesh)),
        position(mesh.reference) {
    for (int d = 0; d < 3; ++d) motion.velocity.row(d) = velocity(d);
    geometry = {mesh, thickness, density};
    internal_force = NodalVectors::Zero(3, mesh.n_nodes());
  }
  FreeLayer(const FreeLayer&) = delete;

  void drift(double dt) {
    mechanics::drift(motion, dt, position);
    geometry.move_to(position);
  }
  void kick(double dt, double time, const NodalVectors& contact_force) {
    mechanics->compute_internal_forces(position, {.time = time, .dt = motion.dt}, internal_force);
    mechanics::kick(motion, dt, contact_force, internal_force, geometry.mass(), {});
  }
  Vector3 momentum() const {
    return {(motion.velocity.row(0).transpose() * geometry.mass()).sum(),
            (motion.velocity.row(1).transpose() * geometry.mass()).sum(),
            (motion.velocity.row(2).transpose() * geometry.mass()).sum()};
  }
  double internal() const { return mechanics->internal_energy(); }
};

/// A lower and an upper layer and what is between them.
struct FreePair {
  FreeLayer &lower, &upper;
  contact::LayerInterface interface;
  double time = 0;

  FreePair(const contact::InterfaceLaw& law, FreeLayer& l, FreeLayer& u)
      : lower(l), upper(u), interface(law, l.geometry, u.geometry) {
    interface.update(0);
  }
  void step(double dt) {
    time += dt;
    lower.drift(dt);
    upper.drift(dt);
    interface.update(dt);
    lower.kick(dt, time, interface.force_on_lower());
    upper.kick(dt, time, interface.force_on_upper());
  }
  Vector3 momentum() const { return lower.momentum() + upper.momentum(); }
  /// Everything that started as kinetic energy, wherever it is now, mJ.
  double energy() const {
    const contact::InterfaceEnergies& e = interface.energies();
    return lower.motion.kinetic + upper.motion.kinetic + lower.internal() + upper.internal() + e.stored + e.friction +
           e.damping - e.thinning - e.edge;
  }
};

}  // namespace interply::test
