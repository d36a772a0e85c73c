/// Loops over elements or nodes that give the same bits for any number of threads.
#pragma once

#include <oneapi/tbb/task_arena.h>

#include <Eigen/Core>
#include <functional>
#include <memory>

namespace interply::solve {

/// Points per block. Fixed, so that a sum taken block by block does not depend on the number of threads.
inline constexpr Eigen::Index kBlockSize = 256;

inline Eigen::Index count_blocks(Eigen::Index n) { return (n + kBlockSize - 1) / kBlockSize; }

/// The worker threads of one layer, or of the coordinator. One thread means a plain loop that never touches oneTBB.
class Workers {
 public:
  /// Body of a loop: the number of its block and the points [begin, end) in it. Bodies of different blocks must write
  /// to different places and may not throw.
  using Body = std::function<void(Eigen::Index block, Eigen::Index begin, Eigen::Index end)>;

  /// @param threads  at least 1
  explicit Workers(int threads);

  /// Calls `body` once for each block of the points [0, n).
  void for_each_block(Eigen::Index n, const Body& body);
  /// Calls body(i) once for each i in [0, n).
  void for_each(Eigen::Index n, const std::function<void(Eigen::Index i)>& body);

 private:
  std::unique_ptr<tbb::task_arena> arena_;  ///< none for one thread
};

}  // namespace interply::solve
