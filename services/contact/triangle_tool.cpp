#include "contact/triangle_tool.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "mechanics/mesh.hpp"

namespace interply::contact {
namespace {

constexpr std::size_t kLeaf = 4;  ///< triangles of a leaf at most

double compute_angle(const Vector3& a, const Vector3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Unit normal, or zero for a triangle without a usable one.
Vector3 compute_normal(const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 area = (b - a).cross(c - a);
  const double longest = std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
  const double twice = area.norm();
  if (!(twice > 1e-5 * longest)) return Vector3::Zero();
  return area / twice;
}

/// Direction of a sum of normals; where they cancel, at a fold of no thickness, that of one of the faces.
Vector3 compute_direction(const Vector3& sum, const Vector3& face) {
  const double length = sum.norm();
  return length > 1e-9 ? Vector3(sum / length) : face;
}

double squared_distance(const Vector3& low, const Vector3& high, const Vector3& x) {
  return (low - x).cwiseMax(x - high).cwiseMax(0.0).squaredNorm();
}

}  // namespace

TriangleTool::TriangleTool(const mechanics::NodalVectors& vertices, const mechanics::Triangles& triangles) {
  const auto neighbours = mechanics::find_neighbours(triangles, vertices.cols());
  const Eigen::Index n = triangles.cols();
  std::vector<Vector3> faces(static_cast<std::size_t>(n));
  std::vector<Vector3> corners(static_cast<std::size_t>(vertices.cols()), Vector3::Zero());
  std::vector<bool> is_rim(corners.size(), false);
  const auto x = [&](Eigen::Index t, int k) { return mechanics::at(vertices, triangles(k % 3, t)); };
  for (Eigen::Index t = 0; t < n; ++t) {
    Vector3& face = faces[static_cast<std::size_t>(t)] = compute_normal(x(t, 0), x(t, 1), x(t, 2));
    for (int k = 0; k < 3; ++k) {
      corners[static_cast<std::size_t>(triangles(k, t))] +=
          compute_angle(x(t, k + 1) - x(t, k), x(t, k + 2) - x(t, k)) * face;
      if (neighbours(k, t) >= 0) continue;
      for (int end = 1; end < 3; ++end) is_rim[static_cast<std::size_t>(triangles((k + end) % 3, t))] = true;
    }
  }
  for (Eigen::Index t = 0; t < n; ++t) {
    const Vector3& face = faces[static_cast<std::size_t>(t)];
    if (face.isZero(0)) continue;
    Places places;
    places.normals[0] = face;
    for (int k = 0; k < 3; ++k) {
      const int across = neighbours((k + 2) % 3, t);  // opposite corner k + 2 lies the side from k to k + 1
      const auto v = static_cast<std::size_t>(triangles(k, t));
      places.normals[static_cast<std::size_t>(1 + k)] =
          across < 0 ? face : compute_direction(face + faces[static_cast<std::size_t>(across)], face);
      places.is_rim[static_cast<std::size_t>(1 + k)] = across < 0;
      places.normals[static_cast<std::size_t>(4 + k)] = compute_direction(corners[v], face);
      places.is_rim[static_cast<std::size_t>(4 + k)] = is_rim[v];
    }
    triangles_.push_back({x(t, 0), x(t, 1) - x(t, 0), x(t, 2) - x(t, 0), face});
    places_.push_back(places);
  }
  if (triangles_.empty()) throw std::invalid_argument("no triangle of the surface has an area");
  std::vector<int> order(triangles_.size());
  std::iota(order.begin(), order.end(), 0);
  boxes_.emplace_back();
  build(0, order, 0, order.size());
  const auto old_triangles = triangles_;
  const auto old_places = places_;
  for (std::size_t i = 0; i < order.size(); ++i) {
    triangles_[i] = old_triangles[static_cast<std::size_t>(order[i])];
    places_[i] = old_places[static_cast<std::size_t>(order[i])];
  }
}

/// Halves the triangles order[begin, end) at the median of their middles along the longest side of the middles' box.
void TriangleTool::build(std::size_t box, std::vector<int>& order, std::size_t begin, std::size_t end) {
  const auto at = [&](int i) -> const Triangle& { return triangles_[static_cast<std::size_t>(i)]; };
  const auto middle = [&](int i) -> Vector3 { return at(i).corner + (at(i).to_1 + at(i).to_2) / 3; };
  Eigen::AlignedBox3d all, middles;
  for (std::size_t i = begin; i < end; ++i) {
    const Triangle& t = at(order[i]);
    for (const Vector3& x : {t.corner, Vector3(t.corner + t.to_1), Vector3(t.corner + t.to_2)}) all.extend(x);
    middles.extend(middle(order[i]));
  }
  const bool leaf = end - begin <= kLeaf;
  const std::size_t first = leaf ? begin : boxes_.size();
  boxes_[box] = {all.min(), all.max(), static_cast<int>(first), leaf ? static_cast<int>(end - begin) : 0};
  if (leaf) return;
  boxes_.resize(boxes_.size() + 2);
  Eigen::Index axis = 0;
  middles.sizes().maxCoeff(&axis);
  const std::size_t half = begin + (end - begin) / 2;
  const auto first_of = [&](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(first_of(begin), first_of(half), first_of(end),
                   [&](int a, int b) { return middle(a)(axis) < middle(b)(axis); });
  build(first, order, begin, half);
  build(first + 1, order, half, end);
}

/// Regions of the plane of a triangle by barycentric signs (Ericson, Real-Time Collision Detection (2005) 5.1.5). Not
/// inlined: both searches must round alike.
[[gnu::noinline]] TriangleTool::Nearest TriangleTool::find_nearest(const Triangle& t, int index, const Vector3& x) {
  const Vector3 p = x - t.corner;
  const auto at = [&](int place, const Vector3& away) { return Nearest{away.squaredNorm(), index, place, away}; };
  const double d1 = t.to_1.dot(p), d2 = t.to_2.dot(p);
  if (d1 <= 0 && d2 <= 0) return at(4, p);
  const Vector3 p1 = p - t.to_1, p2 = p - t.to_2;
  const double d3 = t.to_1.dot(p1), d4 = t.to_2.dot(p1);
  if (d3 >= 0 && d4 <= d3) return at(5, p1);
  const double d5 = t.to_1.dot(p2), d6 = t.to_2.dot(p2);
  if (d6 >= 0 && d5 <= d6) return at(6, p2);
  const double w2 = d1 * d4 - d3 * d2, w1 = d5 * d2 - d1 * d6, w0 = d3 * d6 - d5 * d4;
  if (w2 <= 0 && d1 >= 0 && d3 <= 0) return at(1, p - d1 / (d1 - d3) * t.to_1);
  if (w0 <= 0 && d4 >= d3 && d5 >= d6) return at(2, p1 - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t.to_2 - t.to_1));
  if (w1 <= 0 && d2 >= 0 && d6 <= 0) return at(3, p - d2 / (d2 - d6) * t.to_2);
  return at(0, t.normal.dot(p) * t.normal);
}

void TriangleTool::keep_nearer(Nearest& best, const Nearest& other) {
  if (other.squared < best.squared || (other.squared == best.squared && other.triangle < best.triangle)) best = other;
}

Distance TriangleTool::to_distance(const Nearest& nearest) const {
  const Places& places = places_[static_cast<std::size_t>(nearest.triangle)];
  const auto place = static_cast<std::size_t>(nearest.place);
  const Vector3& normal = places.normals[place];
  const double length = std::sqrt(nearest.squared), along = nearest.away.dot(normal);
  if (place == 0) return {along, normal};
  constexpr double kOnSurface = 1e-9;  // mm; nearer, the direction to the nearest point is noise
  const double sign = along >= 0 || places.is_rim[place] ? 1 : -1;
  return {sign * length, length > kOnSurface ? Vector3(sign / length * nearest.away) : normal};
}

Distance TriangleTool::evaluate_by_all(const Vector3& x) const {
  Nearest best{.squared = std::numeric_limits<double>::infinity(), .triangle = 0, .place = 0, .away = Vector3::Zero()};
  for (int i = 0; i < static_cast<int>(triangles_.size()); ++i)
    keep_nearer(best, find_nearest(triangles_[static_cast<std::size_t>(i)], i, x));
  return to_distance(best);
}

Distance TriangleTool::evaluate(const Vector3& x) const {
  // a box must not be passed over for the rounding of its distance, in mm2 where that is next to nothing
  constexpr double kRounding = 1 - 1e-12, kNothing = 1e-24;
  struct Waiting {
    int box;
    double squared;
  };
  std::array<Waiting, 64> stack;  // the tree is balanced: its depth is the binary logarithm of the triangles
  Nearest best{.squared = std::numeric_limits<double>::infinity(), .triangle = 0, .place = 0, .away = Vector3::Zero()};
  std::size_t n = 0;
  stack[n++] = {0, 0};
  while (n > 0) {
    const Waiting next = stack[--n];
    if (next.squared * kRounding > best.squared + kNothing) continue;
    const Box& box = boxes_[static_cast<std::size_t>(next.box)];
    for (int i = box.first; i < box.first + box.count; ++i)
      keep_nearer(best, find_nearest(triangles_[static_cast<std::size_t>(i)], i, x));
    if (box.count > 0) continue;
    const auto distance = [&](int child) {
      const Box& b = boxes_[static_cast<std::size_t>(child)];
      return squared_distance(b.low, b.high, x);
    };
    Waiting near{box.first, distance(box.first)}, far{box.first + 1, distance(box.first + 1)};
    if (far.squared < near.squared) std::swap(near, far);
    stack[n++] = far;
    stack[n++] = near;
  }
  return to_distance(best);
}

}  // namespace interply::contact
