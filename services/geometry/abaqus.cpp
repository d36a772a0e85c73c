#include <algorithm>
#include <charconv>
#include <functional>
#include <limits>
#include <map>

#include "geometry/raw_mesh.hpp"
#include "geometry/read_file.hpp"
#include "geometry/text_lines.hpp"

namespace interply::geometry {
namespace {

/// Element numbers start, start + step, ... up to `end`.
struct Range {
  std::int64_t start = 0, end = 0, step = 1;
  bool contains(std::int64_t id) const { return id >= start && id <= end && (id - start) % step == 0; }
};

struct ElementSet {
  std::string name;                 ///< as first written
  std::vector<Range> members;       ///< single numbers are ranges of one
  std::vector<std::string> nested;  ///< other sets, in lower case
};

/// A keyword line: *ELEMENT, TYPE=S4R, ELSET=blank
struct Keyword {
  std::string name;                               ///< lower case, without '*' and blanks
  std::map<std::string, std::string> parameters;  ///< keys in lower case; values as written, without quotes
  const std::string* find(const std::string& key) const {
    const auto found = parameters.find(key);
    return found == parameters.end() ? nullptr : &found->second;
  }
};

constexpr std::int64_t kLargestId = std::numeric_limits<std::int64_t>::max() / 4;  // sums of two do not overflow

/// Corners of an element type that lies in a surface, 0 for any other.
int count_corners(const std::string& type) {
  static const std::vector<std::string> triangles{"s3",   "s3r",   "s3rs", "stri3",  "ds3", "cps3",
                                                  "cpe3", "cpeg3", "m3d3", "sfm3d3", "r3d3"};
  static const std::vector<std::string> quadrilaterals{
      "s4",    "s4r",   "s4rs",  "s4rsw",  "s4r5", "ds4",   "cps4",   "cps4r",   "cps4i", "cpe4",
      "cpe4r", "cpe4i", "cpeg4", "cpeg4r", "m3d4", "m3d4r", "sfm3d4", "sfm3d4r", "r3d4"};
  const auto is_in = [&](const auto& types) { return std::find(types.begin(), types.end(), type) != types.end(); };
  return is_in(triangles) ? 3 : is_in(quadrilaterals) ? 4 : 0;
}

/// Bars, beams, points and connectors: they often come along with the edges of a surface, and are skipped.
bool is_point_or_curve(const std::string& type) {
  for (const char* start : {"t2d2", "t3d2", "b2", "b3", "mass", "rotaryi", "spring", "dashpot", "conn", "dcoup"})
    if (type.starts_with(start)) return true;
  return false;
}

class AbaqusReader {
 public:
  AbaqusReader(std::string_view text, const std::string& origin, const std::string& set)
      : lines_(text, origin), set_(to_lower(set)), wanted_(set) {}

  RawMesh read() {
    bool more = lines_.next();
    while (more) {
      if (is_keyword()) {
        more = read_keyword();
        continue;
      }
      more = lines_.next();
    }
    choose();
    return std::move(mesh_);
  }

 private:
  struct Unsupported {
    std::int64_t id = 0, line = 0;
    std::string type;
    std::size_t home = 0;
  };

  bool is_comment() const { return lines_.line().starts_with("**"); }
  bool is_keyword() const { return lines_.line().starts_with("*") && !is_comment(); }

  /// Goes to the next line of data of the current keyword. False at the next keyword or the end of the file.
  bool next_data() {
    while ((at_end_ = !lines_.next()) == false) {
      if (is_keyword()) return false;
      if (!lines_.line().empty() && !is_comment()) return true;
    }
    return false;
  }

  /// Reads one keyword with its data. False at the end of the file.
  bool read_keyword() {
    const Keyword keyword = parse_keyword();
    refuse_what_changes_the_mesh(keyword);
    const std::string& name = keyword.name;
    if (name == "part") {
      if (++parts_ > 1) lines_.refuse("a second *PART; export the part of the blank alone");
    } else if (name == "assembly" || name == "endassembly") {
      in_assembly_ = name == "assembly";
    } else if (name == "endinstance") {
      in_instance_ = false;
    }
    if ((name == "nset" || name == "node") && keyword.find("nset"))
      node_sets_.push_back(to_lower(*keyword.find("nset")));
    const bool of_assembly = in_assembly_ && !in_instance_ && parts_ > 0;  // its reference points
    if (name == "node" && !of_assembly)
      read_nodes();
    else if (name == "element" && !of_assembly)
      read_elements(keyword);
    else if (name == "elset")
      read_set(keyword);
    else if (name == "instance")
      read_instance();
    else
      while (next_data()) {
      }
    return !at_end_;
  }

