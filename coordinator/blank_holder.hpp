/// The blank holder: a rigid body with one vertical degree of freedom under a prescribed force.
#pragma once

#include "scene/scene.hpp"

namespace interply::coordinator {

/// Energies of the blank holder, mJ.
struct BodyEnergies {
  double kinetic = 0;  ///< at the last kick
  double damping = 0;  ///< dissipated by its damper
  double load = 0;     ///< work of the prescribed force
  double contact = 0;  ///< work of the contact force on it
  double residual() const { return kinetic + damping - load - contact; }
};

/// M z'' = F_contact - F(t) - c z'. Central difference like every node: the damper acts on v(n - 1/2).
class BlankHolder {
 public:
  /// @param area       flange area of the modelled part, mm2
  /// @param mass       t     @param stiffness  of the stack under the flange, N/mm: sets the damper as a fraction of
  ///                         critical
  BlankHolder(const scene::BlankHolder& settings, double area, double mass, double stiffness);

  double mass() const { return mass_; }
  double target() const { return target_; }  ///< prescribed force now, N, downwards
  const BodyEnergies& energies() const { return energies_; }

  /// Moves to t(n + 1) and returns the displacement, mm.
  double drift(double dt);
  /// @param time  t(n), s   @param contact_force  upwards, N   @param dt, next_dt  increments before and after t(n), s
  void kick(double time, double contact_force, double dt, double next_dt);

 private:
  double full_force_, ramp_, mass_, damper_;
  double velocity_ = 0, increment_ = 0, target_ = 0;
  double contact_force_ = 0, damper_force_ = 0;
  BodyEnergies energies_;
};

}  // namespace interply::coordinator
