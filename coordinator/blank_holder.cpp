#include "coordinator/blank_holder.hpp"

#include <cmath>

#include "coordinator/amplitude.hpp"

namespace interply::coordinator {

BlankHolder::BlankHolder(const scene::BlankHolder& settings, double area, double mass, double stiffness)
    : full_force_(settings.pressure * area),
      ramp_(settings.ramp),
      mass_(mass),
      damper_(2 * settings.damping * std::sqrt(stiffness * mass)) {}

double BlankHolder::drift(double dt) {
  increment_ = dt * velocity_;
  return increment_;
}

void BlankHolder::kick(double time, double contact_force, double dt, double next_dt) {
  const double old_target = target_, old_damper_force = damper_force_, old_contact_force = contact_force_;
  target_ = full_force_ * smooth_step(time / ramp_);
  damper_force_ = -damper_ * velocity_;
  contact_force_ = contact_force;
  energies_.load -= 0.5 * (old_target + target_) * increment_;
  energies_.damping -= 0.5 * (old_damper_force + damper_force_) * increment_;
  energies_.contact += 0.5 * (old_contact_force + contact_force_) * increment_;
  const double old_velocity = velocity_;
  velocity_ += 0.5 * (dt + next_dt) * (contact_force - target_ + damper_force_) / mass_;
  energies_.kinetic = 0.5 * mass_ * old_velocity * velocity_;
}

}  // namespace interply::coordinator
