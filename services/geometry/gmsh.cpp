#include <algorithm>
#include <map>

#include "geometry/raw_mesh.hpp"
#include "geometry/read_file.hpp"
#include "geometry/text_lines.hpp"

namespace interply::geometry {
namespace {

/// Physical surfaces and the surfaces (entities) that belong to them.
struct Groups {
  std::map<std::int64_t, std::string> names;                    ///< of physical surfaces, by number
  std::map<std::int64_t, std::vector<std::int64_t>> physicals;  ///< numbers of the physical surfaces of a surface
};

enum class Shape { Triangle, Quadrilateral, PointOrCurve, CurvedSurface, Other };

/// By Gmsh's number of the element type.
Shape classify(std::int64_t type) {
  switch (type) {
    case 2:
      return Shape::Triangle;
    case 3:
      return Shape::Quadrilateral;
    case 1:
    case 8:
    case 15:
    case 26:
    case 27:
    case 28:
      return Shape::PointOrCurve;
    case 9:
    case 10:
    case 16:
    case 20:
    case 21:
    case 22:
    case 23:
    case 24:
    case 25:
      return Shape::CurvedSurface;
    default:
      return Shape::Other;
  }
}

class GmshReader {
 public:
  GmshReader(std::string_view text, const std::string& origin, const std::string& set)
      : lines_(text, origin), set_(set) {}

  RawMesh read() {
    read_format();
    while (lines_.next()) {
      const std::string_view line = lines_.line();
      if (line.empty()) continue;
      if (line[0] != '$') lines_.refuse("found " + quote(line) + " between two sections");
      const std::string section(line.substr(1));
      if (section == "PhysicalNames")
        read_names();
      else if (section == "Entities" && version_4_)
        read_entities();
      else if (section == "PartitionedEntities")
        lines_.refuse("is a partitioned mesh; save it in one partition");
      else if (section == "Nodes")
        version_4_ ? read_nodes_4() : read_nodes_2();
      else if (section == "Elements")
        version_4_ ? read_elements_4() : read_elements_2();
      skip_to_end_of(section);
    }
    if (!set_.empty() && !found_set_) refuse_set();
    return std::move(mesh_);
  }

 private:
  /// The next line of a section. Refuses its end.
  Fields next(const std::string& what) {
    if (!lines_.next() || lines_.line().starts_with('$')) lines_.refuse("the section ends before its last " + what);
    return Fields(lines_, ' ');
  }

  void skip_to_end_of(const std::string& section) {
    while (lines_.line() != "$End" + section)
      if (!lines_.next()) lines_.refuse("the section " + quote("$" + section) + " has no " + quote("$End" + section));
  }

  void read_format() {
    while (lines_.next() && lines_.line().empty()) {
    }
    if (lines_.line() != "$MeshFormat")
      lines_.refuse("is no Gmsh mesh, which starts with $MeshFormat; bring a Gmsh .msh or an Abaqus .inp file");
    Fields fields = next("line");
    const std::string version(fields.next());
    const bool binary = fields.next() != "0";
    if ((version != "2.2" && version != "4.1") || binary)
      lines_.refuse("is " + std::string(binary ? "a binary file" : "of version " + quote(version)) +
                    "; write it as text of version 4.1 or 2.2: gmsh OLD.msh -save -format msh41 -o NEW.msh");
    version_4_ = version == "4.1";
    skip_to_end_of("MeshFormat");
  }

  void read_names() {
    const std::int64_t n = next("name").next_integer("the number of names");
    for (std::int64_t i = 0; i < n; ++i) {
      Fields fields = next("name");
      const std::int64_t dimension = fields.next_integer("the dimension");
      const std::int64_t number = fields.next_integer("the number of the group");
      const std::string_view line = lines_.line();
      const std::size_t first = line.find('"'), last = line.rfind('"');
      if (first == last) lines_.refuse("the name of a physical group is not in quotes");
      if (dimension == 2) groups_.names[number] = line.substr(first + 1, last - first - 1);
    }
  }

  void read_entities() {
    Fields counts = next("entity");
    std::int64_t n[3];
    for (std::int64_t& count : n) count = counts.next_integer("the number of entities");
    for (std::int64_t i = 0; i < n[0]; ++i) next("point");
    for (std::int64_t i = 0; i < n[1]; ++i) next("curve");
    for (std::int64_t i = 0; i < n[2]; ++i) {
      Fields fields = next("surface");
      const std::int64_t surface = fields.next_integer("the number of the surface");
      for (int k = 0; k < 6; ++k) fields.next_number("a bound of the surface");
      const std::int64_t physicals = fields.next_integer("the number of physical groups");
      auto& groups = groups_.physicals[surface];
      for (std::int64_t k = 0; k < physicals; ++k) groups.push_back(fields.next_integer("a physical group"));
    }
  }

  void add_node(std::int64_t id, Fields& coordinates) {
    RawNode node{.id = id, .line = lines_.number()};
    for (double& x : node.x) x = coordinates.next_number("a coordinate");
    mesh_.nodes.push_back(node);
  }

