#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <tuple>

#include "geometry/raw_mesh.hpp"
#include "geometry/read_file.hpp"

namespace interply::geometry {
namespace {

using Point = std::array<double, 2>;

constexpr double kLargestCoordinate = 1e6;  ///< mm: a kilometre; beyond it the unit is wrong
constexpr double kPlane = 1e-6;             ///< distance from the plane / size of the blank
constexpr double kFlatElement = 1e-6;       ///< twice the area / longest side squared, of an element without area
constexpr std::size_t kMostElements = 10'000'000;  ///< indices of six slots per element stay int

std::string to_text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

/// Twice the signed area of a triangle.
double cross(const Point& a, const Point& b, const Point& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double distance2(const Point& a, const Point& b) { return std::pow(b[0] - a[0], 2) + std::pow(b[1] - a[1], 2); }

class Flattener {
 public:
  Flattener(RawMesh raw, const Pieces& file) : raw_(std::move(raw)), file_(file), origin_(file.front().origin) {}

  FlatMesh flatten() {
    if (raw_.elements.empty()) throw Unreadable(origin_ + ": has no triangles or quadrilaterals");
    if (raw_.elements.size() > kMostElements) throw Unreadable(origin_ + ": has more than 10 million elements");
    sort_nodes();
    refuse_repeated_elements();
    for (RawElement& element : raw_.elements) drop_repeated_corner(element);
    find_corners();
    check_plane();
    number_points();
    for (std::size_t e = 0; e < raw_.elements.size(); ++e) add_element(e);
    check_sides();
    return std::move(mesh_);
  }

 private:
  const std::string& origin(const Place& place) const { return file_[static_cast<std::size_t>(place.piece)].origin; }
  /// "line 12", and of which file if that is another than the one of `other`.
  std::string describe(const Place& place, const Place& other) const {
    return "line " + std::to_string(place.line) +
           (origin(place) == origin(other) ? std::string() : " of " + origin(place));
  }
  [[noreturn]] void refuse(const Place& place, const std::string& sentence) const {
    throw Unreadable(origin(place) + ":" + std::to_string(place.line) + ": " + sentence);
  }
  [[noreturn]] void refuse_element(const RawElement& e, const std::string& sentence) const {
    refuse(e.place, "element " + std::to_string(e.id) + " " + sentence);
  }

  void sort_nodes() {
    auto& nodes = raw_.nodes;
    std::stable_sort(nodes.begin(), nodes.end(), [](const RawNode& a, const RawNode& b) { return a.id < b.id; });
    for (std::size_t i = 1; i < nodes.size(); ++i)
      if (nodes[i].id == nodes[i - 1].id)
        refuse(nodes[i].place, "node " + std::to_string(nodes[i].id) + " is given twice, first in " +
                                   describe(nodes[i - 1].place, nodes[i].place));
  }

  void refuse_repeated_elements() const {
    std::vector<const RawElement*> elements;
    for (const RawElement& e : raw_.elements) elements.push_back(&e);
    std::stable_sort(elements.begin(), elements.end(), [](auto* a, auto* b) { return a->id < b->id; });
    for (std::size_t i = 1; i < elements.size(); ++i)
      if (elements[i]->id == elements[i - 1]->id)
        refuse_element(*elements[i], "is given twice, first in " +
                                         describe(elements[i - 1]->place, elements[i]->place) +
                                         "; choose one set or export one part");
  }

  /// A triangle may be written as a quadrilateral whose side from corner k to k + 1 has no length.
  static void drop_repeated_corner(RawElement& e) {
    if (e.n != 4) return;
    for (std::size_t k = 0; k < 4; ++k) {
      if (e.corner[k] != e.corner[(k + 1) % 4]) continue;
      std::copy(e.corner.begin() + static_cast<std::ptrdiff_t>(k) + 1, e.corner.end(),
                e.corner.begin() + static_cast<std::ptrdiff_t>(k));
      e.n = 3;
      return;
    }
  }

  /// corners_: index in raw_.nodes of each corner.
  void find_corners() {
    used_.assign(raw_.nodes.size(), false);
    for (const RawElement& e : raw_.elements) {
      std::array<int, 4>& corners = corners_.emplace_back();
      for (int k = 0; k < e.n; ++k) {
        const std::int64_t id = e.corner[static_cast<std::size_t>(k)];
        const auto found = std::lower_bound(raw_.nodes.begin(), raw_.nodes.end(), id,
                                            [](const RawNode& node, std::int64_t x) { return node.id < x; });
        if (found == raw_.nodes.end() || found->id != id)
          refuse_element(e, "has node " + std::to_string(id) + ", which the file does not define");
        const auto node = static_cast<int>(found - raw_.nodes.begin());
        for (int other = 0; other < k; ++other)
          if (corners[static_cast<std::size_t>(other)] == node)
            refuse_element(e, "has node " + std::to_string(id) + " twice; an element has three different corners");
        corners[static_cast<std::size_t>(k)] = node;
        used_[static_cast<std::size_t>(node)] = true;
      }
    }
  }

  void check_plane() const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    std::array<double, 3> low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
    const RawNode* first = nullptr;
    for (std::size_t i = 0; i < raw_.nodes.size(); ++i) {
      if (!used_[i]) continue;
      const RawNode& node = raw_.nodes[i];
      if (!first) first = &node;
      for (std::size_t d = 0; d < 3; ++d) {
        if (!(std::abs(node.x[d]) <= kLargestCoordinate))
          refuse(node.place, "node " + std::to_string(node.id) + " lies at " + to_text(node.x[d]) +
                                " mm, not within 1e+06 mm; coordinates are in mm");
        low[d] = std::min(low[d], node.x[d]);
        high[d] = std::max(high[d], node.x[d]);
      }
    }
    const double size = std::hypot(high[0] - low[0], high[1] - low[1]);
    for (std::size_t i = 0; i < raw_.nodes.size(); ++i) {
      const RawNode& node = raw_.nodes[i];
      if (used_[i] && std::abs(node.x[2] - first->x[2]) > kPlane * size)
        refuse(node.place, "node " + std::to_string(node.id) + " lies at z = " + to_text(node.x[2]) + " mm, node " +
                              std::to_string(first->id) + " at z = " + to_text(first->x[2]) +
                              " mm; a blank is flat and lies in a plane z = const");
    }
  }

  void number_points() {
    number_.assign(raw_.nodes.size(), -1);
    for (std::size_t i = 0; i < raw_.nodes.size(); ++i) {
      if (!used_[i]) continue;
      number_[i] = static_cast<int>(mesh_.points.size());
      mesh_.points.push_back({raw_.nodes[i].x[0], raw_.nodes[i].x[1]});
    }
  }

  const Point& point(int i) const { return mesh_.points[static_cast<std::size_t>(i)]; }

  void add_element(std::size_t e) {
    const RawElement& element = raw_.elements[e];
    std::vector<int> c;
    for (int k = 0; k < element.n; ++k)
      c.push_back(number_[static_cast<std::size_t>(corners_[e][static_cast<std::size_t>(k)])]);
    double area = 0;
    for (std::size_t k = 2; k < c.size(); ++k) area += cross(point(c[0]), point(c[k - 1]), point(c[k]));
    if (area < 0) std::reverse(c.begin() + 1, c.end());  // keeps the first corner first
    if (c.size() == 3) return add_triangle(element, c[0], c[1], c[2]);
    for (std::size_t k = 0; k < 4; ++k)
      if (cross(point(c[k]), point(c[(k + 1) % 4]), point(c[(k + 2) % 4])) <= 0)
        refuse_element(element, "is not a convex quadrilateral at node " +
                                    std::to_string(id_of(element, c[(k + 1) % 4])) +
                                    "; check the order of its corners");
    constexpr double kShorter = 1 - 1e-9;  // equal diagonals: through the first corner
    if (distance2(point(c[1]), point(c[3])) < kShorter * distance2(point(c[0]), point(c[2]))) {
      add_triangle(element, c[0], c[1], c[3]);
      add_triangle(element, c[1], c[2], c[3]);
    } else {
      add_triangle(element, c[0], c[1], c[2]);
      add_triangle(element, c[0], c[2], c[3]);
    }
  }

  std::int64_t id_of(const RawElement& e, int point) const {
    for (int k = 0; k < e.n; ++k) {
      const std::size_t element = static_cast<std::size_t>(&e - raw_.elements.data());
      if (number_[static_cast<std::size_t>(corners_[element][static_cast<std::size_t>(k)])] == point)
        return e.corner[static_cast<std::size_t>(k)];
    }
    return 0;
  }

  void add_triangle(const RawElement& element, int a, int b, int c) {
    const double longest =
        std::max({distance2(point(a), point(b)), distance2(point(b), point(c)), distance2(point(c), point(a))});
    if (!(cross(point(a), point(b), point(c)) > kFlatElement * longest)) refuse_element(element, "has no area");
    mesh_.triangles.push_back({a, b, c});
    from_.push_back(static_cast<int>(&element - raw_.elements.data()));
  }

  /// Sides belong to one or two elements, which run along them in opposite directions, and hold all elements together.
  void check_sides() const {
    struct Side {
      int low, high, triangle;
      bool forward;
    };
    std::vector<Side> sides;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = mesh_.triangles[t][k], b = mesh_.triangles[t][(k + 1) % 3];
        sides.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), a < b});
      }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    const auto is_same = [&](std::size_t i, std::size_t k) {
      return k < sides.size() && sides[i].low == sides[k].low && sides[i].high == sides[k].high;
    };
    std::vector<int> piece(mesh_.triangles.size());  // a forest: towards an element of the same piece, lower or itself
    std::iota(piece.begin(), piece.end(), 0);
    const auto find_root = [&](int t) {
      while (piece[static_cast<std::size_t>(t)] != t)
        t = piece[static_cast<std::size_t>(t)] = piece[static_cast<std::size_t>(piece[static_cast<std::size_t>(t)])];
      return t;
    };
    for (std::size_t i = 0; i < sides.size(); ++i) {
      if (!is_same(i, i + 1)) continue;
      const RawElement &first = element_of(sides[i].triangle), &second = element_of(sides[i + 1].triangle);
      if (is_same(i, i + 2))
        refuse_element(element_of(sides[i + 2].triangle),
                       "is the third at a side, after elements " + std::to_string(first.id) + " and " +
                           std::to_string(second.id) + "; a blank has at most two elements at a side");
      if (sides[i].forward == sides[i + 1].forward)
        refuse_element(second, "lies on top of element " + std::to_string(first.id) + ", with which it shares a side");
      const int a = find_root(sides[i].triangle), b = find_root(sides[i + 1].triangle);
      piece[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
    for (std::size_t t = 0; t < piece.size(); ++t)
      if (find_root(static_cast<int>(t)) != 0)
        refuse_element(element_of(static_cast<int>(t)),
                       "is not connected to element " + std::to_string(element_of(0).id) +
                           " by sides; a blank is one piece: choose one set, or merge nodes that lie on each other");
  }

  const RawElement& element_of(int triangle) const {
    return raw_.elements[static_cast<std::size_t>(from_[static_cast<std::size_t>(triangle)])];
  }

  RawMesh raw_;
  const Pieces& file_;
  const std::string& origin_;  ///< of the file itself
  std::vector<std::array<int, 4>> corners_;  ///< of each raw element, index of raw node
  std::vector<bool> used_;                   ///< raw node belongs to an element
  std::vector<int> number_;                  ///< point of a raw node, or -1
  std::vector<int> from_;                    ///< raw element of a triangle
  FlatMesh mesh_;
};

}  // namespace

FlatMesh flatten(RawMesh raw, const Pieces& file) { return Flattener(std::move(raw), file).flatten(); }

}  // namespace interply::geometry
