#include "contact/signed_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace interply::contact {

ToolShape SignedDistance::to_shape() const {
  const auto evaluate = [](const void* tool, const double x[3], double distance[4]) {
    const Distance d = static_cast<const SignedDistance*>(tool)->evaluate({x[0], x[1], x[2]});
    distance[0] = d.value;
    for (int k = 0; k < 3; ++k) distance[k + 1] = d.gradient(k);
  };
  return {.kind = ToolShape::Kind::Any, .any = {this, evaluate}};
}

Triangle2::Triangle2(double edge) {
  const double r = edge / std::sqrt(3.0);
  corners_ = {Vector2(r, 0), Vector2(-0.5 * r, 0.5 * edge), Vector2(-0.5 * r, -0.5 * edge)};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector2 along = corners_[(k + 1) % 3] - corners_[k];
    sides_[k] = {corners_[k], along, Vector2(along.y(), -along.x()).normalized(), 1 / along.squaredNorm()};
  }
}

double Triangle2::distance(const Vector2& p, Vector2& gradient) const {
  double nearest = std::numeric_limits<double>::infinity(), deepest = -nearest;
  Vector2 away = Vector2::Zero(), face_normal = Vector2::Zero();
  for (const Side& side : sides_) {
    const Vector2 from = p - side.start;
    const double height = side.normal.dot(from);
    if (height > deepest) {
      deepest = height;
      face_normal = side.normal;
    }
    const double t = std::clamp(side.along.dot(from) * side.inverse_square, 0.0, 1.0);
    const Vector2 d = from - t * side.along;
    if (d.squaredNorm() < nearest) {
      nearest = d.squaredNorm();
      away = d;
    }
  }
  if (deepest <= 0) {
    gradient = face_normal;
    return deepest;
  }
  const double distance = std::sqrt(nearest);
  gradient = away / distance;
  return distance;
}

double Triangle2::height(const Vector2& p) const {
  double deepest = -std::numeric_limits<double>::infinity();
  for (const Side& side : sides_) deepest = std::max(deepest, side.normal.dot(p - side.start));
  return deepest;
}

namespace {

TriangleShape make_triangle(double edge) { return {0.5 * edge, 0.5 * edge / std::sqrt(3.0)}; }

PunchShape make_shape(double edge, double height, double radius) {
  const TriangleShape base = make_triangle(edge);
  const double slant = std::hypot(base.inradius, height), length = std::hypot(slant, base.half_edge);
  return {.base = base,
          .radius = radius,
          .height = height,
          .normal_out = height / slant,
          .normal_up = -base.inradius / slant,
          .slant = slant,
          .edge_slant = slant / length,
          .edge_across = base.half_edge / length,
          .edge_length = length};
}

/// Vector from the nearest point of a flat convex polygon to p; only called for p above its plane.
Vector3 from_polygon(const Vector3* corner, int n, const Vector3& normal, const Vector3& p) {
  double nearest = std::numeric_limits<double>::infinity();
  Vector3 away = Vector3::Zero();
  bool inside = true;
  for (int k = 0; k < n; ++k) {
    const Vector3 a = corner[k], side = corner[(k + 1) % n] - a;
    if (side.cross(p - a).dot(normal) >= 0) continue;
    inside = false;
    const double t = std::clamp(side.dot(p - a) / side.squaredNorm(), 0.0, 1.0);
    const Vector3 d = p - a - t * side;
    if (d.squaredNorm() < nearest) {
      nearest = d.squaredNorm();
      away = d;
    }
  }
  return inside ? Vector3(normal.dot(p - corner[0]) * normal) : away;
}

}  // namespace

PyramidPunch::PyramidPunch(double edge, double height, double radius) : shape_(make_shape(edge, height, radius)) {
  const auto flat = Triangle2(edge).corners();
  const double base = radius + height;  // pyramid from the apex up to its base
  const double top = base + 20 * edge;  // the prism is long enough to have no end
  const Vector3 apex(0, 0, radius);
  const auto lift = [&](int k, double z) { return Vector3(flat[k % 3].x(), flat[k % 3].y(), z); };
  for (int k = 0; k < 3; ++k) {
    Face& side = faces_[k];
    side.n = 3;
    side.corner = {apex, lift(k + 1, base), lift(k, base), Vector3::Zero()};
    Face& wall = faces_[3 + k];
    wall.n = 4;
    wall.corner = {lift(k, base), lift(k + 1, base), lift(k + 1, top), lift(k, top)};
  }
  for (Face& face : faces_) {
    face.normal = (face.corner[1] - face.corner[0]).cross(face.corner[2] - face.corner[0]).normalized();
    const Vector3 inner(0, 0, base);
    if (face.normal.dot(face.corner[0] - inner) < 0) {  // keep corners counter-clockwise seen from outside
      std::reverse(face.corner.begin(), face.corner.begin() + face.n);
      face.normal = -face.normal;
    }
  }
}

Distance PyramidPunch::evaluate(const Vector3& x) const {
  double nearest = std::numeric_limits<double>::infinity(), deepest = -nearest;
  Vector3 away = Vector3::Zero(), face_normal = Vector3::Zero();
  for (const Face& face : faces_) {
    const double height = face.normal.dot(x - face.corner[0]);
    if (height > deepest) {
      deepest = height;
      face_normal = face.normal;
    }
    if (height <= 0) continue;
    const Vector3 d = from_polygon(face.corner.data(), face.n, face.normal, x);
    if (d.squaredNorm() < nearest) {
      nearest = d.squaredNorm();
      away = d;
    }
  }
  if (deepest <= 0) return {deepest - shape_.radius, face_normal};  // inside the sharp body: contact is lost anyway
  const double distance = std::sqrt(nearest);
  return {distance - shape_.radius, away / distance};
}

ToolShape PyramidPunch::to_shape() const { return {.kind = ToolShape::Kind::Punch, .punch = shape_}; }

OpeningPlate::OpeningPlate(double edge, double offset, double shoulder, bool faces_up)
    : triangle_(edge),
      shape_{.opening = make_triangle(edge),
             .offset = offset,
             .shoulder = shoulder,
             .land = offset + shoulder,
             .up = faces_up ? 1.0 : -1.0} {}

Distance OpeningPlate::evaluate(const Vector3& x) const {
  const double up = shape_.up, shoulder = shape_.shoulder;
  const double h = up * x.z();  // > 0 outside the plate
  if (h > -shoulder && triangle_.height(x.head<2>()) >= shape_.land) return {h, Vector3(0, 0, up)};
  Vector2 outward;  // horizontal, away from the opening's centre
  const double s = triangle_.distance(x.head<2>(), outward) - shape_.offset;  // > 0 above the plate
  // rounded quadrant {s > 0, h < 0}: measured from the centre line of the shoulder at (r, -r)
  const double p = shoulder - s, q = h + shoulder;
  Vector3 gradient;
  double value;
  if (p > 0 && q > 0) {
    const double r = std::hypot(p, q);
    value = r - shoulder;
    gradient << -p / r * outward, q / r * up;
  } else if (q >= p) {
    value = h;
    gradient << 0, 0, up;
  } else {
    value = -s;
    gradient << -outward, 0;
  }
  return {value, gradient};
}

ToolShape OpeningPlate::to_shape() const { return {.kind = ToolShape::Kind::Plate, .plate = shape_}; }

double compute_opening_area(double edge, double offset, double shoulder) {
  const double r = offset + shoulder;
  return std::sqrt(3.0) / 4 * edge * edge + 3 * edge * r + std::numbers::pi * r * r;
}

}  // namespace interply::contact
