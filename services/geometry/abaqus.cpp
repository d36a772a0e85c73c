#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <limits>
#include <map>
#include <optional>

#include "geometry/abaqus_text.hpp"
#include "geometry/raw_mesh.hpp"
#include "geometry/read_file.hpp"

namespace interply::geometry {
namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
constexpr std::int64_t kLargestId = std::numeric_limits<std::int64_t>::max() / 4;  // sums of two do not overflow

/// Element numbers start, start + step, ... up to `end`.
struct Range {
  std::int64_t start = 0, end = 0, step = 1;
  bool contains(std::int64_t id) const { return id >= start && id <= end && (id - start) % step == 0; }
};

/// An element set. What it holds may lie in another scope than the set: an assembly has sets of its instances.
struct ElementSet {
  std::string name;                                         ///< as first written
  std::vector<std::pair<std::size_t, Range>> members;       ///< scope, numbers; single ones are ranges of one
  std::vector<std::pair<std::size_t, std::string>> nested;  ///< scope, name of another set in lower case
};

enum class Family { Triangle, Quadrilateral, Rigid, PointOrCurve, Other };

/// By families, not by names: S4, S4R, S4RT, S4R5 and S4RSW are one element with four corners.
Family classify(const std::string& lower) {
  for (const char* start :
       {"t2d2", "t3d2", "b2", "b3", "pipe", "rb", "mass", "rotaryi", "heatcap", "spring", "dashpot", "conn", "dcoup"})
    if (lower.starts_with(start)) return Family::PointOrCurve;
  if (lower.starts_with("r3d")) return Family::Rigid;
  if (lower == "stri3") return Family::Triangle;
  for (const std::string_view family : {"s", "ds", "cps", "cpe", "cpeg", "m3d", "sfm3d"}) {
    if (!lower.starts_with(family) || lower.size() == family.size()) continue;
    const char corners = lower[family.size()];
    std::string_view kind = std::string_view(lower).substr(family.size() + 1);  // letters, and the 5 of S4R5
    if (kind.ends_with('5')) kind.remove_suffix(1);
    if ((corners != '3' && corners != '4') || !std::all_of(kind.begin(), kind.end(), [](char c) { return c >= 'a'; }))
      continue;
    return corners == '3' ? Family::Triangle : Family::Quadrilateral;
  }
  return Family::Other;
}

/// An element of a type that is no part of a blank.
struct Unsupported {
  std::int64_t id = 0;
  Place place;
  std::string type;
  std::size_t home = kNone;
};

/// A name space of nodes, elements and sets: the file outside of parts, a part, or an instance.
struct Scope {
  std::string name;                                            ///< as written
  std::size_t part = kNone;                                    ///< of an instance, its part
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  ///< of an instance
  std::vector<RawNode> nodes;
  std::vector<RawElement> elements;
  std::vector<std::size_t> homes;          ///< set that the *ELEMENT line of each element gives, or kNone
  std::vector<Unsupported> others, rigid;  ///< not to be read; rigid surfaces of tools
  std::map<std::string, std::size_t> sets;  ///< by name in lower case, index of the set
  std::vector<std::string> node_sets;       ///< in lower case
};

/// What may be the blank: an instance with its part, or all that stands outside of parts.
struct Body {
  std::string name;
  std::vector<std::size_t> scopes;
  bool has(std::size_t scope) const { return std::find(scopes.begin(), scopes.end(), scope) != scopes.end(); }
};

/// A body, or a set of its elements.
struct Choice {
  std::size_t body = 0;
  std::size_t set = kNone;
};

class AbaqusReader {
 public:
  AbaqusReader(const Pieces& pieces, const std::string& set)
      : pieces_(pieces), lines_(pieces), file_(pieces.front().origin), wanted_(set) {}

  RawMesh read() {
    bool more = lines_.next();
    while (more) more = is_keyword(lines_.line()) ? read_keyword() : lines_.next();
    return select(choose());
  }

