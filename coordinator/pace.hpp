/// Time: one increment for all, from the votes of the layers and of contact; frames and the end on their instants.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace interply::coordinator {

/// What one layer may do: its own vote and what contact adds to its frequencies.
struct Vote {
  double increment = 0;     ///< stable increment of the layer alone, s
  double contact_rate = 0;  ///< largest row sum of M^-1 K of its contact, 1/s2
  double damping_rate = 0;  ///< largest row sum of M^-1 C of its contact, 1/s
};

/// Stable increment of a layer in contact, whose damping acts on the velocity half a step ago:
/// dt^2 ((2/vote)^2 + contact_rate) + 2 dt damping_rate = 4                                                   (D1)
///
/// A mode z^n x of x(n+1) - 2 x(n) + x(n-1) + dt M^-1 C (x(n) - x(n-1)) + dt^2 M^-1 K x(n) = 0, multiplied by x* M, is a
/// quadratic equation for z with the real coefficients dt c and dt^2 k; |z| <= 1 as long as dt^2 k + 2 dt c <= 4, and
/// k and c are at most the largest eigenvalues, those of sums of symmetric matrices at most the sums of theirs. For one
/// oscillator with damping zeta this is dt <= (2/omega)(sqrt(1 + zeta^2) - zeta). The fraction of critical damping of
/// a stack's fastest mode is more than that of a pair.
double compute_increment(const Vote& vote);

class Pace {
 public:
  Pace(const scene::Scene& scene);

  std::int64_t step() const { return step_; }
  double time() const { return time_; }        ///< t(n), s
  double dt() const { return dt_; }            ///< t(n) - t(n - 1), s
  double next_dt() const { return next_dt_; }  ///< t(n + 1) - t(n), s; known when step n begins (n > 0)
  bool is_last() const { return last_; }       ///< step n is the final state
  int frame() const { return frame_; }         ///< number of the frame to publish at step n, or -1
  bool has_row() const { return row_; }        ///< a history row is due at step n

  /// Before step 0 is answered: the increment of the first step from the first votes.
  void start(const std::vector<Vote>& votes);
  /// From step n to n + 1, with the votes of step n for the increment after that.
  void advance(const std::vector<Vote>& votes);

 private:
  double choose(const std::vector<Vote>& votes, double time) const;
  void mark();

  double safety_, end_, frame_every_, row_every_;
  int row_steps_;
  std::int64_t step_ = 0;
  double time_ = 0, dt_ = 0, next_dt_ = 0;
  bool last_ = false, row_ = true;
  int frame_ = 0, frames_ = 0;
  int next_frame_ = 1;
  std::int64_t next_row_ = 1;
};

}  // namespace interply::coordinator