  Keyword parse_keyword() {
    std::string text(lines_.line().substr(1));
    while (text.ends_with(',') && lines_.next()) text += lines_.line();  // continuation
    Keyword keyword;
    Fields fields(lines_, text, ',');
    for (const char c : to_lower(fields.next()))
      if (c != ' ' && c != '\t') keyword.name += c;
    while (!fields.empty()) {
      const std::string_view field = fields.next();
      const std::size_t equals = field.find('=');
      const std::string_view value = equals == std::string_view::npos ? "" : trim(field.substr(equals + 1));
      keyword.parameters[to_lower(trim(field.substr(0, equals)))] = unquote(value);
    }
    return keyword;
  }

  static std::string unquote(std::string_view text) {
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
    return std::string(text);
  }

  void refuse_what_changes_the_mesh(const Keyword& keyword) const {
    const std::string& name = keyword.name;
    const bool mesh_keyword = name == "node" || name == "element" || name == "elset";
    if (name == "include" || (mesh_keyword && keyword.find("input")))
      lines_.refuse("reads another file, which is not followed; write all of the mesh into one file");
    for (const char* generator : {"ngen", "nfill", "ncopy", "nmap", "elgen", "elcopy", "ufield"})
      if (name == generator)
        lines_.refuse("*" + name +
                      " generates nodes or elements; write the finished mesh (in Abaqus/CAE: export input)");
    if (name == "system" || (name == "node" && keyword.find("system") && to_lower(*keyword.find("system")) != "r"))
      lines_.refuse("gives nodes in another coordinate system; write them in global x, y, z");
  }

