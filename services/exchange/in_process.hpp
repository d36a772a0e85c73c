/// The link inside one process: solvers are threads, a message is one copy of its arrays.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "exchange/link.hpp"

namespace interply::exchange {

/// Where the threads of one process meet. Checks what the ZeroMQ link checks, in the same words. A solver's link that
/// is destroyed before its Final or failure was sent (its thread died) is reported as Suspect.
class InProcessHub {
 public:
  /// @param scene_digest  of the scene that all threads have: a Welcome from here holds no text
  InProcessHub(std::uint64_t scene_digest, std::vector<Expected> expected);
  /// Closes. Links of solvers may outlive the hub.
  ~InProcessHub();
  InProcessHub(const InProcessHub&) = delete;
  InProcessHub& operator=(const InProcessHub&) = delete;

  CoordinatorLink& coordinator() { return *coordinator_; }
  /// A link for one solver; used by one thread. Callable from any thread.
  std::unique_ptr<SolverLink> connect();
  /// The coordinator has left: whoever waits or will wait for it gets CoordinatorLost. Callable from any thread.
  void close();

  struct State;

 private:
  std::shared_ptr<State> state_;
  std::unique_ptr<CoordinatorLink> coordinator_;
};

}  // namespace interply::exchange
