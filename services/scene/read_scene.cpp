#include "scene/read_scene.hpp"

#include <xxhash.h>

#include <algorithm>

#include "geometry/stl.hpp"
#include "scene/check.hpp"
#include "scene/compose.hpp"
#include "scene/convert.hpp"
#include "scene/files.hpp"
#include "scene/meshes.hpp"
#include "scene/schema.hpp"
#include "scene/value.hpp"

namespace interply::scene {
namespace {

void resolve_law(Law& law, const std::filesystem::path& folder, const std::string& path, Report& report) {
  if (auto* own = std::get_if<VumatLaw>(&law))
    resolve_file(own->library, folder, join(path, std::string("vumat.library")), report);
}

/// Absolute paths and digests; what has not been read before must be usable.
void resolve_files(Scene& scene, const std::filesystem::path& folder, Report& report) {
  const auto resolve_stl = [&](std::optional<File>& stl, const std::string& path) {
    if (!stl) return;
    const std::string content = resolve_file(*stl, folder, path, report);
    if (content.empty() || report.is_broken(path)) return;
    try {
      geometry::parse_stl(content, stl->path);
    } catch (const geometry::Unreadable& error) {
      report.add(path, error.what());
    }
  };
  if (scene.tools.punch) resolve_stl(scene.tools.punch->stl, "tools.punch.stl");
  resolve_stl(scene.tools.die.stl, "tools.die.stl");
  resolve_stl(scene.tools.blank_holder.opening.stl, "tools.blank_holder.stl");
  resolve_meshes(scene, folder, report);
  for (std::size_t i = 0; i < scene.layers.size(); ++i)
    resolve_law(scene.layers[i].law, folder, join(join("layers", i), "law"), report);
}

}  // namespace

Scene parse_scene(const std::string& text, const std::string& origin, const std::vector<std::string>& overrides,
                  const std::vector<std::filesystem::path>& overlays) {
  Report report;
  const std::filesystem::path folder = std::filesystem::path(origin).parent_path();
  Value root = parse_yaml(text, origin, report);
  drop_anchors(root);
  include_laws(root, folder, report);
  for (const std::filesystem::path& overlay : overlays) {
    lay_over(root, parse_part(overlay, *schema::Scene::descriptor(), report), *schema::Scene::descriptor(), "", report);
    include_laws(root, folder, report);
  }
  for (const std::string& override : overrides) {
    apply_override(root, override, report);
    include_laws(root, folder, report);
  }

  schema::Scene message;
  read_message(root, "", message, report);
  Scene scene = to_scene(message);
  resolve_files(scene, folder, report);
  check_scene(scene, report);
  report.throw_if_any();

  scene.text = write_message(to_message(scene));
  scene.digest = XXH3_64bits(scene.text.data(), scene.text.size());
  return scene;
}

Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                 const std::vector<std::filesystem::path>& overlays) {
  return parse_scene(read_text(file), file.string(), overrides, overlays);
}

Law read_law(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  return parse_law(read_text(file), file.string(), overrides);
}

Law parse_law(const std::string& text, const std::string& origin, const std::vector<std::string>& overrides) {
  Report report;
  const std::filesystem::path folder = std::filesystem::path(origin).parent_path();
  Value root = parse_yaml(text, origin, report);
  drop_anchors(root);
  if (std::find(root.keys.begin(), root.keys.end(), "layers") != root.keys.end())
    throw SceneError(origin + ": is a scene; a law file holds the `law` block of one layer, such as  j2: {}");
  const bool wrapped = root.keys.size() == 1 && root.keys[0] == "law";
  Value& block = wrapped ? root.items[0] : root;
  const std::string path = wrapped ? "law" : "";

  include_law(block, folder, path, report);
  for (const std::string& override : overrides) {
    apply_override(block, override, report);
    include_law(block, folder, path, report);
  }

  schema::Law message;
  read_message(block, path, message, report);
  Law law = to_law(message);
  resolve_law(law, folder, path, report);
  check_law(law, path, report);
  report.throw_if_any();
  return law;
}

}  // namespace interply::scene
