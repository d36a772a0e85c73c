/// Triangles of a layer two by two, for loops over triangles that add to their corners: four additions instead of six,
/// and those are what such loops wait for.
#pragma once

#include <array>
#include <vector>

#include "mechanics/mesh.hpp"

namespace interply::contact {

struct Cells {
  std::vector<std::array<int, 4>> pairs;    ///< nodes a, b, c, d of the triangles (a, b, c) and (a, c, d)
  std::vector<std::array<int, 3>> singles;  ///< triangles that found no partner
};

/// Each triangle with the first of its neighbours that is still free, in the order of the mesh.
Cells pair_triangles(const mechanics::TriangleMesh& mesh);

}  // namespace interply::contact
