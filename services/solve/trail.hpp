/// How closely the passes of a shell (mechanics/edge_shell.hpp) can follow each other through the blocks of elements
/// (blocks.hpp), and how much of what they hand on must be kept for that.
///
/// With block b at the first pass, block b - lag is at the second and block b - 2 lag at the third. Edges and nodes
/// follow in the order of their numbers: as soon as the elements that they need are through. Meshes that are numbered
/// row by row have the neighbours of an element a block or two away; any other numbering only makes the lag and the
/// rings longer, up to passes over the whole shell one after the other.
#pragma once

#include <vector>

#include "mechanics/edge_shell.hpp"

namespace interply::solve {

struct Trail {
  Eigen::Index n_blocks = 0;  ///< of elements
  Eigen::Index lag = 0;       ///< blocks between an element and its farthest neighbour
  // for each block of elements [n_blocks]
  std::vector<Eigen::Index> images;    ///< facets up to this block have the mirror images before this one
  std::vector<Eigen::Index> advanced;  ///< elements up to this block see the edges in the blocks (of edges) before this
  std::vector<Eigen::Index> driven;    ///< blocks of edges before this one need no moments beyond this block
  std::vector<Eigen::Index> gathered;  ///< nodes before this one need no corner forces beyond this block
  mechanics::Rings rings{};            ///< of whole blocks, or of all elements
};

Trail make_trail(const mechanics::ShellGeometry& shell);

}  // namespace interply::solve
