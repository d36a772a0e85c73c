/// Who is waited for, since when, and when that is said: the ladder 5, 10, 20, 40 ... s.
#pragma once

#include <algorithm>
#include <chrono>

namespace interply::coordinator {

/// Whoever waits looks several times a second. Between two looks that are further apart this process itself was
/// stopped, perhaps with all others (Ctrl-Z): that is nobody's silence and counts as one second.
class Waiting {
 public:
  using Clock = std::chrono::steady_clock;
  explicit Waiting(Clock::time_point now = Clock::now()) : seen_(now) {}

  void restart(Clock::time_point now = Clock::now()) { *this = Waiting(now); }
  /// Waited so far.
  double seconds(Clock::time_point now = Clock::now()) {
    waited_ += std::min<Clock::duration>(now - seen_, std::chrono::seconds(1));
    seen_ = now;
    return std::chrono::duration<double>(waited_).count();
  }
  /// True once per rung.
  bool is_due(Clock::time_point now = Clock::now()) {
    if (seconds(now) < next_) return false;
    next_ *= 2;
    return true;
  }

 private:
  Clock::time_point seen_;
  Clock::duration waited_{};
  double next_ = 5;
};

}  // namespace interply::coordinator
