/// Triangles of a layer two by two, for loops over triangles that add to their corners: four additions instead of six,
/// and those are what such loops wait for.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "contact/blocks.hpp"
#include "mechanics/mesh.hpp"

namespace interply::contact {

/// The numbers first ... last - 1.
struct Span {
  Eigen::Index first = 0, last = 0;
  Eigen::Index size() const { return last - first; }
  bool is_empty() const { return first == last; }
};
inline Span join(const Span& a, const Span& b) {
  if (a.is_empty()) return b;
  if (b.is_empty()) return a;
  return {std::min(a.first, b.first), std::max(a.last, b.last)};
}

struct Cells {
  std::vector<std::array<int, 4>> pairs;    ///< nodes a, b, c, d of the triangles (a, b, c) and (a, c, d)
  std::vector<std::array<int, 3>> singles;  ///< triangles that found no partner

  /// Triangles around some nodes, and all nodes that they have.
  struct Reach {
    Span nodes, pairs, singles;
  };
  std::vector<Reach> reaches;  ///< of each block of kBlockSize nodes
  Reach find_reach(const Span& nodes) const;
};

/// Each triangle with the first of its neighbours that is still free, in the order of the mesh.
Cells pair_triangles(const mechanics::TriangleMesh& mesh);

}  // namespace interply::contact
