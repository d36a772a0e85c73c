#include "coordinator/tools.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "contact/triangle_tool.hpp"
#include "geometry/outline.hpp"
#include "scene/files.hpp"
#include "scene/read_scene.hpp"

namespace interply::coordinator {
namespace {

using geometry::Surface;
using mechanics::at;
using mechanics::TriangleMesh;
using mechanics::Vector2;
using mechanics::Vector3;
using Points = std::vector<Vector3>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The part of a convex polygon on the side of a vertical plane where sign * (x[axis] - limit) <= 0.
void clip(Points& polygon, int axis, double limit, double sign) {
  Points inside;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double ha = sign * (a(axis) - limit), hb = sign * (b(axis) - limit);
    if (ha <= 0) inside.push_back(a);
    if ((ha < 0 && hb > 0) || (ha > 0 && hb < 0)) inside.push_back(a + ha / (ha - hb) * (b - a));
  }
  polygon.swap(inside);
}

/// Largest sign * z of the surface over the rectangle; -infinity if nothing is there.
double find_support(const Surface& s, const Rectangle& r, double sign) {
  double support = -kInfinity;
  for (Eigen::Index t = 0; t < s.triangles.cols(); ++t) {
    Points polygon;
    for (int k = 0; k < 3; ++k) polygon.push_back(at(s.vertices, s.triangles(k, t)));
    for (int axis = 0; axis < 2; ++axis) {
      clip(polygon, axis, r.max()(axis), 1);
      clip(polygon, axis, r.min()(axis), -1);
    }
    for (const Vector3& x : polygon) support = std::max(support, sign * x.z());
  }
  return support;
}

/// @param face  height of the stack's face that the tool touches, mm   @param facing  +1: the tool lies below it
PlacedTool place_surface(const scene::File& file, const std::string& key, const Rectangle& r, double face,
                         double facing) {
  const std::string content = scene::read_resolved(file, key);
  const auto refuse = [&](const std::string& why) -> scene::SceneError {
    return scene::SceneError(key + ": " + file.path + ": " + why);
  };
  PlacedTool tool;
  try {
    tool.surface = std::make_unique<Surface>(geometry::parse_stl(content, file.path));
    tool.shape = std::make_unique<contact::TriangleTool>(tool.surface->vertices, tool.surface->triangles);
  } catch (const geometry::Unreadable& error) {
    throw scene::SceneError(key + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    throw refuse(error.what());
  }
  const auto& v = tool.surface->vertices;
  const double extent = (v.rowwise().maxCoeff() - v.rowwise().minCoeff()).maxCoeff();
  const double support = find_support(*tool.surface, r, facing);
  if (support == -kInfinity)
    throw refuse(
        fmt::format("nothing of it lies over the blank, x {:.4g} to {:.4g}, y {:.4g} to {:.4g} mm; move it there",
                    r.min().x(), r.max().x(), r.min().y(), r.max().y()));
  if (extent < 0.02 * r.sizes().maxCoeff())
    throw refuse(
        fmt::format("is only {:.3g} mm large beside a blank of {:.4g} mm; an STL holds no unit and is read as mm, "
                    "so scale it (metres by 1000)",
                    extent, r.sizes().maxCoeff()));
  tool.z = face - facing * support;
  return tool;
}

/// Area of the blank whose upper face touches the tool, mm2: counted by the middles of equal parts of each element,
/// some 200 000 in all. An outline as long as four sides of the blank is then found to about 1e-4 of its area.
double measure_touching(const PlacedTool& tool, const TriangleMesh& blank, double height) {
  constexpr double kTouching = 1e-3;  // mm
  const mechanics::Scalars areas = mechanics::compute_areas(blank);
  const double spacing = std::sqrt(areas.sum()) / 300;
  double area = 0;
  for (Eigen::Index e = 0; e < blank.n_elements(); ++e) {
    const Vector3 x0 = at(blank.reference, blank.triangles(0, e));
    const Vector3 u = at(blank.reference, blank.triangles(1, e)) - x0;
    const Vector3 v = at(blank.reference, blank.triangles(2, e)) - x0;
    const double size = std::max(u.norm(), v.norm());
    if (tool.shape->evaluate(x0 + Vector3(0, 0, height - tool.z - x0.z())).value > size + kTouching) continue;
    const int n = static_cast<int>(std::clamp(std::ceil(size / spacing), 1.0, 1000.0));
    const Vector3 a = u / n, b = v / n;
    int touching = 0;
    const auto count = [&](double i, double j) {
      Vector3 x = x0 + i * a + j * b;
      x.z() = height - tool.z;
      touching += tool.shape->evaluate(x).value < kTouching;
    };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        count(i + 1.0 / 3, j + 1.0 / 3);
        if (i + j + 1 < n) count(i + 2.0 / 3, j + 2.0 / 3);
      }
    }
    area += areas(e) * touching / (static_cast<double>(n) * n);
  }
  return area;
}

