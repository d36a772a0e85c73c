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
      measurements_(scene, stack_.n_interfaces()),
      scale_(compute_least_scale(stack_.mass(),
                                 stack_.punch() ? kSteepest * scene.motion.stroke / scene.motion.forming_time : 0,
                                 scene.tools.blank_holder.pressure * stack_.flange_area(), stack_.stiffness())),
      layer_energies_(scene.layers.size()),
      forces_(scene.layers.size()) {
  energies_.interfaces.resize(static_cast<std::size_t>(stack_.n_interfaces()));
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
  layer_energies_[static_cast<std::size_t>(who)] = motion.energies;
  measurements_.note_layer_time(who, {motion.step_seconds, motion.wait_seconds});
  stack_.take_motion(who, motion.position, motion.thickness, motion.vote);
  stack_.compute_contact_of(who, pace_.dt());
  return !pace_.is_started() || send_forces();
}

bool Forming::start() {
  votes_ = stack_.collect_votes();
  pace_.start(votes_);
  return send_forces();
}

bool Forming::send_forces() {
  for (int i = 0; i < stack_.n_layers(); ++i) {
    if (!stack_.can_send_force(i)) continue;
    exchange::Force& force = forces_[static_cast<std::size_t>(i)];
    force.step = pace_.step();
    force.time = pace_.time();
    force.next_dt = pace_.next_dt();
    force.frame = pace_.frame();
    force.last = pace_.is_last();
    stack_.sum_force(i, force.force);
    if (!link_.send(i, force)) lost_ = i;
  }
  return lost_ < 0;
}

void Forming::finish_step() {
  check_balance();  // of step n - 1, whose layer energies came with the motions of step n
  holder_.kick(pace_.time(), holder_force(), pace_.dt(), pace_.next_dt());
  close_books();
  measurements_.note_contact(energies_.interfaces);
  measurements_.note_blank_holder(holder_force(), holder_.target(), pace_);
  if (pace_.frame() >= 0) publish_frame();
  if (pace_.is_last()) return;
  if (pace_.has_row()) put_history_row(balance_);
  if (pace_.step() % scene_.time.vote_every == 0) {
    votes_ = stack_.collect_votes();
    measurements_.note_depth(stack_, pace_.time());
  }
  pace_.advance(votes_);
}

void Forming::check_balance() {
  assemble_balance(layer_energies_, energies_, balance_);
  scale_ = std::max(scale_, balance_.scale());
  residual_ = balance_.residual() / scale_;
  measurements_.note_balance(balance_, residual_, pace_.time() - pace_.dt());
  if (std::abs(residual_) <= scene_.time.energy_limit) return;
  const auto worst = explain_residual(scene_, balance_);
  throw mechanics::Divergence(fmt::format(
      "energy residual {:.3g} % of {:.4g} mJ passed its limit {:.3g} % at step {}, time {:.6g} s: largest share {} "
      "({:.3g} mJ); likely cure: {}",
      100 * residual_, scale_, 100 * scene_.time.energy_limit, pace_.step() - 1, pace_.time(), worst.name, worst.value,
      worst.cure));
}

/// What the coordinator's own participants hold at step n.
void Forming::close_books() {
  if (stack_.punch()) energies_.punch_work -= 0.5 * (old_punch_force_ + punch_force()) * stack_.punch()->increment;
  old_punch_force_ = punch_force();
  for (int k = 0; k < stack_.n_interfaces(); ++k)
    energies_.interfaces[static_cast<std::size_t>(k)] = stack_.energies(k);
  energies_.blank_holder = holder_.energies();
}

void Forming::publish_frame() {
  measurements_.note_frame(stack_);
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
  row.peak_penetration = sample_penetration(stack_).peak();
  row.votes = votes_.layers;
  row.contact_vote = votes_.contact;
  row.layer_kinetic = b.layer_kinetic;
  row.layer_internal = b.layer_internal;
  row.layer_residual = b.layer_residual;
  row.interface_residual = b.interface_residual;
  row.interface_friction = b.interface_friction;
  measurements_.put_times_into(row);
  ++rows_;
  sink_.put(row);
}

}  // namespace interply::coordinator