 private:
  /// Goes to the next line of data of the current keyword. False at the next keyword or the end of the file.
  bool next_data() {
    while ((at_end_ = !lines_.next()) == false) {
      if (is_keyword(lines_.line())) return false;
      if (!lines_.line().empty() && !is_comment(lines_.line())) return true;
    }
    return false;
  }

  /// Reads one keyword with its data. False at the end of the file.
  bool read_keyword() {
    const Keyword keyword = parse_keyword(lines_);
    refuse_what_changes_the_mesh(keyword);
    const std::string& name = keyword.name;
    if (name == "part") {
      scope_ = add_scope(keyword, parts_);
    } else if (name == "assembly") {
      in_assembly_ = true;
    } else if (name == "endassembly") {
      in_assembly_ = false;
    } else if (name == "endpart" || name == "endinstance") {
      scope_ = 0;
    }
    if ((name == "nset" || name == "node") && keyword.find("nset"))
      scopes_[scope_].node_sets.push_back(to_lower(*keyword.find("nset")));
    const bool of_assembly = in_assembly_ && scope_ == 0 && scopes_.size() > 1;  // its reference points
    if (name == "node" && !of_assembly)
      read_nodes();
    else if (name == "element" && !of_assembly)
      read_elements(keyword);
    else if (name == "elset")
      read_set(keyword);
    else if (name == "instance")
      read_instance(keyword);
    else
      while (next_data()) {
      }
    return !at_end_;
  }

  void refuse_what_changes_the_mesh(const Keyword& keyword) const {
    const std::string& name = keyword.name;
    for (const char* generator : {"ngen", "nfill", "ncopy", "nmap", "elgen", "elcopy"})
      if (name == generator)
        lines_.refuse("*" + name +
                      " generates nodes or elements; write the finished mesh (in Abaqus/CAE: export input)");
    if (name == "system" || (name == "node" && keyword.find("system") && to_lower(*keyword.find("system")) != "r"))
      lines_.refuse("gives nodes in another coordinate system; write them in global x, y, z");
  }

  /// Opens a part or an instance. @param numbers  of those of its kind, by name in lower case
  std::size_t add_scope(const Keyword& keyword, std::map<std::string, std::size_t>& numbers) {
    const std::string* name = keyword.find("name");
    if (!name || name->empty()) lines_.refuse("*" + keyword.name + " has no NAME=");
    if (!numbers.emplace(to_lower(*name), scopes_.size()).second)
      lines_.refuse("a second *" + keyword.name + " of the name " + quote(*name));
    scopes_.push_back({.name = *name});
    return scopes_.size() - 1;
  }

  void read_instance(const Keyword& keyword) {
    scope_ = add_scope(keyword, instances_);
    Scope& instance = scopes_[scope_];
    if (const std::string* part = keyword.find("part")) {
      const auto found = parts_.find(to_lower(*part));
      if (found == parts_.end())
        lines_.refuse("there is no *PART " + quote(*part) + " before its instance" +
                      suggest_set(*part, list_names(parts_)));
      instance.part = found->second;
    }
    if (!next_data()) return;
    double shift[3], axis[7];
    read_numbers(shift);
    instance.placement.pretranslate(Eigen::Vector3d(shift[0], shift[1], shift[2]));
    if (!next_data()) return;
    read_numbers(axis);  // two points of an axis, degrees; turned after it was shifted
    const Eigen::Vector3d a(axis[0], axis[1], axis[2]), along = Eigen::Vector3d(axis[3], axis[4], axis[5]) - a;
    if (axis[6] != 0 && !(along.norm() > 0)) lines_.refuse("the axis of the instance has no length");
    if (axis[6] != 0) {
      const Eigen::AngleAxisd turn(axis[6] * std::acos(-1.0) / 180, along.normalized());
      instance.placement = Eigen::Translation3d(a) * turn * Eigen::Translation3d(-a) * instance.placement;
    }
    while (next_data()) {
    }
  }

