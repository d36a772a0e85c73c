/// Loops of contact in parts that anyone may run, in any order and by any number of threads: different parts write to
/// different places, and sums are kept by part and added in their order.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <functional>

namespace interply::contact {

inline constexpr Eigen::Index kBlockSize = 256;  ///< points per block
inline Eigen::Index count_blocks(Eigen::Index n) { return (n + kBlockSize - 1) / kBlockSize; }

/// Calls body(i) once for each i in [0, n) and returns when all are done. Callers pass std::ref(body), which does not
/// allocate.
using BlockRunner = std::function<void(Eigen::Index n, const std::function<void(Eigen::Index i)>& body)>;

inline void run_serially(Eigen::Index n, const std::function<void(Eigen::Index i)>& body) {
  for (Eigen::Index i = 0; i < n; ++i) body(i);
}

/// body(block, begin, end) for the blocks of the points [0, n).
template <class Body>
void for_each_block(const BlockRunner& run, Eigen::Index n, const Body& body) {
  const auto one = [&](Eigen::Index b) { body(b, b * kBlockSize, std::min(n, (b + 1) * kBlockSize)); };
  run(count_blocks(n), std::ref(one));
}

}  // namespace interply::contact
