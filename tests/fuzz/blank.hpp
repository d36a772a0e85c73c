/// What the two targets of mesh files share.
#pragma once

#include <cmath>
#include <stdexcept>

#include "fuzz/parts.hpp"
#include "geometry/alignment.hpp"
#include "geometry/blank_mesh.hpp"
#include "geometry/read_file.hpp"
#include "mechanics/mesh.hpp"

namespace interply::fuzz {

/// The name of a set, then a mesh file. What is accepted is a blank: positive areas, with nodes that have some mass.
inline void read_blank(const std::uint8_t* data, std::size_t size, const std::string& origin) {
  const std::vector<std::string> parts = split(data, size);
  if (parts.size() != 2) return;
  geometry::FlatMesh flat;
  try {
    flat = geometry::parse_blank(parts[1], origin, parts[0]);
  } catch (const geometry::Unreadable& refused) {
    return expect_sentence(refused.what(), origin);
  }
  const double share = geometry::compute_misaligned_share(flat, 0.4);
  if (!(share >= 0 && share <= 1 + 1e-9)) fail("a misaligned share of " + std::to_string(share));
  const mechanics::TriangleMesh mesh = mechanics::make_mesh(flat.points, flat.triangles, 0, false);
  if (!(mechanics::compute_areas(mesh) > 0).all()) fail("an element without area");
  if (!(mechanics::compute_lumped_mass(mesh, 1, 1e-9) > 0).all()) fail("a node without mass");
  try {
    mechanics::make_mesh(flat.points, flat.triangles, 0, true);
  } catch (const std::invalid_argument&) {  // not the half y >= 0 of a blank
  }
}

}  // namespace interply::fuzz
