/// How long a run will still take: forming time per wall time of the last few seconds, since the increment changes.
#pragma once

#include <optional>

namespace interply::coordinator {

class TimeLeft {
 public:
  /// @param end_time  of the forming, s
  explicit TimeLeft(double end_time) : end_time_(end_time) {}

  /// After every step.
  /// @param time  forming time that was reached, s   @param wall  wall time from any origin, s
  void note(double time, double wall) {
    if (!start_) start_ = {time, wall};
    const double step = wall - latest_.wall;
    if (usual_step_ > 0 && step > kGap && step > kUnusual * usual_step_) {
      start_->wall += step;  // somebody was waited for, or all were stopped: nobody formed meanwhile
      usual_step_ *= 2;      // steps that have become so slow are believed after a few
    } else if (noted_ > 0) {
      usual_step_ += (noted_ == 1 ? 1 : kMemory) * (step - usual_step_);
    }
    ++noted_;
    latest_ = {time, wall};
    if (wall - start_->wall < kWindow) return;
    rate_ = (time - start_->time) / (wall - start_->wall);
    start_ = latest_;
  }
  /// Wall time until the end, s; < 0: not known yet.
  double seconds() const { return rate_ > 0 ? (end_time_ - latest_.time) / rate_ : -1; }

 private:
  static constexpr double kWindow = 3, kGap = 5;  ///< s
  static constexpr double kUnusual = 10, kMemory = 0.1;
  struct Instant {
    double time = 0, wall = 0;  ///< s
  };
  double end_time_;
  std::optional<Instant> start_;  ///< of the window
  Instant latest_;
  long noted_ = 0;
  double usual_step_ = 0, rate_ = 0;  ///< wall time of a step, s; forming time / wall time
};

}  // namespace interply::coordinator
