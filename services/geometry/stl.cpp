#include "geometry/stl.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "geometry/text_lines.hpp"

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
  Words(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  bool at_end() {
    for (; at_ < text_.size() && is_blank(text_[at_]); ++at_) line_ += ends_line();
    return at_ == text_.size();
  }
  std::string_view next() {
    if (at_end()) return {};
    const std::size_t first = at_;
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    return text_.substr(first, at_ - first);
  }
  void skip_line() { at_ = std::min(text_.find_first_of("\r\n", at_), text_.size()); }
  static bool is(std::string_view word, std::string_view keyword) {
    return word.size() == keyword.size() &&
           std::equal(word.begin(), word.end(), keyword.begin(), [](char a, char b) { return (a | 32) == b; });
  }
  void expect(std::string_view keyword) {
    const std::string_view word = next();
    if (!is(word, keyword)) fail_at(word, keyword);
  }
  /// "endloop" or "end loop", of which `first` has been read.
  bool is_end_of(std::string_view first, std::string_view keyword) {
    return is(first, "end") ? is(next(), keyword) : is(first.substr(0, 3), "end") && is(first.substr(3), keyword);
  }
  void expect_end_of(std::string_view keyword) {
    const std::string_view word = next();
    if (!is_end_of(word, keyword)) fail_at(word, "end" + std::string(keyword));
  }
  double number() {
    const std::string_view word = next();
    double value = 0;
    if (!read_number(word.substr(word.starts_with('+') ? 1 : 0), value)) {
      std::string digits(word);
      if (const std::size_t d = digits.find_first_of("dD"); d != digits.npos) digits[d] = 'e';  // Fortran's 1.0D+02
      if (!read_number(digits, value)) fail(quote(word) + " is not a number");
    }
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

  static bool read_number(std::string_view digits, double& value) {
    const auto [last, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc{} && last == digits.data() + digits.size();
  }
  static bool is_blank(char c) { return std::strchr(" \t\r\n\v\f", c) != nullptr; }  // and a byte 0 that pads the end
  /// LF, or CR without LF behind it.
  bool ends_line() const {
    return text_[at_] == '\n' || (text_[at_] == '\r' && !text_.substr(at_ + 1).starts_with('\n'));
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0;
  int line_ = 1;
};

Corners read_ascii(std::string_view text, const std::string& name) {
  Words words(text, name);
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
      words.expect_end_of("loop");
      words.expect_end_of("facet");
    }
    if (!words.is_end_of(word, "solid")) words.fail_at(word, "facet or endsolid");
    words.skip_line();
  }
  return corners;
}

/// By what the file holds, not by its first word: a binary file has as many bytes as its header counts, or more, and a
/// byte 0 near its beginning, as a count has below 2^24.
/// @param bytes_after  what follows the last triangle of a binary file
Corners read_corners(const std::string& content, const std::string& name, std::size_t& bytes_after) {
  const std::uint32_t n = content.size() >= kHeader ? read_count(content) : 0;
  const std::size_t needed = kHeader + kRecord * std::size_t{n};
  if (content.size() == needed) return read_binary(content, name);
  const std::string_view text = open_text(content, name);
  if (text.substr(0, 512).find('\0') == text.npos) {
    if (!Words::is(Words(text, name).next(), "solid"))
      refuse(name, "is no STL file: as a text it does not begin with 'solid'");
    return read_ascii(text, name);
  }
  if (n > 0 && content.size() > needed) {
    bytes_after = content.size() - needed;
    return read_binary(content, name);
  }
  refuse(name, "is no STL file, or is cut off: a binary one of " + std::to_string(n) + " triangles has " +
                   std::to_string(needed) + " bytes, not " + std::to_string(content.size()) + "; export it again");
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
  Surface s;
  const Corners corners = read_corners(content, name, s.bytes_after);
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
