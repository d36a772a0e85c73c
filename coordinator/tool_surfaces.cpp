#include "coordinator/tool_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/outline.hpp"

namespace interply::coordinator {
namespace {

using mechanics::at;
using mechanics::Vector3;
using observe::ToolSurface;
using Ring = std::vector<Vector3>;

constexpr double kRightAngle = std::numbers::pi / 2;
constexpr int kPartsOfACorner = 16;

/// Triangles between closed rings of equally many points. Outside is where one ring goes around counter-clockwise below
/// the next.
ToolSurface join(const std::vector<Ring>& rings) {
  const auto n = static_cast<int>(rings.front().size()), m = static_cast<int>(rings.size());
  ToolSurface surface{mechanics::NodalVectors(3, n * m), mechanics::Triangles(3, 2 * n * (m - 1))};
  for (int r = 0; r < m; ++r)
    for (int i = 0; i < n; ++i)
      surface.nodes.col(r * n + i) = rings[static_cast<std::size_t>(r)][static_cast<std::size_t>(i)].array();
  Eigen::Index count = 0;
  for (int r = 0; r + 1 < m; ++r) {
    for (int i = 0; i < n; ++i) {
      const int a = r * n + i, b = r * n + (i + 1) % n;
      const bool is_apex = at(surface.nodes, a) == at(surface.nodes, b);
      if (!is_apex) surface.triangles.col(count++) << a, b, b + n;
      surface.triangles.col(count++) << a, b + n, a + n;
    }
  }
  surface.triangles.conservativeResize(3, count);
  return surface;
}

/// Land, shoulder and wall of a plate that faces up, from outside inwards. @param reach  of the land from the axis, mm
ToolSurface make_plate(const scene::Opening& o, double reach, double depth) {
  constexpr int kPartsOfTheShoulder = 8;
  std::vector<Ring> rings;
  const auto add_ring = [&](double offset, double z) {
    Ring& ring = rings.emplace_back();
    for (const auto& [x, y] : geometry::trace_opening(o.edge, offset, kPartsOfACorner)) ring.emplace_back(x, y, z);
  };
  add_ring(std::max(reach, o.offset + o.shoulder), 0);
  for (int i = 0; i <= kPartsOfTheShoulder; ++i) {
    const double angle = kRightAngle * i / kPartsOfTheShoulder;
    add_ring(o.offset + o.shoulder * (1 - std::sin(angle)), -o.shoulder * (1 - std::cos(angle)));
  }
  add_ring(o.offset, -o.shoulder - depth);
  return join(rings);
}

ToolSurface turn_over(ToolSurface surface) {
  surface.nodes.row(2) *= -1;
  surface.triangles.row(1).swap(surface.triangles.row(2));
  return surface;
}

/// Where a ray from far away along `-direction` to `centre` meets a convex body around it: as far on as its distance
/// allows, until none is left.
Vector3 trace(const contact::SignedDistance& shape, const Vector3& centre, const Vector3& direction, double far) {
  double along = far;
  for (int i = 0; i < 1000; ++i) {
    const double distance = shape.evaluate(centre + along * direction).value;
    along -= distance;
    if (distance < 1e-9 * far) break;
  }
  return centre + along * direction;
}

/// Rings around the axis of the punch, from its lowest point to its base and up the prism. @param top  mm
ToolSurface make_punch(const scene::Punch& p, const contact::SignedDistance& shape, double top) {
  constexpr int kRings = 30, kAround = 144;
  const Vector3 centre(0, 0, p.radius + p.height);  // of the base
  const double far = 2 * (p.edge + p.height + p.radius);
  std::vector<Ring> rings{Ring(kAround, Vector3::Zero())};
  for (int r = 1; r <= kRings; ++r) {
    const double angle = kRightAngle * r / kRings;
    Ring& ring = rings.emplace_back();
    for (int i = 0; i < kAround; ++i) {
      const double around = 4 * kRightAngle * i / kAround;
      const Vector3 out(std::cos(around), std::sin(around), 0);
      ring.push_back(trace(shape, centre, std::sin(angle) * out - std::cos(angle) * Vector3::UnitZ(), far));
    }
  }
  rings.push_back(rings.back());
  for (Vector3& x : rings.back()) x.z() = std::max(top, x.z());
  return join(rings);
}

}  // namespace

std::vector<ToolSurface> make_tool_surfaces(const scene::Scene& scene, const PlacedTools& placed,
                                            const mechanics::TriangleMesh& blank) {
  constexpr double kMore = 10;  // mm
  const double reach = blank.reference.matrix().topRows<2>().colwise().norm().maxCoeff() + kMore;
  const double depth = scene.motion.stroke + kMore;
  const auto take = [](const geometry::Surface& s) { return ToolSurface{s.vertices, s.triangles}; };
  const scene::Tools& tools = scene.tools;
  std::vector<ToolSurface> surfaces;
  surfaces.push_back(placed.die.surface ? take(*placed.die.surface) : make_plate(tools.die, reach, depth));
  surfaces.push_back(placed.blank_holder.surface ? take(*placed.blank_holder.surface)
                                                 : turn_over(make_plate(tools.blank_holder.opening, reach, depth)));
  if (!placed.punch.shape) return surfaces;
  surfaces.push_back(placed.punch.surface ? take(*placed.punch.surface)
                                          : make_punch(*tools.punch, *placed.punch.shape, depth + tools.punch->height));
  return surfaces;
}

}  // namespace interply::coordinator
