#include "observe/quiet_log.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

namespace interply::observe {

std::string to_line(std::string_view text) {
  while (!text.empty() && text.back() == '\n') text.remove_suffix(1);
  std::string line(text.substr(0, 300));
  std::replace_if(line.begin(), line.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return line;
}

void QuietLog::warn(std::string_view text) {
  std::uint64_t unsaid = 0;
  {
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = Clock::now();
    if (now < next_) {
      ++unsaid_;
      return;
    }
    next_ = now + std::chrono::seconds(1);
    std::swap(unsaid, unsaid_);
  }
  if (unsaid == 0) {
    spdlog::warn("{}", to_line(text));
  } else {
    spdlog::warn("{} (and {} such lines before it)", to_line(text), unsaid);
  }
}

}  // namespace interply::observe
