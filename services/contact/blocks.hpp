/// Loops of contact in parts that anyone may run, in any order and by any number of threads: different parts write to
/// different places, and sums are kept by part and added in their order.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <functional>

namespace interply::contact {

inline constexpr Eigen::Index kBlockSize = 256;  ///< points per block
inline Eigen::Index count_blocks(Eigen::Index n) { return (n + kBlockSize - 1) / kBlockSize; }

/// Runs the parts of a loop.
class BlockRunner {
 public:
  using Body = std::function<void(Eigen::Index i)>;
  /// Calls body(i) once for each i in [0, n) and returns when all are done.
  using Run = std::function<void(Eigen::Index n, const Body& body)>;

  BlockRunner() = default;  ///< one after the other
  /// @param threads  that `run` uses
  BlockRunner(Run run, int threads) : run_(std::move(run)), threads_(threads) {}

  /// Callers pass std::ref(body), which does not allocate.
  void operator()(Eigen::Index n, const Body& body) const {
    if (run_) return run_(n, body);
    for (Eigen::Index i = 0; i < n; ++i) body(i);
  }
  /// Blocks that are worth handing out together where something follows each of them in order.
  Eigen::Index n_at_once() const { return threads_ == 1 ? 1 : 4 * threads_; }

 private:
  Run run_;
  int threads_ = 1;
};

/// body(block, begin, end) for the blocks of the points [0, n).
template <class Body>
void for_each_block(const BlockRunner& run, Eigen::Index n, const Body& body) {
  const auto one = [&](Eigen::Index b) { body(b, b * kBlockSize, std::min(n, (b + 1) * kBlockSize)); };
  run(count_blocks(n), std::ref(one));
}

}  // namespace interply::contact
