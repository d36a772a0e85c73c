/// A user's own law runs in our process: if it ends that process (STOP, exit, abort, a crash), it is named.
#pragma once

#include <string>

namespace interply::solve {

/// Exit code of a process that a law ended, as of one that was lost.
inline constexpr int kEndedByLaw = 4;

/// Whom to name.
struct LawName {
  std::string text;  ///< "layer sheet: law.vumat.library: /path/liblaw.so"
  /// flush of the Fortran runtime behind the library, or nothing: what its units still hold are the law's last words
  void (*flush)(const int* unit) = nullptr;
};

/// While one lives, this thread is in the law's code. If the process ends meanwhile, its last line on stderr is
/// "TEXT ended the process that called it: HOW", and its exit code kEndedByLaw, whatever the law gave to exit.
/// _exit() alone cannot be caught.
class LawCall {
 public:
  explicit LawCall(const LawName& law);
  ~LawCall();
  LawCall(const LawCall&) = delete;
  LawCall& operator=(const LawCall&) = delete;
};

/// Makes LawCall work in this process, and the law's output unbuffered; before its library is loaded. Again: nothing.
void install_law_guard();
/// The last line goes to this file descriptor instead of stderr.
void report_law_to(int descriptor);
/// Ends the process in the name of the law that is being called. @param how  for the last line
[[noreturn]] void end_by_law(const char* how);

}  // namespace interply::solve