  /// The values of the current line; what is missing is 0.
  template <std::size_t N>
  void read_numbers(double (&values)[N]) {
    Fields fields(lines_, ',');
    for (double& value : values) {
      Fields field(lines_, fields.next(), ',');
      value = field.empty() ? 0 : field.next_number("a component of the instance's place");
    }
  }

  std::vector<std::string> list_names(const std::map<std::string, std::size_t>& numbers) const {
    std::vector<std::string> names;
    for (const auto& [lower, number] : numbers) names.push_back(scopes_[number].name);
    return names;
  }

  void read_nodes() {
    while (next_data()) {
      Fields fields(lines_, ',');
      RawNode node{.id = read_id(fields, "the number of the node"), .place = lines_.place()};
      for (double& x : node.x) {
        Fields field(lines_, fields.next(), ',');
        if (!field.empty()) x = field.next_number("a coordinate");
      }
      scopes_[scope_].nodes.push_back(node);
    }
  }

  std::int64_t read_id(Fields& fields, const char* what) const {
    const std::int64_t id = fields.next_integer(what);
    if (id < 0 || id > kLargestId) lines_.refuse(std::string(what) + " " + std::to_string(id) + " is out of range");
    return id;
  }

  void read_elements(const Keyword& keyword) {
    const std::string* type = keyword.find("type");
    if (!type) lines_.refuse("*ELEMENT has no TYPE");
    const Family family = classify(to_lower(*type));
    const int corners = family == Family::Triangle ? 3 : family == Family::Quadrilateral ? 4 : 0;
    std::size_t home = kNone;
    if (const std::string* set = keyword.find("elset")) home = find_or_add_set(*set);
    Scope& scope = scopes_[scope_];
    while (next_data()) {
      Fields fields(lines_, ',');
      RawElement element{
          .id = read_id(fields, "the number of the element"), .n = corners, .place = lines_.place()};
      if (corners == 0) {
        if (family != Family::PointOrCurve)
          (family == Family::Rigid ? scope.rigid : scope.others).push_back({element.id, element.place, *type, home});
        while (lines_.line().ends_with(',') && next_data()) {
        }  // continuation
        if (at_end_ || is_keyword(lines_.line())) return;
        continue;
      }
      for (int k = 0; k < corners; ++k) {
        if (fields.empty() && lines_.line().ends_with(',')) {
          if (!next_data()) lines_.refuse("the corners of element " + std::to_string(element.id) + " end too early");
          fields.go_on_with(lines_.line());
        }
        element.corner[static_cast<std::size_t>(k)] = fields.next_integer("a corner of the element");
      }
      if (!fields.empty())
        lines_.refuse("element " + std::to_string(element.id) + " of type " + quote(*type) + " has more than " +
                      std::to_string(corners) + " corners");
      scope.elements.push_back(element);
      scope.homes.push_back(home);
    }
  }

  std::size_t find_or_add_set(const std::string& name) {
    const auto [found, added] = scopes_[scope_].sets.emplace(to_lower(name), sets_.size());
    if (added) sets_.push_back({.name = name, .members = {}, .nested = {}});
    return found->second;
  }

  void read_set(const Keyword& keyword) {
    const std::string* name = keyword.find("elset");
    if (!name || name->empty()) lines_.refuse("*ELSET has no name ELSET=");
    std::size_t of = scope_;
    if (const std::string* instance = keyword.find("instance")) {
      const auto found = instances_.find(to_lower(*instance));
      if (found == instances_.end())
        lines_.refuse("there is no *INSTANCE " + quote(*instance) + " before its set" +
                      suggest_set(*instance, list_names(instances_)));
      of = found->second;
    }
    const std::size_t set = find_or_add_set(*name);
    while (next_data()) {
      Fields fields(lines_, ',');
      keyword.find("generate") ? add_range(sets_[set], of, fields) : add_members(sets_[set], of, fields);
    }
  }

