/// Time: one increment for all, from the votes of the layers and of contact; frames and the end on their instants.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace interply::coordinator {

/// Largest stable increments, s.
struct Votes {
  std::vector<double> layers;  ///< of each layer alone
  double contact = 0;          ///< of contact between layers that are nothing but masses
  double stack = 0;            ///< of all together
  int fastest = 0;             ///< layer that moves most in the stack's fastest mode; their number: the blank holder
};

class Pace {
 public:
  Pace(const scene::Scene& scene);

  std::int64_t step() const { return step_; }
  double time() const { return time_; }             ///< t(n), s
  double dt() const { return dt_; }                 ///< t(n) - t(n - 1), s
  double next_dt() const { return next_dt_; }       ///< t(n + 1) - t(n), s; known when step n begins (n > 0)
  bool is_started() const { return next_dt_ > 0; }  ///< the first increment is known
  bool is_last() const { return last_; }            ///< step n is the final state
  int frame() const { return frame_; }              ///< number of the frame to publish at step n, or -1
  bool has_row() const { return row_; }             ///< a history row is due at step n

  /// Before step 0 is answered: the increment of the first step from the first votes.
  void start(const Votes& votes);
  /// From step n to n + 1, with the votes of step n for the increment after that.
  void advance(const Votes& votes);

 private:
  double choose(const Votes& votes, double time) const;
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
