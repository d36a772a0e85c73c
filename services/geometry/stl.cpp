#include "geometry/stl.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace interply::geometry {
namespace {

using mechanics::Vector3;
using Corners = std::vector<Vector3>;  ///< three per triangle

constexpr std::size_t kHeader = 84, kRecord = 50;  ///< bytes of a binary file: header with count; triangle

[[noreturn]] void refuse(const std::string& name, const std::string& why) { throw Unreadable(name + ": " + why); }

std::uint32_t read_count(const std::string& content) {
  std::uint32_t n = 0;
  std::memcpy(&n, content.data() + 80, sizeof n);
  return n;
}

void check_coordinate(double x, const std::string& name, const std::string& where) {
  if (!(std::abs(x) <= 1e6))
    refuse(name, where + ": a coordinate is not within 1e6 mm; an STL holds no unit and is read as mm");
}

Corners read_binary(const std::string& content, const std::string& name) {
  const std::uint32_t n = read_count(content);
  Corners corners;
  corners.reserve(3 * std::size_t{n});
  for (std::size_t t = 0; t < n; ++t) {
    std::array<float, 9> x;
    std::memcpy(x.data(), content.data() + kHeader + t * kRecord + 12, sizeof x);
    for (const float c : x) check_coordinate(c, name, "triangle " + std::to_string(t + 1));
    for (int k = 0; k < 9; k += 3) corners.emplace_back(x[k], x[k + 1], x[k + 2]);
  }
  return corners;
}

/// Words of a text with the line that they stand in.
class Words {
 public:
  Words(const std::string& text, const std::string& name) : text_(text), name_(name) {}

  bool at_end() {
    while (at_ < text_.size() && std::strchr(" \t\r\n\v\f", text_[at_])) line_ += text_[at_++] == '\n';
    return at_ == text_.size();
  }
  std::string_view next() {
    if (at_end()) return {};
    const std::size_t first = at_;
    while (at_ < text_.size() && !std::strchr(" \t\r\n\v\f", text_[at_])) ++at_;
    return std::string_view(text_).substr(first, at_ - first);
  }
  void skip_line() {
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
  }
  static bool is(std::string_view word, std::string_view keyword) {
    return word.size() == keyword.size() &&
           std::equal(word.begin(), word.end(), keyword.begin(), [](char a, char b) { return (a | 32) == b; });
  }
  void expect(std::string_view keyword) {
    const std::string_view word = next();
    if (!is(word, keyword)) fail_at(word, keyword);
  }
  double number() {
    std::string_view word = next();
    const std::string_view whole = word;
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [last, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || last != word.data() + word.size()) fail(quote(whole) + " is not a number");
    return value;
  }
  [[noreturn]] void fail_at(std::string_view word, std::string_view expected) const {
    fail(quote(expected) + " is expected instead of " + quote(word));
  }
  [[noreturn]] void fail(const std::string& why) const { refuse(name_ + ":" + std::to_string(line_), why); }
  std::string where() const { return "line " + std::to_string(line_); }

 private:
  /// For a message: nothing that a terminal would take amiss.
  static std::string quote(std::string_view word) {
    if (word.empty()) return "the end of the file";
    std::string text(1, '\'');
    for (const char c : word.substr(0, 20)) text += c < ' ' || c > '~' ? '?' : c;
    return text += '\'';
  }

