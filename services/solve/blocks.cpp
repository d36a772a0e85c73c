#include "solve/blocks.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>

namespace interply::solve {

Workers::Workers(int threads) {
  if (threads > 1) arena_ = std::make_unique<tbb::task_arena>(threads);
}

void Workers::for_each_block(Eigen::Index n, const Body& body) {
  const auto run = [&](Eigen::Index block) { body(block, block * kBlockSize, std::min(n, (block + 1) * kBlockSize)); };
  if (!arena_) {
    for (Eigen::Index block = 0; block < count_blocks(n); ++block) run(block);
    return;
  }
  arena_->execute([&] { tbb::parallel_for(Eigen::Index{0}, count_blocks(n), run); });
}

}  // namespace interply::solve