  void read_nodes_2() {
    const std::int64_t n = next("node").next_integer("the number of nodes");
    for (std::int64_t i = 0; i < n; ++i) {
      Fields fields = next("node");
      const std::int64_t id = fields.next_integer("the number of the node");
      add_node(id, fields);
    }
  }

  void read_nodes_4() {
    const std::int64_t blocks = next("node").next_integer("the number of blocks");
    std::vector<std::int64_t> ids;
    for (std::int64_t b = 0; b < blocks; ++b) {
      Fields head = next("node");
      for (const char* what : {"the dimension", "the entity", "parametric"}) head.next_integer(what);
      const std::int64_t n = head.next_integer("the number of nodes");
      ids.clear();
      for (std::int64_t i = 0; i < n; ++i) ids.push_back(next("node").next_integer("the number of the node"));
      for (const std::int64_t id : ids) {
        Fields fields = next("node");
        add_node(id, fields);
      }
    }
  }

  /// Physical group `number` is the wanted set. Gmsh marks a reversed orientation by a negative number.
  bool is_wanted(std::int64_t number) {
    const std::int64_t group = number < 0 && number != INT64_MIN ? -number : number;
    const auto name = groups_.names.find(group);
    if (name == groups_.names.end()) unnamed_.emplace(group, std::to_string(group));
    return set_ == std::to_string(group) || (name != groups_.names.end() && name->second == set_);
  }

  void add_element(std::int64_t id, Shape shape, std::int64_t type, Fields& corners) {
    if (shape == Shape::CurvedSurface || shape == Shape::Other)
      lines_.refuse("element " + std::to_string(id) + " is of Gmsh's type " + std::to_string(type) +
                    (shape == Shape::Other ? "; choose a physical surface of triangles by blank.mesh.set"
                                           : ", of second or higher order; mesh with -order 1"));
    found_set_ = true;
    RawElement element{.id = id, .n = shape == Shape::Triangle ? 3 : 4, .line = lines_.number()};
    for (int k = 0; k < element.n; ++k)
      element.corner[static_cast<std::size_t>(k)] = corners.next_integer("a corner of the element");
    mesh_.elements.push_back(element);
  }

  void read_elements_2() {
    const std::int64_t n = next("element").next_integer("the number of elements");
    for (std::int64_t i = 0; i < n; ++i) {
      Fields fields = next("element");
      const std::int64_t id = fields.next_integer("the number of the element");
      const std::int64_t type = fields.next_integer("the type of the element");
      const std::int64_t tags = fields.next_integer("the number of tags");
      std::int64_t physical = 0;
      for (std::int64_t k = 0; k < tags; ++k) {
        const std::int64_t tag = fields.next_integer("a tag");
        if (k == 0) physical = tag;
      }
      const Shape shape = classify(type);
      if (shape == Shape::PointOrCurve) continue;
      if (!set_.empty() && (shape == Shape::Other || physical == 0 || !is_wanted(physical))) continue;
      add_element(id, shape, type, fields);
    }
  }

  void read_elements_4() {
    const std::int64_t blocks = next("element").next_integer("the number of blocks");
    for (std::int64_t b = 0; b < blocks; ++b) {
      Fields head = next("element");
      const std::int64_t dimension = head.next_integer("the dimension");
      const std::int64_t entity = head.next_integer("the entity");
      const std::int64_t type = head.next_integer("the type of the elements");
      const std::int64_t n = head.next_integer("the number of elements");
      const bool chosen = dimension >= 2 && (set_.empty() || (dimension == 2 && is_in_set(entity)));
      for (std::int64_t i = 0; i < n; ++i) {
        Fields fields = next("element");
        if (!chosen) continue;
        const std::int64_t id = fields.next_integer("the number of the element");
        add_element(id, classify(type), type, fields);
      }
    }
  }

  bool is_in_set(std::int64_t surface) {
    const auto found = groups_.physicals.find(surface);
    return found != groups_.physicals.end() &&
           std::any_of(found->second.begin(), found->second.end(), [&](std::int64_t g) { return is_wanted(g); });
  }

  [[noreturn]] void refuse_set() const {
    std::vector<std::string> known;
    for (const auto& [number, name] : groups_.names) known.push_back(name);
    for (const auto& [number, name] : unnamed_) known.push_back(name);
    throw Unreadable(lines_.origin() + ": has no physical surface " + quote(set_) + " with elements" +
                     suggest_set(set_, known));
  }

  Lines lines_;
  const std::string& set_;
  bool version_4_ = false, found_set_ = false;
  Groups groups_;
  std::map<std::int64_t, std::string> unnamed_;  ///< physical surfaces that are numbers only
  RawMesh mesh_;
};

}  // namespace

RawMesh parse_gmsh(std::string_view text, const std::string& origin, const std::string& set) {
  return GmshReader(text, origin, set).read();
}

}  // namespace interply::geometry
