#include "coordinator/measurements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "coordinator/coordinator.hpp"

namespace interply::coordinator {

Measurements::Measurements(const scene::Scene& scene, int n_interfaces)
    : scene_(scene), layer_times_(scene.layers.size()), touched_(static_cast<std::size_t>(n_interfaces)) {}

void Measurements::note_layer_time(int layer, const StepTime& time) {
  StepTime& sum = layer_times_[static_cast<std::size_t>(layer)];
  sum.step += time.step;
  sum.wait += time.wait;
}

void Measurements::note_own_time(const StepTime& time) {
  own_time_.step += time.step;
  own_time_.wait += time.wait;
  ++steps_since_row_;
}

void Measurements::note_balance(const EnergyBalance& balance, double residual, double time) {
  largest_residual_ = std::max(largest_residual_, std::abs(residual));
  const bool forms = scene_.tools.punch && scene_.motion.stroke > 0 && time > scene_.tools.blank_holder.ramp;
  if (forms && balance.kinetic > inertia_.kinetic)
    inertia_ = {.kinetic = balance.kinetic, .work = balance.external, .time = time};
}

void Measurements::note_contact(const std::vector<contact::InterfaceEnergies>& interfaces) {
  constexpr double kTouching = 1e-12;  // mJ; less is the rounding of a stack that just touches
  for (std::size_t k = 0; k < interfaces.size(); ++k)
    if (interfaces[k].stored > kTouching) touched_[k] = true;
}

void Measurements::note_blank_holder(double force, double target, const Pace& pace) {
  if (pace.time() <= scene_.tools.blank_holder.ramp) return;
  if (target > 0) holder_deviation_ = std::max(holder_deviation_, std::abs(force - target) / target);
  holder_impulse_ += pace.dt() * force;
  holder_time_ += pace.dt();
}

void Measurements::note_frame(const Stack& stack) {
  contact::PenetrationSample sample = sample_penetration(stack);
  penetration_99_ = std::max(penetration_99_, sample.compute_percentile(0.99));
  penetration_peak_ = std::max(penetration_peak_, sample.peak());
}

void Measurements::note_depth(const Stack& stack, double time) {
  for (int k = 1; k < stack.n_layers() && too_soft_.empty(); ++k) {
    const contact::Points& p = stack.points(k);
    Eigen::Index deepest = 0;
    if (!((p.pressure > 0).select(-p.gap / p.height, 0.0).maxCoeff(&deepest) > 1)) continue;
    too_soft_ = fmt::format(
        "at time {:.6g} s, interface {} was pressed {:.3g} mm deep, past the midsurfaces: contact.reference_pressure = "
        "{:g} MPa is too soft for this load",
        time, name_interfaces(scene_)[static_cast<std::size_t>(k)].name, -p.gap(deepest),
        scene_.contact.reference_pressure);
  }
}

void Measurements::put_times_into(observe::HistoryRow& row) {
  const double steps = static_cast<double>(std::max<std::int64_t>(std::exchange(steps_since_row_, 0), 1));
  for (StepTime& sum : layer_times_) {
    const StepTime time = std::exchange(sum, {});
    row.step_seconds.push_back(time.step / steps);
    row.wait_seconds.push_back(time.wait / steps);
  }
  const StepTime own = std::exchange(own_time_, {});
  row.coordinator_step_seconds = own.step / steps;
  row.coordinator_wait_seconds = own.wait / steps;
}

contact::PenetrationSample sample_penetration(const Stack& stack) {
  contact::PenetrationSample sample;
  for (int k = 0; k < stack.n_interfaces(); ++k) sample.add(stack.points(k), stack.thinner(k));
  return sample;
}

}  // namespace interply::coordinator
