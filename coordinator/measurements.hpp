/// What a run measures of itself, step by step. Looks on: nothing here decides what comes next.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coordinator/energy_balance.hpp"
#include "coordinator/pace.hpp"
#include "coordinator/stack.hpp"
#include "observe/frames.hpp"

namespace interply::coordinator {

/// Where the kinetic energy was largest while the punch moved, and the work that the tools had done by then.
struct Inertia {
  double kinetic = 0, work = 0;  ///< mJ
  double time = 0;               ///< s
};

/// Wall time of one step of a participant, s.
struct StepTime {
  double step = 0;
  double wait = 0;  ///< of that, waiting for others
};

class Measurements {
 public:
  Measurements(const scene::Scene& scene, int n_interfaces);

  void note_layer_time(int layer, const StepTime& time);
  void note_own_time(const StepTime& time);
  /// @param residual  / energy scale   @param time  of the balance, s
  void note_balance(const EnergyBalance& balance, double residual, double time);
  /// Contact and blank holder of the step that ends. @param interfaces  their energies
  void note_contact(const std::vector<contact::InterfaceEnergies>& interfaces);
  void note_blank_holder(double force, double target, const Pace& pace);
  /// Penetration of a frame.
  void note_frame(const Stack& stack);
  /// Whether layers are pressed past each other's midsurfaces, where a pair has no meaning.
  void note_depth(const Stack& stack, double time);
  /// The times of the steps since the last row, as means per step, go into the row and start anew.
  void put_times_into(observe::HistoryRow& row);

  double largest_residual() const { return largest_residual_; }  ///< / energy scale
  const Inertia& inertia() const { return inertia_; }
  /// By interface: whether any node has ever been pressed.
  const std::vector<bool>& touched() const { return touched_; }
  /// Penetration / thickness of the thinner partner: what 99 % of the contact area of all interfaces together stays
  /// below in the worst frame so far, and the peak over all frames.
  double penetration_99() const { return penetration_99_; }
  double penetration_peak() const { return penetration_peak_; }
  /// Largest deviation of the blank-holder force from its target after the ramp, / target.
  double holder_deviation() const { return holder_deviation_; }
  /// Mean of the blank-holder force after the ramp, N. @param now  the force; before the end of the ramp it is returned
  double holder_mean(double now) const { return holder_time_ > 0 ? holder_impulse_ / holder_time_ : now; }
  /// Where and when layers were first pressed too deep, a sentence; empty: nowhere.
  const std::string& too_soft() const { return too_soft_; }

 private:
  const scene::Scene& scene_;
  std::vector<StepTime> layer_times_;  ///< sums since the last history row
  StepTime own_time_;
  std::int64_t steps_since_row_ = 0;
  double largest_residual_ = 0;
  Inertia inertia_;
  std::vector<bool> touched_;
  double penetration_99_ = 0, penetration_peak_ = 0;
  double holder_deviation_ = 0, holder_impulse_ = 0, holder_time_ = 0;
  std::string too_soft_;
};

/// Of all interfaces now.
contact::PenetrationSample sample_penetration(const Stack& stack);

}  // namespace interply::coordinator
