/// A point in time that no wait goes past.
#pragma once

#include <algorithm>
#include <chrono>
#include <compare>

namespace interply::exchange {

/// Whoever waits asks passed() and sleeps for left() in turn, at most kLook at a time. Two looks that are much further
/// apart mean that this process itself was stopped meanwhile, perhaps with all others (Ctrl-Z): that time does not
/// count, and what was on its way may still arrive.
class Deadline {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kLook{1000};

  /// @param seconds  from now; negative counts as 0, more than a year as a year
  explicit Deadline(double seconds, Clock::time_point now = Clock::now())
      : time_(now + std::chrono::duration_cast<Clock::duration>(
                        std::chrono::duration<double>(std::clamp(seconds, 0.0, 3.2e7)))),
        seen_(now) {}
  auto operator<=>(const Deadline&) const = default;
  bool passed(Clock::time_point now = Clock::now()) {
    if (now - seen_ > 2 * kLook) time_ += now - seen_ - kLook;
    seen_ = now;
    return now >= time_;
  }
  /// Until the deadline or the next look, rounded up, for calls that count in milliseconds.
  std::chrono::milliseconds left() const {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(time_ - Clock::now());
    return std::clamp(left, std::chrono::milliseconds(0), kLook);
  }

 private:
  Clock::time_point time_, seen_;
};

}  // namespace interply::exchange
