#include "coordinator/tool_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <numeric>

#include "scene/read_scene.hpp"
#include "solve/layer_mechanics.hpp"

namespace interply::coordinator {
namespace {

using geometry::Surface;
using mechanics::at;
using mechanics::TriangleMesh;
using mechanics::Vector2;
using mechanics::Vector3;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Points of the surface at most about 2 mm apart along its sides, in world coordinates with the tool at height z.
/// @param visit_triangle  takes a corner of each triangle and how far its other points are at most; false: none of them
template <class VisitTriangle, class Visit>
void sample(const Surface& s, double z, const VisitTriangle& visit_triangle, const Visit& visit) {
  constexpr double kSpacing = 2;
  for (Eigen::Index t = 0; t < s.triangles.cols(); ++t) {
    const auto x = [&](int k) -> Vector3 { return at(s.vertices, s.triangles(k % 3, t)) + Vector3(0, 0, z); };
    int first = 0;  // of the shortest side, so that a needle gets few
    for (int k = 1; k < 3; ++k)
      if ((x(k + 1) - x(k)).norm() < (x(first + 1) - x(first)).norm()) first = k;
    const Vector3 x0 = x(first), a = x(first + 1) - x0, b = x(first + 2) - x0;
    if (!visit_triangle(x0, std::max(a.norm(), b.norm()))) continue;
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
    const auto distance = [&](const Vector3& x) { return tool.shape->evaluate(x - Vector3(0, 0, z_tool)).value; };
    const auto may_be_nearer = [&](const Vector3& x, double reach) { return distance(x) - reach < least.value; };
    const auto consider = [&](const Vector3& x) {
      if (const double d = distance(x); d < least.value) least = {d, x};
    };
    const auto& vertices = sampled.surface->vertices;  // first: few of the triangles between them can be nearer
    for (Eigen::Index i = 0; i < vertices.cols(); ++i) consider(at(vertices, i) + Vector3(0, 0, z_sampled));
    sample(*sampled.surface, z_sampled, may_be_nearer, consider);
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
  constexpr Eigen::Index kMost = 20000;  // nodes to look at: the tool lies behind all of them, or it was placed well
  if (!tool.surface) return;
  for (Eigen::Index i = 0; i < blank.n_nodes(); i += blank.n_nodes() / kMost + 1) {
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
  constexpr double kTouching = 1e-3;   // mm; an STL holds seven digits
  Rectangle shadow = reach.rectangle;  // of the tool: no node beside it is met
  if (tool.surface) {
    const auto& v = tool.surface->vertices;
    shadow =
        Rectangle(v.topRows<2>().rowwise().minCoeff() - kTouching, v.topRows<2>().rowwise().maxCoeff() + kTouching);
  }
  for (Eigen::Index i = 0; i < layer.n_nodes(); ++i) {
    if (!shadow.contains(Vector2(layer.reference(0, i), layer.reference(1, i)))) continue;
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
  const std::string cure =
      is_edge ? fmt::format("round it to {:.3g} mm or more", h) : fmt::format("a mesh of {:.3g} mm would do", radius);
  warnings.push_back(
      fmt::format("{}: {}{} is finer than the {:.3g} mm mesh of {}: contact is at nodes, and what lies "
                  "between them is not seen; {}",
                  key, is_edge ? "a sharp edge" : fmt::format("a radius of {:.3g} mm", radius), where, h, layer, cure));
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
/// @return its smallest radius, mm
double warn_of_fineness(const scene::Scene& scene, const std::string& tool_key, const PlacedTool& tool, double radius,
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
    warnings.push_back(
        fmt::format("{}: can touch no node of {} on its way of {:g} mm: contact is at nodes, and it "
                    "passes between them or beside the blank ({:.3g} mm mesh); {}",
                    key, name, travel, h, cure));
    return radius;
  }
  if (!tool.surface) {
    warn_of_radius(key, radius, h, name, "", warnings);
    return radius;
  }
  const bool is_half = scene.blank.half && tool.surface->vertices.row(1).minCoeff() > -1;
  const Rounding sharpest = find_sharpest(tool, reach, h, is_half);
  const Vector3& x = sharpest.place;
  warn_of_radius(key, sharpest.radius, h, name, fmt::format(" at ({:.4g}, {:.4g}, {:.4g})", x.x(), x.y(), x.z()),
                 warnings);
  return sharpest.radius;
}

void warn_of_motion(const scene::Scene& scene, std::vector<std::string>& warnings) {
  if (!scene.tools.punch && scene.motion.stroke > 0)
    warnings.push_back(
        fmt::format("tools.punch: is missing: motion.stroke = {:g} mm moves nothing, the stack is only squeezed; give "
                    "tools.punch, or motion.stroke: 0",
                    scene.motion.stroke));
  if (scene.tools.punch && scene.motion.stroke == 0)
    warnings.emplace_back("motion.stroke: is 0: the punch stays where it touches the flat stack");
}

/// Without the radius. @param face  height of the stack's face that the tool touches, mm
ToolFacts describe(const std::string& key, const PlacedTool& tool, double face, const scene::Scene& scene) {
  const std::string name = key.substr(key.find('.') + 1);
  ToolFacts facts{.name = name, .shape = "", .touching = face};
  if (tool.surface) {
    const std::string& path = (name == "punch" ? scene.tools.punch->stl
                               : name == "die" ? scene.tools.die.stl
                                               : scene.tools.blank_holder.opening.stl)
                                  ->path;
    const auto& v = tool.surface->vertices;
    facts.shape = fmt::format("{}, {} triangles", std::filesystem::path(path).filename().string(),
                              tool.surface->triangles.cols());
    for (int k = 0; k < 3; ++k) facts.size[k] = v.row(k).maxCoeff() - v.row(k).minCoeff();
    facts.moved = tool.z;
    return facts;
  }
  const auto set_size = [&](double edge, double offset, double height) {  // of the triangle with a corner on +x
    facts.size[0] = edge * std::numbers::sqrt3 / 2 + 2 * offset;
    facts.size[1] = edge + 2 * offset;
    facts.size[2] = height;
  };
  if (name == "punch") {
    const scene::Punch& p = *scene.tools.punch;
    facts.shape = fmt::format("pyramid, edge {:g}, height {:g}, ball {:g} mm", p.edge, p.height, p.radius);
    set_size(p.edge, p.radius, p.height + p.radius);
  } else {
    const scene::Opening& o = name == "die" ? scene.tools.die : scene.tools.blank_holder.opening;
    facts.shape = fmt::format("plate, opening edge {:g}, offset {:g}, shoulder {:g} mm", o.edge, o.offset, o.shoulder);
    set_size(o.edge, o.offset + o.shoulder, 0);
  }
  return facts;
}

}  // namespace

ToolCheck check_tools(const scene::Scene& scene) {
  ToolCheck found;
  std::vector<std::string>& warnings = found.warnings;
  warn_of_motion(scene, warnings);
  const scene::Tools& t = scene.tools;
  double height = 0;
  for (const scene::Layer& layer : scene.layers) height += layer.thickness;
  const TriangleMesh lowest = solve::make_layer_mesh(scene, 0);
  const TriangleMesh uppermost = solve::make_layer_mesh(scene, static_cast<int>(scene.layers.size()) - 1);
  const PlacedTools placed = place_tools(scene, lowest, uppermost, height);
  const std::string &first = scene.layers.front().name, &last = scene.layers.back().name;
  const double stroke = scene.motion.stroke;
  found.flange_area = placed.flange_area;
  found.blank_area = mechanics::compute_areas(uppermost).sum();
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
    const Reach reach{bound_blank(blank, scene.blank.half), face, facing, depth};
    if (tool.surface) {
      const std::string stl = std::string(key) + ".stl";
      check_in_front(stl, tool, blank, face);
      if (scene.blank.half) warn_of_asymmetry(stl, tool, 0.01 * height, warnings);
      warn_of_holes(stl, tool, reach, warnings);
      if (tool.surface->bytes_after > 0)
        warnings.push_back(fmt::format("{}: holds {} bytes after its last triangle, which are not read", stl,
                                       tool.surface->bytes_after));
    }
    ToolFacts facts = describe(key, tool, face, scene);
    facts.radius = warn_of_fineness(scene, key, tool, radius, blank, layer, reach, travel, warnings);
    found.tools.push_back(facts);
  }
  if (!t.die.stl && !t.blank_holder.opening.stl && !(t.punch && t.punch->stl)) return found;
  if (!placed.punch.shape) return found;
  const double z = placed.punch.z - stroke;
  check_clearance(placed.punch.surface ? "tools.punch.stl" : "tools.die.stl",
                  find_clearance(placed.punch, z, placed.die, placed.die.z), height, "punch and die");
  check_clearance(placed.punch.surface ? "tools.punch.stl" : "tools.blank_holder.stl",
                  find_clearance(placed.punch, z, placed.blank_holder, placed.blank_holder.z), 0,
                  "punch and blank holder");
  return found;
}

}  // namespace interply::coordinator