/// Area of the blank over an opening and its shoulder, mm2. The outline is a polygon, made good for the area that it
/// lacks.
double measure_opening(const scene::Opening& o, const TriangleMesh& blank) {
  const auto outline = geometry::trace_opening(o.edge, o.offset + o.shoulder, 100);
  return geometry::compute_area_inside(blank, outline) * contact::compute_opening_area(o.edge, o.offset, o.shoulder) /
         geometry::compute_area(outline);
}

std::unique_ptr<contact::SignedDistance> make_plate(const scene::Opening& o, bool faces_up) {
  return std::make_unique<contact::OpeningPlate>(o.edge, o.offset, o.shoulder, faces_up);
}

}  // namespace

Rectangle bound_blank(const TriangleMesh& blank, bool half) {
  Rectangle r(Vector2(blank.reference.row(0).minCoeff(), blank.reference.row(1).minCoeff()),
              Vector2(blank.reference.row(0).maxCoeff(), blank.reference.row(1).maxCoeff()));
  if (half) r.extend(Vector2(r.min().x(), -r.max().y()));
  return r;
}

PlacedTools place_tools(const scene::Scene& scene, const TriangleMesh& lowest, const TriangleMesh& uppermost,
                        double height) {
  const scene::Tools& tools = scene.tools;
  const Rectangle below = bound_blank(lowest, scene.blank.half), above = bound_blank(uppermost, scene.blank.half);
  PlacedTools placed;
  if (tools.die.stl) {
    placed.die = place_surface(*tools.die.stl, "tools.die.stl", below, 0, 1);
  } else {
    placed.die = {.shape = make_plate(tools.die, true), .surface = nullptr, .z = 0};
  }
  const scene::Opening& opening = tools.blank_holder.opening;
  const double area = mechanics::compute_areas(uppermost).sum();
  if (opening.stl) {
    placed.blank_holder = place_surface(*opening.stl, "tools.blank_holder.stl", above, height, -1);
    placed.flange_area = measure_touching(placed.blank_holder, uppermost, height);
    if (placed.flange_area < 0.01 * area)
      throw scene::SceneError(
          fmt::format("tools.blank_holder.stl: {} touches {:.4g} of the {:.6g} mm2 of the flat blank; the pressure "
                      "needs a flat land of at least 1 %",
                      opening.stl->path, placed.flange_area, area));
  } else {
    placed.blank_holder = {.shape = make_plate(opening, false), .surface = nullptr, .z = height};
    const double hole = contact::compute_opening_area(opening.edge, opening.offset, opening.shoulder);
    const bool rectangle = !scene.blank.mesh && !scene.layers.back().mesh;
    placed.flange_area = rectangle ? (scene.blank.half ? 0.5 : 1.0) * (scene.blank.length * scene.blank.width - hole)
                                   : area - measure_opening(opening, uppermost);
  }
  if (tools.punch && tools.punch->stl) {
    placed.punch = place_surface(*tools.punch->stl, "tools.punch.stl", above, height, -1);
  } else if (tools.punch) {
    const scene::Punch& p = *tools.punch;
    placed.punch = {
        .shape = std::make_unique<contact::PyramidPunch>(p.edge, p.height, p.radius), .surface = nullptr, .z = height};
  }
  return placed;
}

}  // namespace interply::coordinator
