#include "solve/trail.hpp"

#include <algorithm>
#include <cstdlib>

#include "solve/blocks.hpp"

namespace interply::solve {

using Eigen::Index;

namespace {

/// Between the rows of a ring: one cache line, so that the rows do not meet in the same sets of the cache.
constexpr Index kGap = 8;

/// Blocks of elements [first, last] that something needs.
struct Span {
  Index first, last;
  void add(Index block) {
    first = std::min(first, block);
    last = std::max(last, block);
  }
};

/// Things that are dealt with one after the other, each once the blocks before it and of its own are through.
struct Followers {
  std::vector<Index> done;  ///< how many, after each block
  Index reach = 0;          ///< how many blocks the oldest block that is still needed lies behind the latest
};

Followers follow(const std::vector<Span>& spans, Index n_blocks) {
  Followers f{.done = std::vector<Index>(static_cast<std::size_t>(n_blocks))};
  Index latest = 0;
  for (std::size_t i = 0; i < spans.size(); ++i) {
    latest = std::max(latest, spans[i].last);
    f.reach = std::max(f.reach, latest - spans[i].first);
    f.done[static_cast<std::size_t>(latest)] = static_cast<Index>(i) + 1;
  }
  for (std::size_t block = 1; block < f.done.size(); ++block)
    f.done[block] = std::max(f.done[block], f.done[block - 1]);
  return f;
}

}  // namespace

Trail make_trail(const mechanics::ShellGeometry& shell) {
  const Index n = shell.n_elements(), n_edges = shell.n_edges();
  const Index n_nodes = static_cast<Index>(shell.gather.start.size()) - 1;
  const auto find_block = [n](Index side) { return side % n / kBlockSize; };
  Trail trail{.n_blocks = count_blocks(n)};
  const Span none{trail.n_blocks - 1, 0};

  trail.advanced.assign(static_cast<std::size_t>(trail.n_blocks), 0);
  Index farthest = 0;
  for (Index e = 0; e < n; ++e)
    for (int k = 0; k < 3; ++k) {
      if (shell.neighbour(k, e) >= 0)
        trail.lag = std::max(trail.lag, std::abs(find_block(e) - find_block(shell.neighbour(k, e))));
      farthest = std::max<Index>(farthest, shell.edge(k, e));
      trail.advanced[static_cast<std::size_t>(find_block(e))] = farthest / kBlockSize + 1;
    }
  trail.images.assign(static_cast<std::size_t>(trail.n_blocks), 0);
  for (const int side : shell.images) ++trail.images[static_cast<std::size_t>(find_block(side))];
  for (std::size_t block = 1; block < trail.images.size(); ++block) trail.images[block] += trail.images[block - 1];

  std::vector<Span> edges(static_cast<std::size_t>(count_blocks(n_edges)), none);
  for (Index i = 0; i < n_edges; ++i)
    for (const int side : {shell.edge_sides(0, i), shell.edge_sides(1, i)})
      if (side >= 0) edges[static_cast<std::size_t>(i / kBlockSize)].add(find_block(side));
  std::vector<Span> nodes(static_cast<std::size_t>(n_nodes), none);
  for (Index i = 0; i < n_nodes; ++i)
    for (int at = shell.gather.start[i]; at < shell.gather.start[i + 1]; ++at)
      nodes[static_cast<std::size_t>(i)].add(find_block(shell.gather.entry[at]));
  Followers driven = follow(edges, trail.n_blocks), gathered = follow(nodes, trail.n_blocks);

  const auto make_ring = [n](Index reach) -> mechanics::Ring {
    const Index size = (reach + 1) * kBlockSize;
    return size < n ? mechanics::Ring{size, size + kGap} : mechanics::Ring{n, n};
  };
  trail.rings = {.facets = make_ring(2 * trail.lag),
                 .moments = make_ring(std::max(2 * trail.lag, driven.reach)),
                 .corners = make_ring(gathered.reach)};
  trail.driven = std::move(driven.done);
  trail.gathered = std::move(gathered.done);
  return trail;
}

}  // namespace interply::solve
