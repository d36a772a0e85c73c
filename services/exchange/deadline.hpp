/// A point in time that no wait goes past.
#pragma once

#include <algorithm>
#include <chrono>
#include <compare>

namespace interply::exchange {

class Deadline {
 public:
  using Clock = std::chrono::steady_clock;
  /// @param seconds  from now; negative counts as 0, more than a year as a year
  explicit Deadline(double seconds)
      : time_(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                 std::chrono::duration<double>(std::clamp(seconds, 0.0, 3.2e7)))) {}
  Clock::time_point time() const { return time_; }
  auto operator<=>(const Deadline&) const = default;
  bool passed() const { return Clock::now() >= time_; }
  /// Time left, rounded up, for calls that count in milliseconds.
  std::chrono::milliseconds left() const {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(time_ - Clock::now());
    return std::max(left, std::chrono::milliseconds(0));
  }

 private:
  Clock::time_point time_;
};

}  // namespace interply::exchange
