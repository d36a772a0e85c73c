#include "coordinator/step.hpp"

#include <fmt/format.h>

#include "coordinator/amplitude.hpp"
#include "coordinator/frames.hpp"
#include "mechanics/failure.hpp"

namespace interply::coordinator {

Forming::Forming(const scene::Scene& scene, exchange::CoordinatorLink& link, observe::Sink& sink)
    : scene_(scene),
      link_(link),
      sink_(sink),
      stack_(scene),
      pace_(scene),
      holder_(scene.tools.blank_holder, stack_.flange_area(), scene.tools.blank_holder.mass_ratio * stack_.mass(),
              stack_.stiffness()),
      scale_(compute_least_scale(stack_.mass(),
                                 stack_.punch() ? kSteepest * scene.motion.stroke / scene.motion.forming_time : 0,
                                 scene.tools.blank_holder.pressure * stack_.flange_area(), stack_.stiffness())),
      layer_energies_(scene.layers.size()),
      forces_(scene.layers.size()),
      step_sums_(scene.layers.size(), 0.0),
      wait_sums_(scene.layers.size(), 0.0) {
  energies_.interfaces.resize(static_cast<std::size_t>(stack_.n_interfaces()));
  touched_.resize(energies_.interfaces.size());
  for (int i = 0; i < stack_.n_layers(); ++i) checks_.emplace_back(scene, i, stack_.layer(i).mesh);
}

double Forming::compute_stroke(double time) const {
  return scene_.motion.stroke * smooth_step((time - scene_.tools.blank_holder.ramp) / scene_.motion.forming_time);
}

void Forming::begin_step() {
  travel_ = compute_stroke(pace_.time());
  stack_.move_tools(travel_, holder_.drift(pace_.dt()));
  stack_.begin_step();
}

bool Forming::take_motion(int who) {
  const exchange::Motion& motion = link_.motion(who);
  stack_.accept(who, motion, pace_.dt());
  layer_energies_[static_cast<std::size_t>(who)] = motion.energies;
  step_sums_[static_cast<std::size_t>(who)] += motion.step_seconds;
  wait_sums_[static_cast<std::size_t>(who)] += motion.wait_seconds;
  if (pace_.step() == 0) {  // nobody knows the first increment before all votes are in
    if (!stack_.is_step_complete()) return true;
    pace_.start(votes_ = stack_.collect_votes());
  }
  for (int i = 0; i < stack_.n_layers(); ++i)
    if (stack_.can_answer(i)) answer(i);
  return lost_ < 0;
}

void Forming::answer(int i) {
  exchange::Force& force = forces_[static_cast<std::size_t>(i)];
  force.step = pace_.step();
  force.time = pace_.time();
  force.next_dt = pace_.next_dt();
  force.frame = pace_.frame();
  force.last = pace_.is_last();
  stack_.answer(i, force.force);
  if (!link_.send(i, force)) lost_ = i;
}

void Forming::finish_step() {
  check_balance();  // of step n - 1, whose layer energies came with the motions of step n
  holder_.kick(pace_.time(), holder_force(), pace_.dt(), pace_.next_dt());
  if (stack_.punch()) energies_.punch_work -= 0.5 * (old_punch_force_ + punch_force()) * stack_.punch()->increment;
  old_punch_force_ = punch_force();
  constexpr double kTouching = 1e-12;  // mJ; less is the rounding of a stack that just touches
  for (int k = 0; k < stack_.n_interfaces(); ++k) {
    const auto interface = static_cast<std::size_t>(k);
    energies_.interfaces[interface] = stack_.energies(k);
    if (energies_.interfaces[interface].stored > kTouching) touched_[interface] = true;
  }
  energies_.blank_holder = holder_.energies();
  measure();
  if (pace_.frame() >= 0) publish_frame();
  if (pace_.is_last()) return;
  if (pace_.has_row()) put_history_row(balance_);
  if (pace_.step() % scene_.time.vote_every == 0) {
    votes_ = stack_.collect_votes();
    note_too_soft();
  }
  pace_.advance(votes_);
}

void Forming::check_balance() {
  assemble_balance(layer_energies_, energies_, balance_);
  scale_ = std::max(scale_, balance_.scale());
  residual_ = balance_.residual() / scale_;
  largest_residual_ = std::max(largest_residual_, std::abs(residual_));
  if (travel_ > 0 && stack_.punch() && balance_.kinetic > inertia_.kinetic)
    inertia_ = {.kinetic = balance_.kinetic, .work = balance_.external, .time = pace_.time() - pace_.dt()};
  if (std::abs(residual_) <= scene_.time.energy_limit) return;
  const auto worst = explain_residual(scene_, balance_);
  throw mechanics::Divergence(fmt::format(
      "energy residual {:.3g} % of {:.4g} mJ passed its limit {:.3g} % at step {}, time {:.6g} s: largest share {} "
      "({:.3g} mJ); likely cure: {}",
      100 * residual_, scale_, 100 * scene_.time.energy_limit, pace_.step() - 1, pace_.time(), worst.name, worst.value,
      worst.cure));
}

void Forming::measure() {
  own_step_sum_ += step_seconds;
  own_wait_sum_ += wait_seconds;
  ++steps_since_row_;
  if (pace_.time() <= scene_.tools.blank_holder.ramp) return;
  const double target = holder_.target();
  if (target > 0) holder_deviation_ = std::max(holder_deviation_, std::abs(holder_force() - target) / target);
  holder_impulse_ += pace_.dt() * holder_force();
  holder_time_ += pace_.dt();
}

void Forming::note_too_soft() {
  for (int k = 1; k < stack_.n_layers() && too_soft_.empty(); ++k) {
    const contact::Points& p = stack_.points(k);
    Eigen::Index deepest = 0;
    if (!((p.pressure > 0).select(-p.gap / p.height, 0.0).maxCoeff(&deepest) > 1)) continue;
    too_soft_ = fmt::format(
        "at time {:.6g} s, interface {} was pressed {:.3g} mm deep, past the midsurfaces: contact.reference_pressure = "
        "{:g} MPa is too soft for this load",
        pace_.time(), name_interfaces(scene_)[static_cast<std::size_t>(k)].name, -p.gap(deepest),
        scene_.contact.reference_pressure);
  }
}

contact::PenetrationSample Forming::sample_penetration() const {
  contact::PenetrationSample sample;
  for (int k = 0; k < stack_.n_interfaces(); ++k) sample.add(stack_.points(k), stack_.thinner(k));
  return sample;
}

void Forming::publish_frame() {
  contact::PenetrationSample sample = sample_penetration();
  penetration_99_ = std::max(penetration_99_, sample.compute_percentile(0.99));
  penetration_peak_ = std::max(penetration_peak_, sample.peak());
  put_frames(scene_, stack_, pace_, sink_);
}

EnergyBalance Forming::balance_end(const std::vector<exchange::Final>& finals) const {
  std::vector<exchange::LayerEnergies> layers;
  for (const exchange::Final& f : finals) layers.push_back(f.energies);
  EnergyBalance balance;
  assemble_balance(layers, energies_, balance);
  return balance;
}

void Forming::put_history_row(const EnergyBalance& b) {
  const double steps = static_cast<double>(std::max<std::int64_t>(steps_since_row_, 1));
  observe::HistoryRow row{.step = pace_.step(), .time = pace_.time(), .dt = pace_.dt(), .stroke = travel_};
  row.kinetic = b.kinetic;
  row.internal = b.internal;
  row.contact = b.contact;
  row.friction = b.friction;
  row.damping = b.damping;
  row.thinning = b.thinning;
  row.external = b.external;
  row.residual = residual_;
  row.punch_force = punch_force();
  row.blank_holder_force = holder_force();
  row.blank_holder_target = holder_.target();
  row.peak_penetration = sample_penetration().peak();
  row.votes = votes_.layers;
  row.contact_vote = votes_.contact;
  row.layer_kinetic = b.layer_kinetic;
  row.layer_internal = b.layer_internal;
  row.layer_residual = b.layer_residual;
  row.interface_residual = b.interface_residual;
  row.interface_friction = b.interface_friction;
  for (double& s : step_sums_) row.step_seconds.push_back(std::exchange(s, 0.0) / steps);
  for (double& s : wait_sums_) row.wait_seconds.push_back(std::exchange(s, 0.0) / steps);
  row.coordinator_step_seconds = std::exchange(own_step_sum_, 0.0) / steps;
  row.coordinator_wait_seconds = std::exchange(own_wait_sum_, 0.0) / steps;
  steps_since_row_ = 0;
  ++rows_;
  sink_.put(row);
}

}  // namespace interply::coordinator
