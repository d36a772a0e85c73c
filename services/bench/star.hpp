/// The star exchange that every carrier of the benchmark carries out: one hub and P peers, in lock-step as a run does
/// it. In each step every peer sends a motion [3 x n_nodes] and gets a force [3 x n_nodes]; the hub answers when it has
/// all motions. Both arrays lie in memory of the participant itself, before and after: no carrier lends its buffers.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace interply::bench {

struct StarSize {
  int peers = 1;
  int nodes = 1;
  std::size_t values() const { return 3 * static_cast<std::size_t>(nodes); }  ///< doubles per message
};

/// Longest sleep before a waiting participant looks around, s.
inline constexpr double kSlice = 0.1;
/// Called by whoever has waited for a slice in vain; throws when there is a reason to wait no longer.
using Watch = std::function<void()>;

class Peer {
 public:
  virtual ~Peer() = default;
  virtual double* motion() = 0;       ///< [3 x n_nodes], to be filled before exchange(); keeps its values
  virtual const double* force() = 0;  ///< [3 x n_nodes], of the last exchange()
  /// Sends the motion and waits for its answer. True if it is the last one.
  virtual bool exchange(std::int64_t step) = 0;
  /// Says good-bye after the last exchange.
  virtual void finish() {}
};

class Hub {
 public:
  virtual ~Hub() = default;
  /// What a peer's process needs to find this hub.
  virtual std::string address() const { return "-"; }
  /// Peer as a thread of this process; null if this carrier's peers are processes. Callable from any thread.
  virtual std::unique_ptr<Peer> connect_thread(int /*peer*/) { return nullptr; }

  /// Waits until every peer is here.
  virtual void accept() = 0;
  /// Waits until all motions of this step are here.
  virtual void gather(std::int64_t step) = 0;
  virtual const double* motion(int peer) = 0;  ///< [3 x n_nodes], of the last gather()
  virtual double* force(int peer) = 0;         ///< [3 x n_nodes], to be filled before scatter(); keeps its values
  /// Sends each peer its force.
  virtual void scatter(std::int64_t step, bool last) = 0;
  virtual void finish() {}
};

}  // namespace interply::bench
