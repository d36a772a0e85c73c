/// One step of the laminate: tools move, motions arrive, interfaces are computed as soon as both partners are there,
/// forces leave as soon as both faces are done, books and votes close the step.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "coordinator/coordinator.hpp"
#include "coordinator/energy_balance.hpp"
#include "coordinator/pace.hpp"
#include "coordinator/plausibility.hpp"
#include "coordinator/stack.hpp"

namespace interply::coordinator {

/// Where the kinetic energy was largest while the punch moved, and the work that the tools had done by then.
struct Inertia {
  double kinetic = 0, work = 0;  ///< mJ
  double time = 0;               ///< s
};

class Forming {
 public:
  Forming(const scene::Scene& scene, exchange::CoordinatorLink& link, observe::Sink& sink);

  void begin_step();
  /// What no layer can send, in the motion of layer `who` that has arrived (plausibility.hpp); empty: nothing.
  std::string find_fault(int who) const { return checks_[static_cast<std::size_t>(who)].find_fault(link_.motion(who)); }
  /// Takes the motion of layer `who`. False if an answer could not be delivered (`lost()` says whose).
  bool take_motion(int who);
  bool is_step_complete() const { return stack_.is_step_complete(); }
  /// Closes step n and goes on to n + 1 unless it was the last.
  /// @throws mechanics::Divergence if the energy residual has passed its limit
  void finish_step();

  /// Energies of the final state, once every layer has sent its Final.
  EnergyBalance balance_end(const std::vector<exchange::Final>& finals) const;
  /// Its residual / the largest energies so far.
  double final_residual(const EnergyBalance& end) const { return end.residual() / std::max(scale_, end.scale()); }
  void put_history_row(const EnergyBalance& balance);
  std::int64_t rows() const { return rows_; }  ///< of the history, put so far

  const Pace& pace() const { return pace_; }
  const Stack& stack() const { return stack_; }
  const EnergyBalance& balance() const { return balance_; }  ///< of the last step with known layer energies
  double residual() const { return residual_; }              ///< residual / scale, the same step
  double largest_residual() const { return largest_residual_; }
  const Inertia& inertia() const { return inertia_; }
  int lost() const { return lost_; }
  /// Where and when layers were first pressed past each other's midsurfaces, where a pair has no meaning; empty:
  /// nowhere.
  const std::string& too_soft() const { return too_soft_; }
  /// By interface: whether any node has ever been pressed.
  const std::vector<bool>& touched() const { return touched_; }
  double stroke() const { return travel_; }
  double compute_stroke(double time) const;  ///< of the punch at any time (s), mm
  double punch_force() const { return stack_.punch() ? stack_.punch()->force.z() : 0; }
  double holder_force() const { return stack_.blank_holder().force.z(); }
  const BlankHolder& holder() const { return holder_; }
  /// Penetration / thickness of the thinner partner: what 99 % of the contact area of all interfaces together stays
  /// below in the worst frame so far, and the peak over all frames.
  double penetration_99() const { return penetration_99_; }
  double penetration_peak() const { return penetration_peak_; }
  /// Largest deviation of the blank-holder force from its target after the ramp, / target; and of its mean.
  double holder_deviation() const { return holder_deviation_; }
  double holder_mean() const { return holder_time_ > 0 ? holder_impulse_ / holder_time_ : holder_force(); }

  double step_seconds = 0, wait_seconds = 0;  ///< wall time of the last step, set by the loop

 private:
  void answer(int i);
  void check_balance();
  void measure();
  void note_too_soft();
  contact::PenetrationSample sample_penetration() const;
  void publish_frame();

  const scene::Scene& scene_;
  exchange::CoordinatorLink& link_;
  observe::Sink& sink_;
  Stack stack_;
  std::vector<Plausibility> checks_;  ///< per layer
  Pace pace_;
  BlankHolder holder_;
  double scale_;  ///< largest energies so far, which the residual is measured against, mJ
  Votes votes_;
  std::vector<exchange::LayerEnergies> layer_energies_;  ///< at step n - 1, from the motions of step n
  std::vector<exchange::Force> forces_;
  CoordinatorEnergies energies_;  ///< at step n - 1 until finish_step()
  EnergyBalance balance_;
  Inertia inertia_;
  double travel_ = 0, old_punch_force_ = 0, residual_ = 0, largest_residual_ = 0;
  double holder_deviation_ = 0, holder_impulse_ = 0, holder_time_ = 0;
  double penetration_99_ = 0, penetration_peak_ = 0;
  std::vector<double> step_sums_, wait_sums_;  ///< per layer since the last history row, s
  double own_step_sum_ = 0, own_wait_sum_ = 0;
  std::int64_t steps_since_row_ = 0, rows_ = 0;
  int lost_ = -1;
  std::string too_soft_;
  std::vector<bool> touched_;  ///< by interface
};

}  // namespace interply::coordinator
