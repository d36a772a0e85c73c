#include "coordinator/pace.hpp"

#include <algorithm>
#include <cmath>

namespace interply::coordinator {

Pace::Pace(const scene::Scene& scene)
    : safety_(scene.time.safety),
      end_(scene.end_time()),
      frame_every_(scene.record.frames > 0 ? end_ / scene.record.frames : 2 * end_),
      row_every_(end_ / std::max(1, scene.record.history - 1)),
      row_steps_(scene.record.history_every),
      frame_(scene.record.frames > 0 ? 0 : -1),
      frames_(scene.record.frames) {}

double Pace::choose(const Votes& votes, double time) const {
  constexpr double kGrowth = 1.05;  // a softening tangent is followed slowly, a stiffening one at once
  double dt = std::min(frame_every_, safety_ * votes.stack);  // at most one frame a step
  if (next_dt_ > 0) dt = std::min(dt, kGrowth * next_dt_);
  // Land on the end without a tiny last step, by a per cent less from far enough: next to the stability limit the
  // energy of the fastest mode, 1 - (omega dt/2)^2 of what its speed says, would jump with the increment.
  const double left = end_ - time, steps = std::ceil(left / dt * (1 - 1e-9));
  return steps < 100 ? left / std::max(1.0, steps) : dt;
}

void Pace::start(const Votes& votes) { next_dt_ = choose(votes, 0); }

void Pace::advance(const Votes& votes) {
  ++step_;
  time_ += next_dt_;
  dt_ = next_dt_;
  last_ = time_ >= end_ * (1 - 1e-12);
  next_dt_ = last_ ? dt_ : choose(votes, time_);
  mark();
}

void Pace::mark() {
  frame_ = -1;
  if (frames_ > 0 && next_frame_ <= frames_ && (last_ || time_ >= next_frame_ * frame_every_ * (1 - 1e-12))) {
    frame_ = next_frame_++;
  }
  row_ = last_;
  if (row_steps_ > 0) {
    row_ = row_ || step_ % row_steps_ == 0;
  } else if (time_ >= static_cast<double>(next_row_) * row_every_) {
    row_ = true;
    next_row_ = static_cast<std::int64_t>(time_ / row_every_) + 1;
  }
}

}  // namespace interply::coordinator
