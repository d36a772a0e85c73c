/// Meshes of blanks as files, for tests.
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "geometry/blank_mesh.hpp"
#include "geometry/read_file.hpp"

namespace interply::test {

inline geometry::FlatMesh read_blank(const std::filesystem::path& file, const std::string& set = "") {
  return geometry::parse_blank(geometry::read_file(file), file, set);
}

/// A half blank and its mirror image in y = 0, joined there. Triangles of the image come after those of the half.
inline geometry::FlatMesh mirror(const geometry::FlatMesh& half) {
  geometry::FlatMesh full = half;
  std::vector<int> image(half.points.size());
  for (std::size_t i = 0; i < half.points.size(); ++i) {
    const auto& p = half.points[i];
    image[i] = std::abs(p[1]) < 1e-9 ? static_cast<int>(i) : static_cast<int>(full.points.size());
    if (image[i] != static_cast<int>(i)) full.points.push_back({p[0], -p[1]});
  }
  for (const auto& t : half.triangles)
    full.triangles.push_back({image[static_cast<std::size_t>(t[0])], image[static_cast<std::size_t>(t[2])],
                              image[static_cast<std::size_t>(t[1])]});
  return full;
}

/// As an Abaqus file; every number reads back to the same bits.
inline void write_inp(const geometry::FlatMesh& mesh, const std::filesystem::path& file) {
  std::ofstream out(file);
  out.precision(17);
  out << "*NODE\n";
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    out << i + 1 << ", " << mesh.points[i][0] << ", " << mesh.points[i][1] << ", 0\n";
  out << "*ELEMENT, TYPE=S3, ELSET=blank\n";
  for (std::size_t e = 0; e < mesh.triangles.size(); ++e) {
    out << e + 1;
    for (const int corner : mesh.triangles[e]) out << ", " << corner + 1;
    out << '\n';
  }
}

}  // namespace interply::test
