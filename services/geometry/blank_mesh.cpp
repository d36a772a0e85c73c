#include "geometry/blank_mesh.hpp"

#include "geometry/raw_mesh.hpp"
#include "geometry/text_lines.hpp"

namespace interply::geometry {

FlatMesh parse_blank(std::string_view text, const std::string& origin, const std::string& set) {
  const bool abaqus = to_lower(origin).ends_with(".inp");
  return flatten(abaqus ? parse_abaqus(text, origin, set) : parse_gmsh(text, origin, set), origin);
}

}  // namespace interply::geometry
