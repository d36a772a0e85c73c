#include "solve/blocks.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <functional>

namespace interply::solve {

Workers::Workers(int threads) {
  if (threads > 1) arena_ = std::make_unique<tbb::task_arena>(threads);
}

void Workers::for_each_block(Eigen::Index n, const Body& body) {
  const auto run = [&](Eigen::Index block) { body(block, block * kBlockSize, std::min(n, (block + 1) * kBlockSize)); };
  for_each(count_blocks(n), std::ref(run));
}

void Workers::for_each(Eigen::Index n, const std::function<void(Eigen::Index i)>& body) {
  if (!arena_) {
    for (Eigen::Index i = 0; i < n; ++i) body(i);
    return;
  }
  arena_->execute([&] { tbb::parallel_for(Eigen::Index{0}, n, body); });
}

}  // namespace interply::solve
