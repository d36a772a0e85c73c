#include "launch/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cctype>

namespace interply::launch {
namespace {

constexpr std::chrono::milliseconds kOnTerminal{400};
constexpr std::chrono::seconds kInLog{5};

/// Columns of an overwritten line, which must stay on one row.
std::size_t find_columns(int descriptor) {
  winsize size{};
  const bool known = ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return known ? size.ws_col - 1u : 120u;
}

// The cursor rests at the beginning of the progress: in a terminal that has become narrower meanwhile and has broken
// the line into several, "down to the end of the screen" is the whole of it.
constexpr const char* kErase = "\r\x1b[J";

}  // namespace

std::string fit_items(const std::string& text, std::size_t columns) {
  if (text.size() <= columns) return text;
  std::size_t end = 0;
  for (std::size_t at = 0; (at = text.find("  ", at)) != text.npos && at <= columns; ++at)
    if (at + 2 < text.size() && std::isalpha(static_cast<unsigned char>(text[at + 2])) != 0) end = at;
  return text.substr(0, end > 0 ? end : columns);
}

Terminal::Terminal(std::FILE* out, bool quiet) : out_(out), quiet_(quiet), overwrite_(isatty(fileno(out)) != 0) {}

void Terminal::show_progress(const std::string& text) {
  if (quiet_) return;
  latest_ = text;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  if (overwrite_) {
    next_ = now + kOnTerminal;
    shown_ = fit_items(text, find_columns(fileno(out_)));
    std::fprintf(out_, "%s%s\r", kErase, shown_.c_str());
  } else {
    next_ = now + kInLog;
    shown_ = text;
    std::fprintf(out_, "%s\n", text.c_str());
  }
  std::fflush(out_);
}

void Terminal::clear_progress() {
  if (overwrite_ && !shown_.empty()) std::fputs(kErase, out_);
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

void Terminal::pause() {
  clear_progress();
  std::fflush(out_);
  next_ = {};
}

}  // namespace interply::launch