  void read_nodes() {
    while (next_data()) {
      Fields fields(lines_, ',');
      RawNode node{.id = read_id(fields, "the number of the node"), .line = lines_.number()};
      for (double& x : node.x) {
        Fields field(lines_, fields.next(), ',');
        if (!field.empty()) x = field.next_number("a coordinate");
      }
      mesh_.nodes.push_back(node);
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
    const std::string lower = to_lower(*type);
    const int corners = count_corners(lower);
    std::size_t home = kNoSet;
    if (const std::string* set = keyword.find("elset")) home = find_or_add_set(*set);
    while (next_data()) {
      Fields fields(lines_, ',');
      RawElement element{.id = read_id(fields, "the number of the element"), .n = corners, .line = lines_.number()};
      if (corners == 0) {
        if (!is_point_or_curve(lower)) others_.push_back({element.id, element.line, *type, home});
        while (lines_.line().ends_with(',') && next_data()) {
        }  // continuation
        if (at_end_ || is_keyword()) return;
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
      mesh_.elements.push_back(element);
      homes_.push_back(home);
    }
  }

  std::size_t find_or_add_set(const std::string& name) {
    const auto [found, added] = set_numbers_.emplace(to_lower(name), sets_.size());
    if (added) sets_.push_back({.name = name});
    return found->second;
  }

  void read_set(const Keyword& keyword) {
    const std::string* name = keyword.find("elset");
    if (!name || name->empty()) lines_.refuse("*ELSET has no name ELSET=");
    const std::size_t set = find_or_add_set(*name);
    while (next_data()) {
      Fields fields(lines_, ',');
      keyword.find("generate") ? add_range(sets_[set], fields) : add_members(sets_[set], fields);
    }
  }

  void add_range(ElementSet& set, Fields& fields) {
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
    set.members.push_back(range);
  }

  void add_members(ElementSet& set, Fields& fields) {
    while (!fields.empty()) {
      const std::string_view item = fields.next();
      if (item.empty()) continue;
      const std::size_t dot = item.rfind('.');  // Part-1-1.17
      const std::string_view label = dot == std::string_view::npos ? item : item.substr(dot + 1);
      std::int64_t id = 0;
      const auto [last, error] = std::from_chars(label.data(), label.data() + label.size(), id);
      const bool is_number = error == std::errc{} && last == label.data() + label.size();
      if (is_number)
        set.members.push_back({id, id, 1});
      else
        set.nested.push_back(to_lower(unquote(label)));
    }
  }

  void read_instance() {
    if (++instances_ > 1) lines_.refuse("a second *INSTANCE; export the instance of the blank alone");
    in_instance_ = true;
    while (next_data()) {
      Fields fields(lines_, ',');
      while (!fields.empty())
        if (fields.next_number("a component of the transformation") != 0)
          lines_.refuse("the instance is moved or turned, which is not followed; export the mesh in its place");
    }
  }

  /// Keeps the elements of the wanted set, and refuses one that it cannot keep.
  void choose() {
    if (set_.empty()) {
      if (!others_.empty()) refuse_type(others_.front());
      return;
    }
    const auto members = collect_members();
    std::vector<RawElement> kept;
    for (std::size_t i = 0; i < mesh_.elements.size(); ++i)
      if (members(mesh_.elements[i].id, homes_[i])) kept.push_back(mesh_.elements[i]);
    for (const Unsupported& other : others_)
      if (members(other.id, other.home)) refuse_type(other);
    if (kept.empty())
      throw Unreadable(lines_.origin() + ": the set " + quote(wanted_) + " holds no shell, membrane or plane element");
    mesh_.elements = std::move(kept);
  }

  [[noreturn]] void refuse_type(const Unsupported& other) const {
    throw Unreadable(lines_.origin() + ":" + std::to_string(other.line) + ": element " + std::to_string(other.id) +
                     " is of type " + quote(other.type) +
                     "; use shell, membrane or plane elements of three or four corners (S3, S4R, CPS3, M3D4, ...), or "
                     "choose a set of them");
  }

  /// A test of an element by number and by the set of its *ELEMENT line.
  std::function<bool(std::int64_t, std::size_t)> collect_members() const {
    std::vector<bool> reached(sets_.size(), false);
    std::vector<std::size_t> open{find_set(set_, {})};
    reached[open[0]] = true;
    std::vector<Range> whole, stepped;
    while (!open.empty()) {
      const ElementSet& set = sets_[open.back()];
      open.pop_back();
      for (const Range& r : set.members) (r.step == 1 ? whole : stepped).push_back(r);
      for (const std::string& inner : set.nested) {
        const std::size_t number = find_set(inner, set.name);
        if (!reached[number]) open.push_back(number);
        reached[number] = true;
      }
    }
    std::sort(whole.begin(), whole.end(), [](const Range& a, const Range& b) { return a.start < b.start; });
    for (std::size_t i = 1; i < whole.size(); ++i) whole[i].end = std::max(whole[i].end, whole[i - 1].end);
    return [reached, whole, stepped](std::int64_t id, std::size_t home) {
      if (home != kNoSet && reached[home]) return true;
      const auto after =
          std::upper_bound(whole.begin(), whole.end(), id, [](std::int64_t x, const Range& r) { return x < r.start; });
      if (after != whole.begin() && std::prev(after)->end >= id) return true;
      return std::any_of(stepped.begin(), stepped.end(), [id](const Range& r) { return r.contains(id); });
    };
  }

  std::size_t find_set(const std::string& lower, const std::string& named_in) const {
    const auto found = set_numbers_.find(lower);
    if (found != set_numbers_.end()) return found->second;
    const std::string in = named_in.empty() ? "" : ", which " + quote(named_in) + " names";
    if (std::find(node_sets_.begin(), node_sets_.end(), lower) != node_sets_.end())
      throw Unreadable(lines_.origin() + ": " + quote(lower) + in +
                       " is a set of nodes; give a set of elements (*ELSET)");
    std::vector<std::string> known;
    for (const ElementSet& set : sets_) known.push_back(set.name);
    throw Unreadable(lines_.origin() + ": has no element set " + quote(named_in.empty() ? wanted_ : lower) + in +
                     suggest_set(lower, known));
  }

  static constexpr std::size_t kNoSet = std::numeric_limits<std::size_t>::max();

  Lines lines_;
  std::string set_, wanted_;  ///< wanted set in lower case, and as given
  bool at_end_ = false, in_assembly_ = false, in_instance_ = false;
  int parts_ = 0, instances_ = 0, stepped_ranges_ = 0;
  RawMesh mesh_;
  std::vector<std::size_t> homes_;  ///< set that the *ELEMENT line of each element of mesh_ gives
  std::vector<Unsupported> others_;
  std::vector<ElementSet> sets_;
  std::map<std::string, std::size_t> set_numbers_;  ///< by name in lower case
  std::vector<std::string> node_sets_;
};

}  // namespace

RawMesh parse_abaqus(std::string_view text, const std::string& origin, const std::string& set) {
  return AbaqusReader(text, origin, set).read();
}

}  // namespace interply::geometry
