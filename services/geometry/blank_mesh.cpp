#include "geometry/blank_mesh.hpp"

#include "geometry/abaqus_text.hpp"
#include "geometry/raw_mesh.hpp"
#include "geometry/read_file.hpp"

namespace interply::geometry {
namespace {

bool is_abaqus(const std::string& path) { return to_lower(path).ends_with(".inp"); }

}  // namespace

Pieces read_mesh_file(const std::string& path) {
  const std::string content = read_file(path);
  if (is_abaqus(path)) return follow_includes(content, path, read_file);
  return {{.origin = path, .text = std::string(open_text(content, path))}};
}

FlatMesh parse_blank(const Pieces& file, const std::string& set) {
  const bool abaqus = is_abaqus(file.front().origin);
  return flatten(abaqus ? parse_abaqus(file, set) : parse_gmsh(file, set), file);
}

FlatMesh parse_blank(std::string_view text, const std::string& origin, const std::string& set) {
  const auto refuse = [](const std::string&) -> std::string { throw Unreadable("there is no other file here"); };
  if (is_abaqus(origin)) return parse_blank(follow_includes(std::string(text), origin, refuse), set);
  return parse_blank({{.origin = origin, .text = std::string(open_text(text, origin))}}, set);
}

}  // namespace interply::geometry