  void add_range(ElementSet& set, std::size_t of, Fields& fields) {
    Range range;
    range.start = read_id(fields, "the first number");
    range.end = read_id(fields, "the last number");
    if (!fields.empty()) range.step = read_id(fields, "the step");
    if (range.end < range.start || range.step < 1)
      lines_.refuse("the range " + std::to_string(range.start) + ", " + std::to_string(range.end) + ", " +
                    std::to_string(range.step) + " does not run upwards");
    constexpr int kSteppedRanges = 1000;  // each is compared with every element
    if (range.step > 1 && ++stepped_ranges_ > kSteppedRanges)
      lines_.refuse("more than 1000 ranges with a step; list the elements instead");
    set.members.emplace_back(of, range);
  }

  void add_members(ElementSet& set, std::size_t of, Fields& fields) {
    while (!fields.empty()) {
      std::string_view label = fields.next();
      if (label.empty()) continue;
      std::size_t scope = of;
      if (const std::size_t dot = label.rfind('.'); dot != label.npos) {  // Part-1-1.17
        if (const auto found = instances_.find(to_lower(label.substr(0, dot))); found != instances_.end()) {
          scope = found->second;
          label.remove_prefix(dot + 1);
        }
      }
      std::int64_t id = 0;
      const auto [last, error] = std::from_chars(label.data(), label.data() + label.size(), id);
      const bool is_number = error == std::errc{} && last == label.data() + label.size();
      if (is_number) {
        set.members.push_back({scope, {id, id, 1}});
      } else {
        if (label.size() >= 2 && label.starts_with('"') && label.ends_with('"'))
          label = label.substr(1, label.size() - 2);
        set.nested.emplace_back(scope, to_lower(label));
      }
    }
  }

  /// Instances where there are any, else parts; and what stands outside of both.
  std::vector<Body> list_bodies() const {
    std::vector<Body> bodies;
    for (std::size_t s = 1; s < scopes_.size(); ++s) {
      const bool is_part = parts_.contains(to_lower(scopes_[s].name)) && parts_.at(to_lower(scopes_[s].name)) == s;
      if (is_part == !instances_.empty()) continue;
      bodies.push_back({scopes_[s].name, {s}});
      if (scopes_[s].part != kNone) bodies.back().scopes.push_back(scopes_[s].part);
    }
    if (bodies.empty() || !scopes_[0].elements.empty()) bodies.push_back({"", {0}});
    return bodies;
  }

  /// The set `lower` of a scope; an instance has the sets of its part.
  std::optional<std::size_t> find_set(std::size_t scope, const std::string& lower) const {
    for (const std::size_t s : {scope, scopes_[scope].part}) {
      if (s == kNone) continue;
      if (const auto found = scopes_[s].sets.find(lower); found != scopes_[s].sets.end()) return found->second;
    }
    return std::nullopt;
  }

  Choice choose() {
    bodies_ = list_bodies();
    std::vector<Choice> choices;
    if (wanted_.empty()) {
      for (std::size_t b = 0; b < bodies_.size(); ++b)
        if (count_surface_elements(bodies_[b]) > 0) choices.push_back({b});
      if (choices.empty()) return {};
    } else {
      choices = find_choices(to_lower(wanted_));
    }
    if (choices.empty()) refuse_set(to_lower(wanted_), "");
    if (choices.size() == 1) return choices.front();
    std::string names;
    if (std::all_of(choices.begin(), choices.end(), [&](const Choice& c) { return c.set == choices[0].set; }) &&
        choices[0].set != kNone && scopes_[0].sets.contains(to_lower(wanted_))) {
      for (const Choice& c : choices) names += (names.empty() ? "" : ", ") + quote(bodies_[c.body].name);
      throw Unreadable(file_ + ": the set " + quote(wanted_) + " holds elements of several instances (" + names +
                       "); a blank is one piece");
    }
    for (const Choice& choice : choices)
      names += (names.empty() ? "" : ", ") +
               quote(bodies_[choice.body].name + (choice.set == kNone ? "" : "." + sets_[choice.set].name));
    throw Unreadable(file_ + ": holds several meshes" +
                     (wanted_.empty() ? std::string() : " that have a set " + quote(wanted_)) +
                     "; give the blank's as blank.mesh.set, one of: " + names);
  }

