/// What the readers of mesh files have in common: nodes and elements as written, and what makes them a flat blank.
#pragma once

#include <cstdint>
#include <string_view>

#include "geometry/blank_mesh.hpp"
#include "geometry/text_lines.hpp"

namespace interply::geometry {

struct RawNode {
  std::int64_t id = 0;
  std::array<double, 3> x{};  ///< mm
  Place place;
};

struct RawElement {
  std::int64_t id = 0;
  std::array<std::int64_t, 4> corner{};  ///< node numbers; the first `n` are in use
  int n = 3;                             ///< 3 or 4
  Place place;
};

struct RawMesh {
  std::vector<RawNode> nodes;
  std::vector<RawElement> elements;  ///< of the chosen set
};

/// Nodes and chosen elements of one format. @throws Unreadable
RawMesh parse_gmsh(const Pieces& file, const std::string& set);
RawMesh parse_abaqus(const Pieces& file, const std::string& set);

/// Checks everything that the shell and the contact search rely on, splits quadrilaterals, turns triangles over. A
/// quadrilateral with neighbouring corners in one node is a triangle.
/// @throws Unreadable  missing or repeated nodes, nodes off the plane, elements without area or with a re-entrant
///                     corner, sides of three elements, overlapping neighbours, several pieces
FlatMesh flatten(RawMesh raw, const Pieces& file);

}  // namespace interply::geometry
