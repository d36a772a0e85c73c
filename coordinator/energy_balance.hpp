/// The energy balance of the whole run from terms that every participant accumulated by itself
/// (services/mechanics/THEORY.md).
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "coordinator/blank_holder.hpp"
#include "coordinator/stack.hpp"
#include "exchange/link.hpp"

namespace interply::coordinator {

/// What the coordinator's own participants hold at one step.
struct CoordinatorEnergies {
  std::vector<contact::InterfaceEnergies> interfaces;
  BodyEnergies blank_holder;
  double punch_work = 0;  ///< done by the punch on the laminate, mJ
};

/// All energies of one step, mJ. What edges put into springs (InterfaceEnergies::edge) counts as thinning.
struct EnergyBalance {
  double kinetic = 0, internal = 0, contact = 0, friction = 0, damping = 0, thinning = 0, external = 0;
  std::vector<double> layer_kinetic, layer_internal, layer_residual, interface_residual, interface_friction;

  double residual() const { return kinetic + internal + contact + friction + damping - thinning - external; }
  /// The work that went in, wherever it is now.
  double scale() const { return std::max(std::abs(external), kinetic + internal + contact + friction + damping); }
};

/// What a residual is measured against before the laminate has taken up more: the energies that the tools put into any
/// laminate of this mass, however it answers. The punch sets it in motion, and what a step loses where nodes are hit is
/// a part of their kinetic energy; the blank holder presses its contacts together. At least 1 mJ: below, a ratio of
/// round-off says nothing.
/// @param mass, speed       of the laminate, t; largest of the punch, mm/s
/// @param force, stiffness  of the blank holder, N; of the stack under it, N/mm
inline double compute_least_scale(double mass, double speed, double force, double stiffness) {
  return std::max(1.0, 0.5 * mass * speed * speed + 0.5 * force * force / stiffness);
}

/// Sums up `b` anew; allocates nothing once its vectors have their size.
inline void assemble_balance(const std::vector<exchange::LayerEnergies>& layers, const CoordinatorEnergies& own,
                             EnergyBalance& b) {
  b.kinetic = b.internal = b.contact = b.friction = b.damping = b.thinning = 0;
  for (std::vector<double>* v : {&b.layer_kinetic, &b.layer_internal, &b.layer_residual}) v->clear();
  for (std::vector<double>* v : {&b.interface_residual, &b.interface_friction}) v->clear();
  for (const exchange::LayerEnergies& e : layers) {
    b.kinetic += e.kinetic;
    b.internal += e.internal;
    b.layer_kinetic.push_back(e.kinetic);
    b.layer_internal.push_back(e.internal);
    b.layer_residual.push_back(e.kinetic + e.internal - e.contact_work);
  }
  for (const contact::InterfaceEnergies& e : own.interfaces) {
    b.contact += e.stored;
    b.friction += e.friction;
    b.damping += e.damping;
    b.thinning += e.thinning + e.edge;
    b.interface_residual.push_back(e.residual());
    b.interface_friction.push_back(e.friction);
  }
  b.kinetic += own.blank_holder.kinetic;
  b.damping += own.blank_holder.damping;
  b.external = own.punch_work + own.blank_holder.load;
}

}  // namespace interply::coordinator
