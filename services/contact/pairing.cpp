#include "contact/pairing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace interply::contact {

Projection project(const Vector3& x, const Vector3& n, const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 u = b - a, v = c - a, r = x - a;
  const Vector3 area = u.cross(v);
  const double inv = 1 / n.dot(area);
  Projection p;
  p.weight[1] = n.dot(r.cross(v)) * inv;
  p.weight[2] = n.dot(u.cross(r)) * inv;
  p.weight[0] = 1 - p.weight[1] - p.weight[2];
  p.distance = -r.dot(area) * inv;
  p.facet_normal = area * inv;
  return p;
}

namespace {

int most_negative(const Projection& p) {
  int k = 0;
  if (p.weight[1] < p.weight[k]) k = 1;
  if (p.weight[2] < p.weight[k]) k = 2;
  return k;
}

/// law.hpp.
bool has_left(const Projection& p) {
  const double* w = p.weight;
  const double least = w[most_negative(p)];
  return least < kOnSide && !(least > -kAtCorner && std::max({w[0], w[1], w[2]}) > 1 - kAtCorner);
}

Projection project_on(const LayerGeometry& partner, const Vector3& x, const Vector3& n, int t) {
  const mechanics::Triangles& corner = partner.mesh().triangles;
  return project(x, n, partner.position(corner(0, t)), partner.position(corner(1, t)), partner.position(corner(2, t)));
}

/// Edge and share from the weights.
void settle(const mechanics::TriangleMesh& partner, Facing& facing) {
  if (!has_left(facing.projection)) return;
  double least = kOnSide;
  for (int k = 0; k < 3; ++k) {
    if (facing.projection.weight[k] >= least || partner.neighbours(k, facing.triangle) >= 0) continue;
    least = facing.projection.weight[k];
    facing.edge = k;
  }
  if (facing.edge >= 0) facing.share = std::max(0.0, 1 + least / kEdgeMargin);
}

}  // namespace

Facing hold(const LayerGeometry& partner, const Vector3& x, const Vector3& normal, int t) {
  Facing facing{.triangle = t, .projection = project_on(partner, x, normal, t)};
  settle(partner.mesh(), facing);
  return facing;
}

Facing find_facing(const LayerGeometry& partner, const Vector3& x, const Vector3& normal, int triangle) {
  constexpr int kLongestWalk = 64;
  Facing facing{.triangle = triangle, .projection = project_on(partner, x, normal, triangle)};
  int out = most_negative(facing.projection);
  for (int walked = 0; has_left(facing.projection) && walked < kLongestWalk; ++walked) {
    const int next = partner.mesh().neighbours(out, facing.triangle);
    if (next < 0) {  // try the other negative side before giving up: corners of the partner
      int second = -1;
      for (int k = 0; k < 3; ++k)
        if (k != out && facing.projection.weight[k] < kOnSide && partner.mesh().neighbours(k, facing.triangle) >= 0)
          second = k;
      if (second < 0) break;
      const int around = partner.mesh().neighbours(second, facing.triangle);
      const Projection p = project_on(partner, x, normal, around);
      if (p.weight[most_negative(p)] <= facing.projection.weight[out]) break;  // no better there
      facing.triangle = around;
      facing.projection = p;
    } else {
      facing.triangle = next;
      facing.projection = project_on(partner, x, normal, next);
    }
    out = most_negative(facing.projection);
  }
  settle(partner.mesh(), facing);
  return facing;
}

namespace {

constexpr double kInside = -1e-9;  ///< smallest weight of a triangle that holds a point

/// The best of the triangles seen so far, in the sense of search_facing().
struct Choice {
  int triangle = -1;
  double weight = -std::numeric_limits<double>::infinity();  ///< smallest
  double distance = std::numeric_limits<double>::infinity();
  bool is_inside() const { return weight >= kInside; }

  void consider(int t, const Projection& p) {
    const double smallest = p.weight[most_negative(p)], away = std::abs(p.distance);
    if (is_inside() && smallest >= kInside ? away < distance : smallest > weight) *this = {t, smallest, away};
  }
};

Eigen::AlignedBox2d bound(const LayerGeometry& layer, int t) {
  Eigen::AlignedBox2d box;
  for (int k = 0; k < 3; ++k) box.extend(layer.position(layer.mesh().triangles(k, t)).head<2>());
  const Eigen::Vector2d margin = 1e-6 * box.sizes();  // more than kInside
  return {box.min() - margin, box.max() + margin};
}

}  // namespace

int search_facing(const LayerGeometry& partner, const Vector3& x, const Vector3& normal) {
  Choice best;
  for (int t = 0; t < partner.mesh().n_elements(); ++t) best.consider(t, project_on(partner, x, normal, t));
  return best.triangle;
}

FlatSearch::FlatSearch(const LayerGeometry& partner) : partner_(partner) {
  const int n = static_cast<int>(partner.mesh().n_elements());
  Eigen::AlignedBox2d all;
  for (int t = 0; t < n; ++t) all.extend(bound(partner, t));
  const double side = std::sqrt(2 * all.volume() / n);  // some two triangles to a cell
  low_ = all.min();
  for (int axis = 0; axis < 2; ++axis) {
    n_[axis] = static_cast<int>(std::clamp(std::ceil(all.sizes()(axis) / side), 1.0, static_cast<double>(n)));
    width_(axis) = all.sizes()(axis) / n_[axis];
  }
  const auto visit = [&](const auto& put) {
    for (int t = 0; t < n; ++t) {
      const Eigen::AlignedBox2d box = bound(partner, t);
      for (int row = locate(box.min().y(), 1); row <= locate(box.max().y(), 1); ++row)
        for (int column = locate(box.min().x(), 0); column <= locate(box.max().x(), 0); ++column)
          put(cell(column, row), t);
    }
  };
  start_.assign(cell(0, n_[1]) + 1, 0);
  visit([&](std::size_t c, int) { ++start_[c + 1]; });
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  triangles_.resize(start_.back());
  std::vector<std::size_t> next = start_;
  visit([&](std::size_t c, int t) { triangles_[next[c]++] = t; });
}

int FlatSearch::locate(double at, int axis) const {
  return static_cast<int>(std::clamp((at - low_(axis)) / width_(axis), 0.0, n_[axis] - 1.0));
}

int FlatSearch::find(const Vector3& x, const Vector3& normal) const {
  Choice best;
  if (std::max(std::abs(normal.x()), std::abs(normal.y())) < 1e-12) {
    const std::size_t c = cell(locate(x.x(), 0), locate(x.y(), 1));
    for (std::size_t i = start_[c]; i < start_[c + 1]; ++i)
      best.consider(triangles_[i], project_on(partner_, x, normal, triangles_[i]));
  }
  return best.is_inside() ? best.triangle : search_facing(partner_, x, normal);
}

}  // namespace interply::contact
