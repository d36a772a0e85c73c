/// Who is waited for, since when, and when that is said: the ladder 5, 10, 20, 40 ... s.
#pragma once

#include <chrono>
#include <string>

namespace interply::coordinator {

class Waiting {
 public:
  using Clock = std::chrono::steady_clock;

  void restart() {
    start_ = Clock::now();
    next_ = 5;
  }
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  /// True once per rung.
  bool is_due() {
    if (seconds() < next_) return false;
    next_ *= 2;
    return true;
  }

 private:
  Clock::time_point start_ = Clock::now();
  double next_ = 5;
};

}  // namespace interply::coordinator
