/// What the coordinator's process says: sentences for a person, or lines that a launcher reads.
#pragma once

#include <memory>
#include <string>

#include "coordinator/coordinator.hpp"

namespace interply::coordinator {

/// For a launcher every line but a note begins with a word: "@bound ADDRESS", "@progress LINE", "@summary LINE",
/// "@json LINE", "@digest DIGITS", "@reason SENTENCE" (of an early end). Progress is left out rather than waited for
/// where nobody reads: a launcher that is stopped keeps no run.
class Voice {
 public:
  virtual ~Voice() = default;
  /// Where the coordinator listens, and whom it waits for.
  /// @param recorder  a recorder, too
  virtual void say_address(const std::string& address, const scene::Scene& scene, bool recorder) = 0;
  virtual void show_progress(const Progress& progress) = 0;
  virtual void note(const std::string& line) = 0;
  /// How a run has ended. @param frames  that its record was to hold
  virtual void say_end(const Outcome& outcome, int frames) = 0;
  /// Why nothing has begun.
  virtual void say_reason(const std::string& sentence) = 0;
};

std::unique_ptr<Voice> make_voice(bool for_launcher);

}  // namespace interply::coordinator
