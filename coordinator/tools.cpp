#include "coordinator/tools.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>

#include "contact/triangle_tool.hpp"
#include "geometry/outline.hpp"
#include "scene/files.hpp"
#include "scene/read_scene.hpp"
#include "solve/layer_mechanics.hpp"

namespace interply::coordinator {
namespace {

using geometry::Surface;
using mechanics::at;
using mechanics::TriangleMesh;
using mechanics::Vector2;
using mechanics::Vector3;
using Points = std::vector<Vector3>;
using Rectangle = Eigen::AlignedBox2d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The bounding rectangle of the whole blank.
Rectangle bound(const TriangleMesh& blank, bool half) {
  Rectangle r(Vector2(blank.reference.row(0).minCoeff(), blank.reference.row(1).minCoeff()),
              Vector2(blank.reference.row(0).maxCoeff(), blank.reference.row(1).maxCoeff()));
  if (half) r.extend(Vector2(r.min().x(), -r.max().y()));
  return r;
}

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
    const int n = static_cast<int>(std::clamp(std::ceil(std::max(u.norm(), v.norm()) / spacing), 1.0, 1000.0));
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

/// Points of the surface at most about 2 mm apart along its sides, in world coordinates with the tool at height z.
template <class Visit>
void sample(const Surface& s, double z, Visit visit) {
  constexpr double kSpacing = 2;
  for (Eigen::Index t = 0; t < s.triangles.cols(); ++t) {
    const auto x = [&](int k) -> Vector3 { return at(s.vertices, s.triangles(k % 3, t)) + Vector3(0, 0, z); };
    int first = 0;  // of the shortest side, so that a needle gets few
    for (int k = 1; k < 3; ++k)
      if ((x(k + 1) - x(k)).norm() < (x(first + 1) - x(first)).norm()) first = k;
    const Vector3 x0 = x(first), a = x(first + 1) - x0, b = x(first + 2) - x0;
    const double n = std::clamp(std::ceil(a.norm() / kSpacing), 1.0, 500.0);
    const double m = std::clamp(std::ceil(b.norm() / kSpacing), 1.0, 500.0);
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i / n + j / m < 1 + 1e-9; ++j) visit(Vector3(x0 + i / n * a + j / m * b));
  }
}

/// Smallest distance between two tools at given heights, at least one of them a surface, and where.
struct Clearance {
  double value = kInfinity;
  Vector3 place = Vector3::Zero();
};
Clearance find_clearance(const PlacedTool& one, double z_one, const PlacedTool& other, double z_other) {
  Clearance least;
  const auto measure = [&](const PlacedTool& sampled, double z_sampled, const PlacedTool& tool, double z_tool) {
    if (!sampled.surface) return;
    sample(*sampled.surface, z_sampled, [&](const Vector3& x) {
      const double d = tool.shape->evaluate(x - Vector3(0, 0, z_tool)).value;
      if (d < least.value) least = {d, x};
    });
  };
  measure(one, z_one, other, z_other);
  measure(other, z_other, one, z_one);
  return least;
}

void check_clearance(const std::string& key, const Clearance& found, double needed, const std::string& between) {
  if (found.value >= needed - 1e-3) return;  // an STL holds seven digits
  throw scene::SceneError(
      fmt::format("{}: at full stroke {} leave {:.4g} mm at ({:.4g}, {:.4g}, {:.4g}), less than the {:.4g} mm that "
                  "must stay; widen the "
                  "opening or shorten motion.stroke",
                  key, between, found.value, found.place.x(), found.place.y(), found.place.z(), needed));
}

void check_in_front(const std::string& key, const PlacedTool& tool, const TriangleMesh& blank, double face) {
  if (!tool.surface) return;
  for (Eigen::Index i = 0; i < blank.n_nodes(); ++i) {
    const Vector3 x(blank.reference(0, i), blank.reference(1, i), face);
    const double d = tool.shape->evaluate(x - Vector3(0, 0, tool.z)).value;
    if (d > -0.01) continue;
    throw scene::SceneError(fmt::format(
        "{}: the flat stack at ({:.4g}, {:.4g}) lies {:.4g} mm behind the surface; {}", key, x.x(), x.y(), -d,
        tool.surface->is_watertight()
            ? "the tool's touching point must be its outermost one over the blank"
            : "it is open at " + std::to_string(tool.surface->open_sides) +
                  " sides, so its normals must point towards the blank: turn them, or close the surface to a solid"));
  }
}

void warn_of_asymmetry(const std::string& key, const PlacedTool& tool, double allowed,
                       std::vector<std::string>& warnings) {
  if (!tool.surface || tool.surface->vertices.row(1).minCoeff() > -1) return;  // a half that ends at the plane
  Clearance largest{0, Vector3::Zero()};
  const auto& v = tool.surface->vertices;
  for (Eigen::Index i = 0; i < v.cols(); ++i) {
    const double d = std::abs(tool.shape->evaluate({v(0, i), -v(1, i), v(2, i)}).value);
    if (d > largest.value) largest = {d, at(v, i)};
  }
  if (largest.value > allowed)
    warnings.push_back(
        fmt::format("{}: is not symmetric about y = 0, by {:.3g} mm at ({:.4g}, {:.4g}, {:.4g}); the half model uses y "
                    ">= 0 of it, so "
                    "use symmetry: full",
                    key, largest.value, largest.place.x(), largest.place.y(), largest.place.z()));
}

/// Where the blank can come to: over its rectangle, not farther from the face of the flat stack than `depth`.
struct Reach {
  Rectangle rectangle;
  double face = 0;    ///< mm
  double facing = 0;  ///< +1: the tool lies below the face
  double depth = 0;   ///< mm
  bool holds(const Vector3& x) const {
    return rectangle.contains(Vector2(x.x(), x.y())) && facing * (face - x.z()) <= depth;
  }
};

/// Side of the squares whose halves have the mean area of the triangles, mm.
double compute_element_size(const TriangleMesh& mesh) {
  return std::sqrt(2 * mechanics::compute_areas(mesh).sum() / static_cast<double>(mesh.n_elements()));
}

/// True if a node of the flat layer meets the tool within `travel`, mm: steps as long as the distance pass nothing by.
bool meets_a_node(const PlacedTool& tool, const TriangleMesh& layer, const Reach& reach, double travel) {
  constexpr double kTouching = 1e-3;  // mm; an STL holds seven digits
  for (Eigen::Index i = 0; i < layer.n_nodes(); ++i) {
    Vector3 x(layer.reference(0, i), layer.reference(1, i), reach.face - tool.z);
    for (double way = 0; way <= travel;) {
      const double distance = tool.shape->evaluate(x).value;
      if (distance < kTouching) return true;
      way += distance;
      x.z() -= reach.facing * distance;
    }
  }
  return false;
}

/// Radius of the surface at one of its points as sides of length h see it: (h/2)^2 = 2 r f + f^2 for a surface that
/// falls by f on both sides, of eight directions the worst. Infinite where it is flat or hollow.
double probe_radius(const contact::SignedDistance& tool, const Vector3& x, double h) {
  const Vector3 normal = tool.evaluate(x).gradient;
  const Vector3 a = normal.unitOrthogonal(), b = normal.cross(a);
  double smallest = kInfinity;
  for (int k = 0; k < 4; ++k) {
    const double angle = k * M_PI / 4, half = h / 2;
    const Vector3 side = half * (std::cos(angle) * a + std::sin(angle) * b);
    const double fall = std::min(tool.evaluate(x + side).value, tool.evaluate(x - side).value);
    if (fall > 0) smallest = std::min(smallest, std::max(0.0, (half * half - fall * fall) / (2 * fall)));
  }
  return smallest;
}

/// Vertices at the rim of an open surface.
std::vector<bool> find_rim(const Surface& s) {
  std::vector<bool> rim(static_cast<std::size_t>(s.vertices.cols()), false);
  for (Eigen::Index t = 0; t < s.triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k)
      if (s.neighbours(k, t) < 0)
        for (const int corner : {k, (k + 1) % 3}) rim[static_cast<std::size_t>(s.triangles(corner, t))] = true;
  return rim;
}

/// Smallest radius of a surface within reach, by at most 2000 of its vertices, and where in the file's coordinates.
struct Rounding {
  double radius = kInfinity;
  Vector3 place = Vector3::Zero();
};
Rounding find_sharpest(const PlacedTool& tool, const Reach& reach, double h, bool is_half) {
  const Surface& s = *tool.surface;
  const std::vector<bool> rim = find_rim(s);
  std::vector<Vector3> near;
  for (Eigen::Index i = 0; i < s.vertices.cols(); ++i) {
    const Vector3 x = at(s.vertices, i);
    const bool at_cut = is_half && x.y() < 1e-3;  // the mirror image goes on there
    if (!rim[static_cast<std::size_t>(i)] && !at_cut && reach.holds(x + Vector3(0, 0, tool.z))) near.push_back(x);
  }
  Rounding sharpest;
  const std::size_t stride = near.size() / 2000 + 1;
  for (std::size_t i = 0; i < near.size(); i += stride)
    if (const double r = probe_radius(*tool.shape, near[i], h); r < sharpest.radius) sharpest = {r, near[i]};
  for (int i = 0; i < 8 && sharpest.radius < h / 2 && sharpest.radius > 1e-3 * h; ++i)  // a finer look at a finer place
    sharpest.radius = std::min(sharpest.radius, probe_radius(*tool.shape, sharpest.place, 2 * sharpest.radius));
  return sharpest;
}

constexpr double kFine = 0.75;  ///< radius / element size below which a tool is finer than the mesh

void warn_of_radius(const std::string& key, double radius, double h, const std::string& layer, const std::string& where,
                    std::vector<std::string>& warnings) {
  if (radius >= kFine * h) return;
  const bool is_edge = radius < 0.02 * h;
  const std::string cure = is_edge ? fmt::format("round it to {:.3g} mm or more", h)
                                   : fmt::format("a mesh of {:.3g} mm would do", radius);
  warnings.push_back(fmt::format("{}: {}{} is finer than the {:.3g} mm mesh of {}: contact is at nodes, and what lies "
                                 "between them is not seen; {}",
                                 key, is_edge ? "a sharp edge" : fmt::format("a radius of {:.3g} mm", radius), where, h,
                                 layer, cure));
}

/// An open surface may be a skin that reaches beyond the blank, or a solid with a hole.
void warn_of_holes(const std::string& key, const PlacedTool& tool, const Reach& reach,
                   std::vector<std::string>& warnings) {
  const Surface& s = *tool.surface;
  if (s.is_watertight()) return;
  std::vector<int> loop(static_cast<std::size_t>(s.vertices.cols()));  // towards the lowest vertex of the loop
  std::iota(loop.begin(), loop.end(), 0);
  const auto find_root = [&](int v) {
    while (loop[static_cast<std::size_t>(v)] != v) v = loop[static_cast<std::size_t>(v)];
    return v;
  };
  for (Eigen::Index t = 0; t < s.triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      if (s.neighbours(k, t) >= 0) continue;
      const int a = find_root(s.triangles(k, t)), b = find_root(s.triangles((k + 1) % 3, t));
      loop[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  const std::vector<bool> rim = find_rim(s);
  std::map<int, std::pair<Eigen::AlignedBox3d, bool>> loops;  // box; whether the blank can get there
  for (Eigen::Index i = 0; i < s.vertices.cols(); ++i) {
    if (!rim[static_cast<std::size_t>(i)]) continue;
    auto& [box, is_near] = loops[find_root(static_cast<int>(i))];
    box.extend(at(s.vertices, i));
    is_near = is_near || reach.holds(at(s.vertices, i) + Vector3(0, 0, tool.z));
  }
  const double size = (s.vertices.rowwise().maxCoeff() - s.vertices.rowwise().minCoeff()).matrix().norm();
  for (const auto& [root, found] : loops) {
    const auto& [box, is_near] = found;
    if (!is_near && box.diagonal().norm() > size / 4) continue;
    const Vector3 middle = box.center();
    warnings.push_back(
        fmt::format("{}: the surface is open at {} sides, near ({:.4g}, {:.4g}, {:.4g}) around {:.3g} mm{}; close it "
                    "to a solid, or let a skin reach beyond the blank",
                    key, s.open_sides, middle.x(), middle.y(), middle.z(), box.diagonal().norm(),
                    is_near ? ", where the blank can get behind it" : ""));
    return;
  }
}

/// Contact acts at the nodes of the layer: warns of a tool that is too fine to meet them, or to be followed by them.
void warn_of_fineness(const scene::Scene& scene, const std::string& tool_key, const PlacedTool& tool, double radius,
                      const TriangleMesh& layer, const std::string& name, const Reach& reach, double travel,
                      std::vector<std::string>& warnings) {
  const double h = compute_element_size(layer);
  const std::string key = tool.surface ? tool_key + ".stl" : tool_key;
  if (!meets_a_node(tool, layer, reach, travel)) {
    std::string cure = "mesh finer than the tool";
    if (tool.surface) {
      Rectangle width;
      for (Eigen::Index i = 0; i < tool.surface->vertices.cols(); ++i)
        if (const Vector3 x = at(tool.surface->vertices, i); reach.holds(x + Vector3(0, 0, tool.z)))
          width.extend(Vector2(x.x(), x.y()));
      if (!width.isEmpty() && width.sizes().minCoeff() > 0)
        cure = fmt::format("it is {:.3g} mm wide, so that a mesh of {:.2g} mm would do", width.sizes().minCoeff(),
                           width.sizes().minCoeff() / 2);
    }
    warnings.push_back(fmt::format("{}: can touch no node of {} on its way of {:g} mm: contact is at nodes, and it "
                                   "passes between them or beside the blank ({:.3g} mm mesh); {}",
                                   key, name, travel, h, cure));
    return;
  }
  if (!tool.surface) return warn_of_radius(key, radius, h, name, "", warnings);
  const bool is_half = scene.blank.half && tool.surface->vertices.row(1).minCoeff() > -1;
  const Rounding sharpest = find_sharpest(tool, reach, h, is_half);
  const Vector3& x = sharpest.place;
  warn_of_radius(key, sharpest.radius, h, name, fmt::format(" at ({:.4g}, {:.4g}, {:.4g})", x.x(), x.y(), x.z()),
                 warnings);
}

void warn_of_motion(const scene::Scene& scene, std::vector<std::string>& warnings) {
  if (!scene.tools.punch && scene.motion.stroke > 0)
    warnings.push_back(
        fmt::format("tools.punch: is missing: motion.stroke = {:g} mm moves nothing, the stack is only squeezed; give "
                    "tools.punch, or motion.stroke: 0",
                    scene.motion.stroke));
  if (scene.tools.punch && scene.motion.stroke == 0)
    warnings.push_back("motion.stroke: is 0: the punch stays where it touches the flat stack");
}

}  // namespace

PlacedTools place_tools(const scene::Scene& scene, const TriangleMesh& lowest, const TriangleMesh& uppermost,
                        double height) {
  const scene::Tools& tools = scene.tools;
  const Rectangle below = bound(lowest, scene.blank.half), above = bound(uppermost, scene.blank.half);
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

std::vector<std::string> check_tools(const scene::Scene& scene) {
  std::vector<std::string> warnings;
  warn_of_motion(scene, warnings);
  const scene::Tools& t = scene.tools;
  double height = 0;
  for (const scene::Layer& layer : scene.layers) height += layer.thickness;
  const TriangleMesh lowest = solve::make_layer_mesh(scene, 0);
  const TriangleMesh uppermost = solve::make_layer_mesh(scene, static_cast<int>(scene.layers.size()) - 1);
  const PlacedTools placed = place_tools(scene, lowest, uppermost, height);
  const std::string &first = scene.layers.front().name, &last = scene.layers.back().name;
  const double stroke = scene.motion.stroke;
  const struct {
    const char* key;
    const PlacedTool& tool;
    double radius;  ///< of an analytic tool, mm
    const TriangleMesh& blank;
    const std::string& layer;
    double face, facing, depth, travel;
  } all[] = {{"tools.die", placed.die, t.die.shoulder, lowest, first, 0, 1, stroke, stroke},
             {"tools.blank_holder", placed.blank_holder, t.blank_holder.opening.shoulder, uppermost, last, height, -1,
              height, 0},
             {"tools.punch", placed.punch, t.punch ? t.punch->radius : 0, uppermost, last, height, -1, stroke, stroke}};
  for (const auto& [key, tool, radius, blank, layer, face, facing, depth, travel] : all) {
    if (!tool.shape) continue;
    const Reach reach{bound(blank, scene.blank.half), face, facing, depth};
    if (tool.surface) {
      const std::string stl = std::string(key) + ".stl";
      check_in_front(stl, tool, blank, face);
      if (scene.blank.half) warn_of_asymmetry(stl, tool, 0.01 * height, warnings);
      warn_of_holes(stl, tool, reach, warnings);
      if (tool.surface->bytes_after > 0)
        warnings.push_back(fmt::format("{}: holds {} bytes after its last triangle, which are not read", stl,
                                       tool.surface->bytes_after));
    }
    warn_of_fineness(scene, key, tool, radius, blank, layer, reach, travel, warnings);
  }
  if (!t.die.stl && !t.blank_holder.opening.stl && !(t.punch && t.punch->stl)) return warnings;
  if (!placed.punch.shape) return warnings;
  const double z = placed.punch.z - stroke;
  check_clearance(placed.punch.surface ? "tools.punch.stl" : "tools.die.stl",
                  find_clearance(placed.punch, z, placed.die, placed.die.z), height, "punch and die");
  check_clearance(placed.punch.surface ? "tools.punch.stl" : "tools.blank_holder.stl",
                  find_clearance(placed.punch, z, placed.blank_holder, placed.blank_holder.z), 0,
                  "punch and blank holder");
  return warnings;
}

}  // namespace interply::coordinator
