/// Meshes of blanks that users bring: Gmsh .msh and Abaqus .inp.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/text_lines.hpp"

namespace interply::geometry {

/// A flat blank of triangles: one piece, every point used, corners counter-clockwise.
struct FlatMesh {
  std::vector<std::array<double, 2>> points;  ///< x, y, in the order of the file's node numbers   [n_nodes]     mm
  std::vector<std::array<int, 3>> triangles;  ///< corners, in the order of the file               [n_elements]
};

/// A mesh file; an Abaqus file (.inp) with all that it includes. @throws Unreadable
Pieces read_mesh_file(const std::string& path);

/// Reads the triangles and quadrilaterals of one set, or of the whole file, from its text. Quadrilaterals become two
/// triangles along their shorter diagonal, or one if a corner is given twice; clockwise elements are turned over; nodes
/// without an element are dropped. The nodes may lie at any one height z, which is left out.
///
/// Gmsh: ASCII, versions 2.2 and 4.1; a set is a physical surface, by name or number; points, curves are skipped.
/// Abaqus: *NODE, *ELEMENT of the families S, CPS, CPE, M3D, SFM3D with three or four corners, *ELSET, *INCLUDE, and
/// parts with their instances where these stand. A set is an element set; if several instances have it, 'Instance.set';
/// or an instance as a whole. Keywords without a meaning for a flat mesh are skipped, and so are rigid elements unless
/// they are asked for.
///
/// @param file  Abaqus if its path ends in .inp, else Gmsh
/// @param set   name of the set; empty: every element
/// @throws Unreadable  one sentence with file, line, number of the element, and what to change
FlatMesh parse_blank(const Pieces& file, const std::string& set);

/// The same from the text of one file, which includes no other. @param origin  path: it opens every error message
FlatMesh parse_blank(std::string_view text, const std::string& origin, const std::string& set);

}  // namespace interply::geometry
