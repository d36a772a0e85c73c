/// Triangulated surfaces of tools.
///
/// Own reader instead of assimp: its importer (5.2.5, measured) takes a text file that breaks off after a triangle as a
/// smaller tool and infinite coordinates as they are, and quotes the rest of the file where a number is wrong. STL is
/// fifty bytes per triangle or eight keywords; what a tool needs beyond that (welding, sides, orientation) is ours
/// either way.
#pragma once

#include <string>

#include "geometry/read_file.hpp"
#include "mechanics/nodal.hpp"

namespace interply::geometry {

using mechanics::NodalVectors;
using mechanics::Triangles;

/// Triangles over shared vertices. Every side belongs to one or two triangles, and two that share a side run through it
/// in opposite directions, so that the surface has two sides: normals N ~ (x1 - x0) x (x2 - x0) point to the same one.
struct Surface {
  NodalVectors vertices;  ///< [3 x n_vertices]   mm
  Triangles triangles;    ///< [3 x n_triangles]
  Triangles neighbours;   ///< across the side from corner k to k + 1, or -1 at a rim  [3 x n_triangles]
  int open_sides = 0;     ///< sides of one triangle only
  int collapsed = 0;      ///< triangles of the file that were dropped: two of their corners are the same vertex
  std::size_t bytes_after = 0;  ///< of a binary file, behind its last triangle; not read
  double weld = 0;        ///< distance below which corners are one vertex, mm

  bool is_watertight() const { return open_sides == 0; }
};

/// Surface of the content of an STL file, binary or ASCII; several solids become one surface.
///
/// Corners closer than 1e-6 of the diagonal of all corners (at least 1e-6 mm) are one vertex: the first of them in the
/// file. Normals in the file are not looked at (many programs write zeros): the order of the corners counts, seen
/// counter-clockwise from outside. Each connected part that is closed is turned so that its normals point outwards.
/// @param name  of the file, for messages
/// @throws Unreadable  for anything else than an STL file, coordinates beyond 1e6 mm, no triangle with an area, a side
///                     that three triangles share, or neighbours that face opposite ways
Surface parse_stl(const std::string& content, const std::string& name);

}  // namespace interply::geometry