  const std::string& text_;
  const std::string& name_;
  std::size_t at_ = 0;
  int line_ = 1;
};

Corners read_ascii(const std::string& content, const std::string& name) {
  Words words(content, name);
  Corners corners;
  while (!words.at_end()) {
    words.expect("solid");
    words.skip_line();
    std::string_view word = words.next();
    for (; Words::is(word, "facet"); word = words.next()) {
      words.expect("normal");
      for (int k = 0; k < 3; ++k) words.next();  // often nan or nonsense
      words.expect("outer");
      words.expect("loop");
      for (int k = 0; k < 3; ++k) {
        words.expect("vertex");
        Vector3& x = corners.emplace_back();
        for (double& c : x) check_coordinate(c = words.number(), name, words.where());
      }
      words.expect("endloop");
      words.expect("endfacet");
    }
    if (!Words::is(word, "endsolid")) words.fail_at(word, "facet or endsolid");
    words.skip_line();
  }
  return corners;
}

Corners read_corners(const std::string& content, const std::string& name) {
  const bool has_header = content.size() >= kHeader;
  if (has_header && content.size() == kHeader + kRecord * std::size_t{read_count(content)})
    return read_binary(content, name);
  if (content.size() >= 5 && Words::is(std::string_view(content).substr(0, 5), "solid"))
    return read_ascii(content, name);
  refuse(name, has_header ? "is no STL file: it does not begin with 'solid', and a binary one of " +
                                std::to_string(read_count(content)) + " triangles has " +
                                std::to_string(kHeader + kRecord * std::size_t{read_count(content)}) + " bytes, not " +
                                std::to_string(content.size())
                          : "is no STL file: it does not begin with 'solid' and is shorter than a binary header");
}

struct Cell {
  std::int64_t x, y, z;
  bool operator==(const Cell&) const = default;
};
struct CellHash {
  std::size_t operator()(const Cell& c) const {
    std::uint64_t h = 0;
    for (const std::int64_t k : {c.x, c.y, c.z})
      h = (h ^ static_cast<std::uint64_t>(k)) * 0x9E3779B97F4A7C15u, h ^= h >> 29;
    return h;
  }
};

/// Vertex of each corner. Cells are as large as the welding distance, so that a partner lies in one of the 27 around.
std::vector<int> weld(const Corners& corners, double distance, Corners& vertices) {
  std::unordered_multimap<Cell, int, CellHash> cells;
  const auto cell_of = [&](double x) { return static_cast<std::int64_t>(std::floor(x / distance)); };
  const auto find = [&](const Vector3& x, const Cell& c) {
    for (std::int64_t k = 0; k < 27; ++k) {
      const auto [begin, end] = cells.equal_range({c.x + k % 3 - 1, c.y + k / 3 % 3 - 1, c.z + k / 9 - 1});
      for (auto it = begin; it != end; ++it)
        if ((vertices[static_cast<std::size_t>(it->second)] - x).norm() <= distance) return it->second;
    }
    return -1;
  };
  std::vector<int> index;
  index.reserve(corners.size());
  for (const Vector3& x : corners) {
    const Cell cell{cell_of(x.x()), cell_of(x.y()), cell_of(x.z())};
    int found = find(x, cell);
    if (found < 0) {
      found = static_cast<int>(vertices.size());
      vertices.push_back(x);
      cells.emplace(cell, found);
    }
    index.push_back(found);
  }
  return index;
}

std::string describe(const Surface& s, int vertex) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.4g, %.4g, %.4g)", s.vertices(0, vertex), s.vertices(1, vertex),
                s.vertices(2, vertex));
  return text;
}

std::string describe_side(const Surface& s, int a, int b) {
  return "the side from " + describe(s, a) + " to " + describe(s, b);
}

/// Fills in `neighbours` and `open_sides`.
void connect(Surface& s, const std::string& name) {
  struct Side {
    Eigen::Index triangle;
    int k, from;
    bool paired;
  };
  std::unordered_map<std::uint64_t, Side> sides;
  s.neighbours = Triangles::Constant(3, s.triangles.cols(), -1);
  for (Eigen::Index t = 0; t < s.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = s.triangles(k, t), b = s.triangles((k + 1) % 3, t);
      const auto low = static_cast<std::uint64_t>(std::min(a, b)), high = static_cast<std::uint64_t>(std::max(a, b));
      const auto [found, is_new] = sides.try_emplace(low << 32 | high, Side{t, k, a, false});
      if (is_new) continue;
      Side& other = found->second;
      if (other.paired)
        refuse(name, describe_side(s, a, b) +
                         " belongs to more than two triangles; export one solid or one skin "
                         "without inner walls");
      if (other.from == a)
        refuse(name, "the two triangles at " + describe_side(s, a, b) +
                         " face opposite ways; make the normals of the surface consistent before exporting it");
      other.paired = true;
      s.neighbours(k, t) = static_cast<int>(other.triangle);
      s.neighbours(other.k, other.triangle) = static_cast<int>(t);
    }
  }
  s.open_sides = static_cast<int>((s.neighbours == -1).count());
}

