/// Meshes of blanks that users bring: Gmsh .msh and Abaqus .inp.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace interply::geometry {

/// A flat blank of triangles: one piece, every point used, corners counter-clockwise.
struct FlatMesh {
  std::vector<std::array<double, 2>> points;  ///< x, y, in the order of the file's node numbers   [n_nodes]     mm
  std::vector<std::array<int, 3>> triangles;  ///< corners, in the order of the file               [n_elements]
};

/// Reads the triangles and quadrilaterals of one set, or of the whole file, from its text. Quadrilaterals become two
/// triangles along their shorter diagonal; clockwise elements are turned over; nodes without an element are dropped.
/// The nodes may lie at any one height z, which is left out.
///
/// Gmsh: ASCII, versions 2.2 and 4.1; a set is a physical surface, by name or number; points, curves are skipped.
/// Abaqus: *NODE, *ELEMENT of three or four corners (S3, S4R, CPS3, M3D4, ...), *ELSET; a set is an element set. One
/// part and its instance without translation or rotation; keywords without a meaning for a flat mesh are skipped.
///
/// @param text    the file, Abaqus if `origin` ends in .inp, else Gmsh
/// @param origin  path of the file: it opens every error message
/// @param set     name of the set; empty: every element
/// @throws Unreadable  one sentence with file, line, number of the element, and what to change
FlatMesh parse_blank(std::string_view text, const std::string& origin, const std::string& set);

}  // namespace interply::geometry