  std::size_t count_surface_elements(const Body& body) const {
    std::size_t n = 0;
    for (const std::size_t s : body.scopes) n += scopes_[s].elements.size();
    return n;
  }

  /// What a name may mean, the nearest meaning only: 'Instance.set', a set of the assembly, sets of bodies, bodies.
  std::vector<Choice> find_choices(const std::string& lower) const {
    std::vector<Choice> of_dot, of_assembly, of_bodies, whole;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const Body& body = bodies_[b];
      const std::string name = to_lower(body.name);
      if (!name.empty() && lower.starts_with(name + "."))
        if (const auto set = find_set(body.scopes[0], lower.substr(name.size() + 1))) of_dot.push_back({b, *set});
      if (const auto set = find_set(0, lower); set && !body.has(0) && reaches(*set, body))
        of_assembly.push_back({b, *set});
      if (const auto set = find_set(body.scopes[0], lower)) of_bodies.push_back({b, *set});
      const bool is_part = body.scopes.size() > 1 && to_lower(scopes_[body.scopes[1]].name) == lower;
      if (name == lower || is_part) whole.push_back({b});
    }
    for (const auto* found : {&of_dot, &of_assembly, &of_bodies})
      if (!found->empty()) return *found;
    if (const auto set = find_set(0, lower)) return {{0, *set}};  // of the assembly, and holds nothing
    return whole;
  }

  bool reaches(std::size_t set, const Body& body) const {
    const Members members = collect_members(set, body);
    const auto is_member = [&](const Scope& scope) {
      for (std::size_t i = 0; i < scope.elements.size(); ++i)
        if (members.contains(scope.elements[i].id, scope.homes[i])) return true;
      for (const auto* list : {&scope.others, &scope.rigid})
        for (const Unsupported& other : *list)
          if (members.contains(other.id, other.home)) return true;
      return false;
    };
    return std::any_of(body.scopes.begin(), body.scopes.end(), [&](std::size_t s) { return is_member(scopes_[s]); });
  }

  /// Nodes of the body where it stands, and its elements or those of its set. Refuses what cannot be kept.
  RawMesh select(const Choice& choice) const {
    const Body& body = bodies_[choice.body];
    const Eigen::Isometry3d& placement = scopes_[body.scopes[0]].placement;
    const Members members = choice.set == kNone ? Members{} : collect_members(choice.set, body);
    RawMesh mesh;
    for (const std::size_t s : body.scopes) {
      const Scope& scope = scopes_[s];
      for (RawNode node : scope.nodes) {
        auto x = Eigen::Vector3d::Map(node.x.data());
        x = (placement * x).eval();
        mesh.nodes.push_back(node);
      }
      for (std::size_t i = 0; i < scope.elements.size(); ++i)
        if (choice.set == kNone || members.contains(scope.elements[i].id, scope.homes[i]))
          mesh.elements.push_back(scope.elements[i]);
      for (const Unsupported& other : scope.others)
        if (choice.set == kNone || members.contains(other.id, other.home)) refuse_type(other);
      for (const Unsupported& rigid : scope.rigid)
        if (choice.set != kNone && members.contains(rigid.id, rigid.home)) refuse_rigid(rigid);
    }
    if (mesh.elements.empty() && choice.set == kNone)
      for (const std::size_t s : body.scopes)
        if (!scopes_[s].rigid.empty()) refuse_rigid(scopes_[s].rigid.front());
    if (mesh.elements.empty() && !wanted_.empty())
      throw Unreadable(file_ + ": the set " + quote(wanted_) + " holds no shell, membrane or plane element");
    return mesh;
  }

  [[noreturn]] void refuse_type(const Unsupported& other) const {
    refuse_element(other,
                   "; use shell, membrane or plane elements of three or four corners (S3, S4R, CPS3, M3D4, ...), or "
                   "choose a set of them");
  }
  [[noreturn]] void refuse_rigid(const Unsupported& rigid) const {
    refuse_element(rigid,
                   ", which is rigid, as a tool is; choose the set of the blank, and bring a tool as STL under tools");
  }
  [[noreturn]] void refuse_element(const Unsupported& other, const std::string& why) const {
    const std::string& path = pieces_[static_cast<std::size_t>(other.place.piece)].origin;
    throw Unreadable(path + ":" + std::to_string(other.place.line) + ": element " + std::to_string(other.id) +
                     " is of type " + quote(other.type) + why);
  }

