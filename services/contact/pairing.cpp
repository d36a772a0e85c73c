#include "contact/pairing.hpp"

#include <algorithm>
#include <limits>

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

int search_facing(const LayerGeometry& partner, const Vector3& x, const Vector3& normal) {
  constexpr double kInside = -1e-9;
  int best = -1;
  double best_weight = -std::numeric_limits<double>::infinity();
  double best_distance = std::numeric_limits<double>::infinity();
  for (int t = 0; t < partner.mesh().n_elements(); ++t) {
    const Projection p = project_on(partner, x, normal, t);
    const double smallest = p.weight[most_negative(p)], distance = std::abs(p.distance);
    const bool inside = smallest >= kInside, best_inside = best_weight >= kInside;
    const bool better = inside && best_inside ? distance < best_distance : smallest > best_weight;
    if (!better) continue;
    best = t;
    best_weight = smallest;
    best_distance = distance;
  }
  return best;
}

}  // namespace interply::contact
