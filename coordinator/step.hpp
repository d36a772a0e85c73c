/// One step of the laminate, stage by stage: tools move, motions arrive, each interface is computed as soon as both
/// partners are there, forces leave as soon as both faces of a layer are done, the blank holder follows, books and
/// votes close the step.
#pragma once

#include <string>
#include <vector>

#include "coordinator/coordinator.hpp"
#include "coordinator/energy_balance.hpp"
#include "coordinator/measurements.hpp"
#include "coordinator/pace.hpp"
#include "coordinator/plausibility.hpp"
#include "coordinator/stack.hpp"

namespace interply::coordinator {

class Forming {
 public:
  Forming(const scene::Scene& scene, exchange::CoordinatorLink& link, observe::Sink& sink);

  /// What no layer can send, in the motion of layer `who` that has arrived (plausibility.hpp); empty: nothing.
  std::string find_fault(int who) const { return checks_[static_cast<std::size_t>(who)].find_fault(link_.motion(who)); }

  // The stages of step n, in order.
  /// Tools go to t(n); nobody has arrived yet.
  void begin_step();
  /// The motion of layer `who`, the contact that it completes, and the forces that this completes.
  /// False if a force could not be delivered (`lost()` says whose).
  bool take_motion(int who);
  bool is_step_complete() const { return stack_.is_step_complete(); }
  /// Once, at step 0, when all motions are there: their votes give the first increment, and the forces may leave.
  bool start();
  /// Blank holder, books, measurements, frame and row, votes, and on to step n + 1 unless this was the last.
  /// @throws mechanics::Divergence if the energy residual has passed its limit
  void finish_step();
  /// Wall time of the step just finished.
  void note_time(const StepTime& time) { measurements_.note_own_time(time); }

  /// Energies of the final state, once every layer has sent its Final.
  EnergyBalance balance_end(const std::vector<exchange::Final>& finals) const;
  /// Its residual / the largest energies so far.
  double final_residual(const EnergyBalance& end) const { return end.residual() / std::max(scale_, end.scale()); }
  void put_history_row(const EnergyBalance& balance);
  std::int64_t rows() const { return rows_; }  ///< of the history, put so far

  const Pace& pace() const { return pace_; }
  const Stack& stack() const { return stack_; }
  const Measurements& measurements() const { return measurements_; }
  const BlankHolder& holder() const { return holder_; }
  double residual() const { return residual_; }  ///< of the last step with known layer energies, / scale
  int lost() const { return lost_; }
  double stroke() const { return travel_; }
  double compute_stroke(double time) const;  ///< of the punch at any time (s), mm
  double punch_force() const { return stack_.punch() ? stack_.punch()->force.z() : 0; }
  double holder_force() const { return stack_.blank_holder().force.z(); }

 private:
  bool send_forces();
  void check_balance();
  void close_books();
  void publish_frame();

  const scene::Scene& scene_;
  exchange::CoordinatorLink& link_;
  observe::Sink& sink_;
  Stack stack_;
  std::vector<Plausibility> checks_;  ///< per layer
  Pace pace_;
  BlankHolder holder_;
  Measurements measurements_;
  double scale_;  ///< largest energies so far, which the residual is measured against, mJ
  Votes votes_;
  std::vector<exchange::LayerEnergies> layer_energies_;  ///< at step n - 1, from the motions of step n
  std::vector<exchange::Force> forces_;
  CoordinatorEnergies energies_;  ///< at step n - 1 until close_books()
  EnergyBalance balance_;
  double travel_ = 0, old_punch_force_ = 0, residual_ = 0;
  std::int64_t rows_ = 0;
  int lost_ = -1;
};

}  // namespace interply::coordinator
