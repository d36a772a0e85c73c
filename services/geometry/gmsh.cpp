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
  std::map<std::int64_t, std::string> others;                   ///< of physical points, curves and volumes
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

/// Nodes of an element by Gmsh's number of its type; 0 if the type is not known here.
std::int64_t count_nodes(std::int64_t type) {
  static constexpr std::int64_t kNodes[] = {0, 2,  3,  4, 4,  8,  6,  5, 3,  6, 9, 10, 27, 18, 14, 1,
                                            8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};
  return type > 0 && type < 32 ? kNodes[type] : type == 92 ? 64 : type == 93 ? 125 : 0;
}

bool is_without_nodes_and_elements(std::string_view section) {
  static constexpr std::string_view kKnown[] = {
      "PhysicalNames",       "Entities", "Periodic",      "GhostElements",       "Parametrizations", "NodeData",
      "ElementData", "ElementNodeData", "InterpolationScheme", "Comments"};
  return std::find(std::begin(kKnown), std::end(kKnown), section) != std::end(kKnown);
}

/// Sections are read word by word, as Gmsh reads them: where the lines end has no meaning.
class GmshReader {
 public:
  GmshReader(const Pieces& file, const std::string& set) : lines_(file), words_(lines_, "", ' '), set_(set) {}

  RawMesh read() {
    read_format();
    while (lines_.next()) {
      const std::string_view line = lines_.line();
      if (line.empty()) continue;
      if (line[0] != '$') lines_.refuse("found " + quote(line) + " between two sections");
      const std::string section(line.substr(1));
      words_.go_on_with("");
      if (section == "PhysicalNames")
        read_names();
      else if (section == "Entities" && version_4_)
        read_entities();
      else if (section == "PartitionedEntities")
        lines_.refuse("is a partitioned mesh; save it in one partition");
      else if (section == "Nodes")
        version_4_ ? read_nodes_4() : read_nodes_2();
      else if (section == "ParametricNodes" && !version_4_)
        read_parametric_nodes();
      else if (section == "Elements")
        version_4_ ? read_elements_4() : read_elements_2();
      else if (!is_without_nodes_and_elements(section) && holds_nodes_or_elements(section))
        lines_.refuse("the section " + quote("$" + section) +
                      " may hold nodes or elements and is not read; save the mesh with $Nodes and $Elements");
      skip_to_end_of(section);
    }
    if (!set_.empty() && mesh_.elements.empty()) refuse_set();
    return std::move(mesh_);
  }

 private:
  static bool holds_nodes_or_elements(const std::string& section) {
    const std::string lower = to_lower(section);
    return lower.find("node") != lower.npos || lower.find("element") != lower.npos;
  }

  /// The words of a section up to the next `what`, at least one. Refuses the section's end.
  Fields& words(const std::string& what) {
    while (words_.empty()) {
      if (!lines_.next() || lines_.line().starts_with('$')) lines_.refuse("the section ends before its last " + what);
      words_.go_on_with(lines_.line());
    }
    return words_;
  }
  /// A whole number or a coordinate of a `what`. @param name  of the value, for the refusal
  std::int64_t next_integer(const char* what, const char* name) { return words(what).next_integer(name); }
  double next_number(const char* what, const char* name) { return words(what).next_number(name); }

  /// Of a section whose counts leave nothing to skip.
  void expect_end_after(const char* last) {
    if (words_.empty() && (!lines_.next() || lines_.line().starts_with('$') || lines_.line().empty())) return;
    lines_.refuse(std::string("the section goes on after its last ") + last + "; its counts or its lines are damaged");
  }

  void skip_to_end_of(const std::string& section) {
    while (lines_.line() != "$End" + section)
      if (!lines_.next()) lines_.refuse("the section " + quote("$" + section) + " has no " + quote("$End" + section));
  }

  void read_format() {
    static const std::string kCure =
        "; write it as text of version 4.1 or 2.2: gmsh OLD.msh -save -format msh41 -o NEW.msh";
    while (lines_.next() && lines_.line().empty()) {
    }
    if (lines_.line() == "$NOD") lines_.refuse("is of version '1.0'" + kCure);
    if (lines_.line() != "$MeshFormat")
      lines_.refuse("is no Gmsh mesh, which starts with $MeshFormat; bring a Gmsh .msh or an Abaqus .inp file");
    const std::string version(words("line").next());
    const bool binary = words("line").next() != "0";
    if ((version != "2.2" && version != "4.1") || binary)
      lines_.refuse("is " + std::string(binary ? "a binary file" : "of version " + quote(version)) + kCure);
    version_4_ = version == "4.1";
    skip_to_end_of("MeshFormat");
  }

