#include "observe/quiet_log.hpp"

#include <spdlog/spdlog.h>

#include <string>
#include <utility>

#include "process/words.hpp"

namespace interply::observe {

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
  while (text.ends_with('\n')) text.remove_suffix(1);
  const std::string line = process::to_line(text, 300);
  if (unsaid == 0) {
    spdlog::warn("{}", line);
  } else {
    spdlog::warn("{} (and {} such lines before it)", line, unsaid);
  }
}

}  // namespace interply::observe
