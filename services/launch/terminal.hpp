/// What the person who started a run sees.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>

namespace interply::launch {

/// The first items of a line of progress that fit into so many columns as a whole. An item begins with a letter after
/// two blanks. Only a first item that is too long by itself is cut.
std::string fit_items(const std::string& text, std::size_t columns);

/// Progress on one line that is overwritten, if `out` is a terminal; otherwise a plain line every five seconds.
/// `quiet` shows neither progress nor notes.
class Terminal {
 public:
  explicit Terminal(std::FILE* out, bool quiet);
  void show_progress(const std::string& text);
  /// A line that stays: what happened.
  void note(const std::string& text);
  /// A line that stays and is shown even if quiet.
  void print(const std::string& text);
  /// Ends the progress line, with the last progress in full.
  void end_progress();
  /// Leaves the terminal to somebody else until the next progress.
  void pause();

 private:
  void clear_progress();

  std::FILE* out_;
  bool quiet_, overwrite_;
  std::string shown_, latest_;
  std::chrono::steady_clock::time_point next_;
};

}  // namespace interply::launch