/// Turns each closed connected part whose normals point inwards (its volume 1/6 sum x0.(x1 x x2) is negative).
void turn_outwards(Surface& s, const std::string& name) {
  std::vector<bool> seen(static_cast<std::size_t>(s.triangles.cols()), false);
  const Vector3 origin = mechanics::at(s.vertices, 0);
  for (Eigen::Index first = 0; first < s.triangles.cols(); ++first) {
    if (seen[static_cast<std::size_t>(first)]) continue;
    std::vector<Eigen::Index> part{first};
    seen[static_cast<std::size_t>(first)] = true;
    bool closed = true;
    double volume = 0, area = 0;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Eigen::Index t = part[i];
      const auto x = [&](int k) -> Vector3 { return mechanics::at(s.vertices, s.triangles(k, t)) - origin; };
      volume += x(0).dot(x(1).cross(x(2))) / 6;
      area += (x(1) - x(0)).cross(x(2) - x(0)).norm() / 2;
      for (int k = 0; k < 3; ++k) {
        const Eigen::Index other = s.neighbours(k, t);
        if (other < 0) closed = false;
        if (other < 0 || seen[static_cast<std::size_t>(other)]) continue;
        seen[static_cast<std::size_t>(other)] = true;
        part.push_back(other);
      }
    }
    if (closed && std::abs(volume) <= s.weld * area)
      refuse(name, "holds a closed part without a volume, with a triangle at " + describe(s, s.triangles(0, first)) +
                       "; remove its second, coinciding skin");
    if (!closed || volume > 0) continue;
    for (const Eigen::Index t : part) {  // corners 0 1 2 -> 0 2 1: sides 01 12 20 -> 02 21 10
      std::swap(s.triangles(1, t), s.triangles(2, t));
      std::swap(s.neighbours(0, t), s.neighbours(2, t));
    }
  }
}

}  // namespace

Surface parse_stl(const std::string& content, const std::string& name) {
  const Corners corners = read_corners(content, name);
  Surface s;
  if (!corners.empty()) {
    Eigen::AlignedBox3d box;
    for (const Vector3& x : corners) box.extend(x);
    s.weld = std::max(1e-6, 1e-6 * box.diagonal().norm());
  }
  Corners vertices;
  const std::vector<int> index = weld(corners, s.weld, vertices);
  std::vector<std::size_t> kept;
  for (std::size_t t = 0; t < index.size(); t += 3)
    if (index[t] != index[t + 1] && index[t + 1] != index[t + 2] && index[t + 2] != index[t]) kept.push_back(t);
  if (kept.empty()) refuse(name, "holds no triangle with an area");
  s.collapsed = static_cast<int>(index.size() / 3 - kept.size());
  s.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
  for (std::size_t v = 0; v < vertices.size(); ++v)
    for (int k = 0; k < 3; ++k) s.vertices(k, static_cast<Eigen::Index>(v)) = vertices[v](k);
  s.triangles.resize(3, static_cast<Eigen::Index>(kept.size()));
  for (std::size_t t = 0; t < kept.size(); ++t)
    for (int k = 0; k < 3; ++k)
      s.triangles(k, static_cast<Eigen::Index>(t)) = index[kept[t] + static_cast<std::size_t>(k)];
  connect(s, name);
  turn_outwards(s, name);
  return s;
}

}  // namespace interply::geometry
