#include "launch/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

namespace interply::launch {
namespace {

constexpr std::chrono::milliseconds kOnTerminal{400};
constexpr std::chrono::seconds kInLog{5};

/// Keeps an overwritten line on one row.
std::string cut_to_width(const std::string& text, int descriptor) {
  winsize size{};
  const bool known = ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return text.substr(0, known ? size.ws_col - 1u : 120u);
}

}  // namespace

Terminal::Terminal(std::FILE* out, bool quiet) : out_(out), quiet_(quiet), overwrite_(isatty(fileno(out)) != 0) {}

void Terminal::show_progress(const std::string& text) {
  if (quiet_) return;
  latest_ = text;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  if (overwrite_) {
    next_ = now + kOnTerminal;
    shown_ = cut_to_width(text, fileno(out_));
    std::fprintf(out_, "\r%s\x1b[K", shown_.c_str());
  } else {
    next_ = now + kInLog;
    shown_ = text;
    std::fprintf(out_, "%s\n", text.c_str());
  }
  std::fflush(out_);
}

void Terminal::clear_progress() {
  if (overwrite_ && !shown_.empty()) std::fputs("\r\x1b[K", out_);
  shown_.clear();
}

void Terminal::note(const std::string& text) {
  if (!quiet_) print(text);
}

void Terminal::print(const std::string& text) {
  clear_progress();
  std::fprintf(out_, "%s\n", text.c_str());
  std::fflush(out_);
}

void Terminal::end_progress() {
  if (latest_.empty()) return;
  if (overwrite_ || latest_ != shown_) print(latest_);
  latest_.clear();
  shown_.clear();
}

}  // namespace interply::launch