  /// The elements of a body that a set holds: by number, and by the set of their *ELEMENT line.
  struct Members {
    std::vector<bool> reached;           ///< by set
    std::vector<Range> whole, stepped;  ///< step 1, ascending and with growing ends; others

    bool contains(std::int64_t id, std::size_t home) const {
      if (home != kNone && reached[home]) return true;
      const auto after =
          std::upper_bound(whole.begin(), whole.end(), id, [](std::int64_t x, const Range& r) { return x < r.start; });
      if (after != whole.begin() && std::prev(after)->end >= id) return true;
      return std::any_of(stepped.begin(), stepped.end(), [id](const Range& r) { return r.contains(id); });
    }
  };

  Members collect_members(std::size_t set, const Body& body) const {
    Members found{.reached = std::vector<bool>(sets_.size(), false), .whole = {}, .stepped = {}};
    std::vector<std::size_t> open{set};
    found.reached[set] = true;
    while (!open.empty()) {
      const ElementSet& next = sets_[open.back()];
      open.pop_back();
      for (const auto& [scope, range] : next.members) {
        if (!body.has(scope) && !(scope == 0 && bodies_.size() == 1)) continue;
        (range.step == 1 ? found.whole : found.stepped).push_back(range);
      }
      for (const auto& [scope, name] : next.nested) {
        auto inner = find_set(scope, name);
        if (!inner && scope == 0 && bodies_.size() == 1) inner = find_set(body.scopes[0], name);
        if (!inner) refuse_set(name, ", which " + quote(next.name) + " names");
        if (!found.reached[*inner]) open.push_back(*inner);
        found.reached[*inner] = true;
      }
    }
    auto& whole = found.whole;
    std::sort(whole.begin(), whole.end(), [](const Range& a, const Range& b) { return a.start < b.start; });
    for (std::size_t i = 1; i < whole.size(); ++i) whole[i].end = std::max(whole[i].end, whole[i - 1].end);
    return found;
  }

  [[noreturn]] void refuse_set(const std::string& lower, const std::string& named_in) const {
    std::vector<std::string> known;
    for (const Scope& scope : scopes_) {
      if (std::find(scope.node_sets.begin(), scope.node_sets.end(), lower) != scope.node_sets.end())
        throw Unreadable(file_ + ": " + quote(lower) + named_in +
                         " is a set of nodes; give a set of elements (*ELSET)");
      if (scope.sets.contains(lower))
        throw Unreadable(file_ + ": has element set " + quote(lower) + named_in + " in " +
                         (scope.name.empty() ? "the assembly" : quote(scope.name)) + " only; name an instance of it");
    }
    for (const ElementSet& set : sets_) known.push_back(set.name);
    for (const std::string& instance : list_names(instances_)) known.push_back(instance);
    throw Unreadable(file_ + ": has no element set " + quote(named_in.empty() ? wanted_ : lower) + named_in +
                     suggest_set(lower, known));
  }

  const Pieces& pieces_;
  Lines lines_;
  const std::string& file_;  ///< path of the file itself
  const std::string& wanted_;
  bool at_end_ = false, in_assembly_ = false;
  int stepped_ranges_ = 0;
  std::vector<Scope> scopes_{1};  ///< the first: what stands outside of parts and instances
  std::size_t scope_ = 0;         ///< that is being read
  std::map<std::string, std::size_t> parts_, instances_;  ///< scopes by name in lower case
  std::vector<ElementSet> sets_;
  std::vector<Body> bodies_;
};

}  // namespace

RawMesh parse_abaqus(const Pieces& file, const std::string& set) { return AbaqusReader(file, set).read(); }

}  // namespace interply::geometry
