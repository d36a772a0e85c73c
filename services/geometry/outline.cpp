#include "geometry/outline.hpp"

#include <cmath>
#include <numbers>

namespace interply::geometry {
namespace {

using Point = std::array<double, 2>;

/// Twice the signed area of a triangle.
double cross(const Point& a, const Point& b, const Point& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// The part of a convex polygon to the left of the line from a to b.
void clip(const Outline& polygon, const Point& a, const Point& b, Outline& left) {
  left.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double of_p = cross(a, b, p), of_q = cross(a, b, q);
    if (of_p >= 0) left.push_back(p);
    if ((of_p > 0 && of_q < 0) || (of_p < 0 && of_q > 0)) {
      const double t = of_p / (of_p - of_q);
      left.push_back({p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])});
    }
  }
}

}  // namespace

Outline trace_opening(double edge, double offset, int parts) {
  Outline outline;
  for (int corner = 0; corner < 3; ++corner) {
    const double middle = 2 * std::numbers::pi * corner / 3, out = edge / std::numbers::sqrt3;
    for (int i = 0; i <= parts; ++i) {
      const double angle = middle + (2.0 * i / parts - 1) * std::numbers::pi / 3;
      outline.push_back(
          {out * std::cos(middle) + offset * std::cos(angle), out * std::sin(middle) + offset * std::sin(angle)});
    }
  }
  return outline;
}

double compute_area(const Outline& outline) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < outline.size(); ++i) twice += cross(outline[0], outline[i], outline[i + 1]);
  return twice / 2;
}

double compute_area_inside(const mechanics::TriangleMesh& mesh, const Outline& outline) {
  double area = 0;
  Outline inside, next;
  for (Eigen::Index e = 0; e < mesh.n_elements(); ++e) {
    Point corner[3];
    for (int k = 0; k < 3; ++k)
      corner[k] = {mesh.reference(0, mesh.triangles(k, e)), mesh.reference(1, mesh.triangles(k, e))};
    inside = outline;
    for (int k = 0; k < 3 && !inside.empty(); ++k) {
      clip(inside, corner[k], corner[(k + 1) % 3], next);
      inside.swap(next);
    }
    area += compute_area(inside);
  }
  return area;
}

}  // namespace interply::geometry
