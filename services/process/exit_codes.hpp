/// How every interply program ends.
#pragma once

namespace interply::process {

enum ExitCode {
  kDone = 0,
  kFailed = 1,     ///< the program itself: a file that cannot be written, no memory
  kRefused = 2,    ///< scene, law or command line; nothing was started
  kDiverged = 3,   ///< the mechanics
  kLost = 4,       ///< a participant
  kCancelled = 5,  ///< by a signal
};

}  // namespace interply::process
