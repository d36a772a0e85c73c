#include "scene/meshes.hpp"

#include <algorithm>
#include <mutex>
#include <stdexcept>

#include "geometry/outline.hpp"
#include "geometry/read_file.hpp"
#include "mechanics/mesh.hpp"
#include "scene/files.hpp"
#include "scene/read_scene.hpp"

namespace interply::scene {
namespace {

using Point = std::array<double, 2>;

/// Points around an opening where its flat land begins.
std::vector<Point> sample_rim(const Opening& opening) {
  constexpr int kOnArc = 24, kOnSide = 24;
  const geometry::Outline arcs = geometry::trace_opening(opening.edge, opening.offset + opening.shoulder, kOnArc);
  std::vector<Point> points;
  for (std::size_t i = 0; i < arcs.size(); ++i) {
    points.push_back(arcs[i]);
    if (i % (kOnArc + 1) != kOnArc) continue;
    const Point &from = arcs[i], &to = arcs[(i + 1) % arcs.size()];
    for (int k = 1; k < kOnSide; ++k)
      points.push_back({from[0] + (to[0] - from[0]) * k / kOnSide, from[1] + (to[1] - from[1]) * k / kOnSide});
  }
  return points;
}

bool covers(const geometry::FlatMesh& mesh, const Point& p) {
  constexpr double kOnSide = -1e-9;
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& triangle) {
    double part[3], whole = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point& a = mesh.points[static_cast<std::size_t>(triangle[k])];
      const Point& b = mesh.points[static_cast<std::size_t>(triangle[(k + 1) % 3])];
      whole += part[k] = (a[0] - p[0]) * (b[1] - p[1]) - (a[1] - p[1]) * (b[0] - p[0]);
    }
    return std::all_of(part, part + 3, [&](double area) { return area >= kOnSide * whole; });
  });
}

/// What a mesh that is too small most likely is, or `else_say`.
std::string describe_size(const geometry::FlatMesh& mesh, const std::string& else_say) {
  const double size = measure_extent(mesh);
  if (size > kSmallBlank) return else_say;
  return "it is only " + to_rounded(size) + " mm large: if it was drawn in metres, scale it by 1000";
}

void check_covers(const geometry::FlatMesh& mesh, const Scene& scene, const Opening& opening, const std::string& tool,
                  const std::string& path, Report& report) {
  if (opening.stl || report.is_broken(tool)) return;
  for (const Point& p : sample_rim(opening)) {
    if ((scene.blank.half && p[1] <= 0) || covers(mesh, p)) continue;
    return report.add(path, "the mesh does not reach around opening and shoulder of " + tool + ", at (" +
                                to_rounded(p[0]) + ", " + to_rounded(p[1]) + ") mm; " +
                                describe_size(mesh, "the openings are centred on the origin"));
  }
}

void check_mesh(const Scene& scene, const MeshFile& mesh, const geometry::Pieces& content, const std::string& path,
                Report& report) {
  try {
    const geometry::FlatMesh flat = geometry::parse_blank(content, mesh.set);
    mechanics::make_mesh(flat.points, flat.triangles, 0, scene.blank.half);
    check_covers(flat, scene, scene.tools.die, "tools.die", path, report);
    if (report.is_broken(path)) return;
    check_covers(flat, scene, scene.tools.blank_holder.opening, "tools.blank_holder", path, report);
  } catch (const geometry::Unreadable& error) {
    report.add(path, error.what());
  } catch (const std::invalid_argument& error) {
    report.add(path, mesh.file.path + ": " + error.what());
  }
}

void resolve_mesh(Scene& scene, std::optional<MeshFile>& mesh, const std::filesystem::path& folder,
                  const std::string& path, Report& report) {
  if (!mesh || report.is_broken(path)) return;
  const std::string file = join(path, "file");
  const bool is_new = mesh->file.digest.empty();
  const geometry::Pieces content = resolve_mesh_file(mesh->file, folder, file, report);
  if (is_new && !report.is_broken(file)) check_mesh(scene, *mesh, content, file, report);
}

/// Whoever asks for one layer asks for the others, and most often they have one mesh: the last one is kept.
geometry::FlatMesh parse_once(const geometry::Pieces& content, const std::string& digest, const std::string& set) {
  static std::mutex mutex;
  static std::string last_digest, last_set;
  static geometry::FlatMesh last;
  const std::lock_guard lock(mutex);
  if (last.triangles.empty() || digest != last_digest || set != last_set) {
    last = geometry::parse_blank(content, set);
    last_digest = digest;
    last_set = set;
  }
  return last;
}

}  // namespace

double measure_extent(const geometry::FlatMesh& mesh) {
  double extent = 0;
  for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
    const auto [low, high] = std::minmax_element(mesh.points.begin(), mesh.points.end(),
                                                 [&](const Point& a, const Point& b) { return a[axis] < b[axis]; });
    if (low != high) extent = std::max(extent, (*high)[axis] - (*low)[axis]);
  }
  return extent;
}

void resolve_meshes(Scene& scene, const std::filesystem::path& folder, Report& report) {
  resolve_mesh(scene, scene.blank.mesh, folder, "blank.mesh", report);
  for (std::size_t i = 0; i < scene.layers.size(); ++i)
    resolve_mesh(scene, scene.layers[i].mesh, folder, join(join("layers", i), "mesh"), report);
}

std::optional<geometry::FlatMesh> read_mesh_of(const Scene& scene, std::size_t layer) {
  const bool own = scene.layers[layer].mesh.has_value();
  const std::optional<MeshFile>& mesh = own ? scene.layers[layer].mesh : scene.blank.mesh;
  if (!mesh) return std::nullopt;
  const std::string path = (own ? join("layers", layer) + "." : "blank.") + "mesh.file";
  const geometry::Pieces content = read_resolved_mesh(mesh->file, path);
  try {
    return parse_once(content, mesh->file.digest, mesh->set);
  } catch (const geometry::Unreadable& error) {
    throw SceneError(path + ": " + error.what());
  }
}

}  // namespace interply::scene
