/// Warnings that others can cause at any rate: at most one line a second. Internal to observe.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string_view>

namespace interply::observe {

class QuietLog {
 public:
  /// Logs `text`, printable and not too long, or only counts it if the last line is less than a second old.
  void warn(std::string_view text);

 private:
  using Clock = std::chrono::steady_clock;
  std::mutex mutex_;
  Clock::time_point next_{};
  std::uint64_t unsaid_ = 0;
};

}  // namespace interply::observe