  void read_names() {
    const std::int64_t n = next_integer("name", "the number of names");
    for (std::int64_t i = 0; i < n; ++i) {
      const std::int64_t dimension = next_integer("name", "the dimension");
      const std::int64_t number = next_integer("name", "the number of the group");
      const std::string_view rest = words("name").rest();
      const std::size_t first = rest.find('"'), last = rest.rfind('"');
      if (first == last) lines_.refuse("the name of a physical group is not in quotes");
      words_.go_on_with("");
      (dimension == 2 ? groups_.names : groups_.others)[number] = rest.substr(first + 1, last - first - 1);
    }
  }

  void read_entities() {
    has_entities_ = true;
    std::int64_t n[4];
    for (std::int64_t& count : n) count = next_integer("entity", "the number of entities");
    static constexpr const char* kWhat[] = {"point", "curve", "surface"};
    for (int dimension = 0; dimension < 3; ++dimension)  // volumes come last and are of no interest
      for (std::int64_t i = 0; i < n[dimension]; ++i) {
        const char* what = kWhat[dimension];
        const std::int64_t entity = next_integer(what, "the number of the entity");
        for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) next_number(what, "a bound of the entity");
        const std::int64_t physicals = next_integer(what, "the number of physical groups");
        for (std::int64_t k = 0; k < physicals; ++k) {
          const std::int64_t group = next_integer(what, "a physical group");
          if (dimension == 2) groups_.physicals[entity].push_back(group);
        }
        const std::int64_t bounds = dimension == 0 ? 0 : next_integer(what, "the number of bounding entities");
        for (std::int64_t k = 0; k < bounds; ++k) next_integer(what, "a bounding entity");
      }
  }

  void add_node(std::int64_t id) {
    RawNode node{.id = id, .place = lines_.place()};
    for (double& x : node.x) x = next_number("node", "a coordinate");
    mesh_.nodes.push_back(node);
  }

  void read_nodes_2() {
    const std::int64_t n = next_integer("node", "the number of nodes");
    for (std::int64_t i = 0; i < n; ++i) add_node(next_integer("node", "the number of the node"));
    expect_end_after("node");
  }

  /// Of version 2.2 with Mesh.SaveParametric: a node is a line, which ends in parameters on its entity.
  void read_parametric_nodes() {
    const std::int64_t n = next_integer("node", "the number of nodes");
    for (std::int64_t i = 0; i < n; ++i) {
      add_node(next_integer("node", "the number of the node"));
      words_.go_on_with("");
    }
  }

  void read_nodes_4() {
    const std::int64_t blocks = next_integer("node", "the number of blocks");
    for (const char* what : {"the number of nodes", "the smallest number", "the largest number"})
      next_integer("node", what);
    std::vector<std::int64_t> ids;
    for (std::int64_t b = 0; b < blocks; ++b) {
      const std::int64_t dimension = next_integer("node", "the dimension");
      next_integer("node", "the entity");
      const bool parametric = next_integer("node", "parametric") != 0;
      const std::int64_t n = next_integer("node", "the number of nodes");
      ids.clear();
      for (std::int64_t i = 0; i < n; ++i) ids.push_back(next_integer("node", "the number of the node"));
      for (const std::int64_t id : ids) {
        add_node(id);
        for (std::int64_t k = 0; parametric && k < dimension; ++k) next_number("node", "a parameter");
      }
    }
    expect_end_after("node");
  }

  /// Physical group `number` is the wanted set. Gmsh marks a reversed orientation by a negative number.
  bool is_wanted(std::int64_t number) {
    const std::int64_t group = number < 0 && number != INT64_MIN ? -number : number;
    const auto name = groups_.names.find(group);
    if (name == groups_.names.end()) unnamed_.emplace(group, std::to_string(group));
    return set_ == std::to_string(group) || (name != groups_.names.end() && name->second == set_);
  }

  /// Reads the nodes of an element of a type. Keeps it if it is chosen.
  void read_element(std::int64_t id, std::int64_t type, bool is_chosen) {
    const Shape shape = classify(type);
    if (is_chosen && (shape == Shape::CurvedSurface || shape == Shape::Other))
      lines_.refuse("element " + std::to_string(id) + " is of Gmsh's type " + std::to_string(type) +
                    (shape == Shape::Other ? "; choose a physical surface of triangles by blank.mesh.set"
                                           : ", of second or higher order; mesh with -order 1"));
    const std::int64_t n = count_nodes(type);
    if (n == 0) return words_.go_on_with("");  // its nodes end with the line
    RawElement element{.id = id, .n = static_cast<int>(n), .place = lines_.place()};
    for (std::int64_t k = 0; k < n; ++k) {
      const std::int64_t corner = next_integer("corner", "a corner of the element");
      if (k < 4) element.corner[static_cast<std::size_t>(k)] = corner;
    }
    if (is_chosen && shape != Shape::PointOrCurve) mesh_.elements.push_back(element);
  }

  void read_elements_2() {
    const std::int64_t n = next_integer("element", "the number of elements");
    for (std::int64_t i = 0; i < n; ++i) {
      const std::int64_t id = next_integer("element", "the number of the element");
      const std::int64_t type = next_integer("element", "the type of the element");
      const std::int64_t tags = next_integer("element", "the number of tags");
      std::int64_t physical = 0;
      for (std::int64_t k = 0; k < tags; ++k) {
        const std::int64_t tag = next_integer("element", "a tag");
        if (k == 0) physical = tag;
      }
      const Shape shape = classify(type);
      const bool is_surface = shape != Shape::PointOrCurve && shape != Shape::Other;
      ungrouped_ += is_surface && physical == 0;
      read_element(id, type, set_.empty() || (is_surface && physical != 0 && is_wanted(physical)));
    }
    expect_end_after("element");
  }

  void read_elements_4() {
    const std::int64_t blocks = next_integer("element", "the number of blocks");
    for (const char* what : {"the number of elements", "the smallest number", "the largest number"})
      next_integer("element", what);
    for (std::int64_t b = 0; b < blocks; ++b) {
      const std::int64_t dimension = next_integer("element", "the dimension");
      const std::int64_t entity = next_integer("element", "the entity");
      const std::int64_t type = next_integer("element", "the type of the elements");
      const std::int64_t n = next_integer("element", "the number of elements");
      const bool is_grouped = dimension == 2 && is_in_set(entity);
      if (dimension == 2 && !groups_.physicals.contains(entity)) ungrouped_ += n;
      for (std::int64_t i = 0; i < n; ++i)
        read_element(next_integer("element", "the number of the element"), type,
                     dimension >= 2 && (set_.empty() || is_grouped));
    }
    expect_end_after("element");
  }

  bool is_in_set(std::int64_t surface) {
    const auto found = groups_.physicals.find(surface);
    return found != groups_.physicals.end() &&
           std::any_of(found->second.begin(), found->second.end(), [&](std::int64_t g) { return is_wanted(g); });
  }

  [[noreturn]] void refuse_set() const {
    const auto is_asked = [&](const auto& group) {
      return group.second == set_ || std::to_string(group.first) == set_;
    };
    const auto has = [&](const auto& groups) { return std::any_of(groups.begin(), groups.end(), is_asked); };
    if (has(groups_.names))
      throw Unreadable(lines_.origin() + ": the physical surface " + quote(set_) + " has no elements: " +
                       explain_empty_group());
    std::vector<std::string> known;
    for (const auto& [number, name] : groups_.names) known.push_back(name);
    for (const auto& [number, name] : unnamed_) known.push_back(name);
    if (has(groups_.others))
      throw Unreadable(lines_.origin() + ": the physical group " + quote(set_) +
                       " holds points, curves or volumes, no surface" + suggest_set(set_, known));
    throw Unreadable(lines_.origin() + ": has no physical surface " + quote(set_) + " with elements" +
                     suggest_set(set_, known));
  }

  std::string explain_empty_group() const {
    const std::string count = std::to_string(ungrouped_);
    if (version_4_ && !has_entities_)
      return "the file has no $Entities, which say what surfaces belong to it; save the mesh with Gmsh, or leave out "
             "the set to take every element";
    if (ungrouped_ > 0)
      return "the file gives no physical group to " + count +
             " surface elements; save it without Mesh.SaveAll by a program that keeps groups, or leave out the set to "
             "take every element";
    return "no surface with elements belongs to it; add the surface to the group and mesh it again";
  }

  Lines lines_;
  Fields words_;  ///< of the current line that have not been read
  const std::string& set_;
  bool version_4_ = false, has_entities_ = false;
  Groups groups_;
  std::map<std::int64_t, std::string> unnamed_;  ///< physical surfaces that are numbers only
  std::int64_t ungrouped_ = 0;                   ///< surface elements without a physical group
  RawMesh mesh_;
};

}  // namespace

RawMesh parse_gmsh(const Pieces& file, const std::string& set) { return GmshReader(file, set).read(); }

}  // namespace interply::geometry
