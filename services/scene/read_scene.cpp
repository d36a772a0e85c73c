#include "scene/read_scene.hpp"

#include <xxhash.h>

#include <fstream>
#include <iterator>

#include "scene/check.hpp"
#include "scene/convert.hpp"
#include "scene/schema.hpp"
#include "scene/value.hpp"

namespace interply::scene {
namespace {

std::string read_text(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) throw SceneError(file.string() + ": is a folder, not a file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw SceneError(file.string() + ": cannot be opened");
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

Scene parse_scene(const std::string& text, const std::string& origin, const std::vector<std::string>& overrides) {
  Report report;
  Value root = parse_yaml(text, origin, report);
  for (const std::string& override : overrides) apply_override(root, override, report);

  schema::Scene message;
  read_message(root, "", message, report);
  Scene scene = to_scene(message);
  check_scene(scene, report);
  report.throw_if_any();

  scene.text = write_message(to_message(scene));
  scene.digest = XXH3_64bits(scene.text.data(), scene.text.size());
  return scene;
}

Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  return parse_scene(read_text(file), file.string(), overrides);
}

Law read_law(const std::filesystem::path& file) {
  Report report;
  const Value root = parse_yaml(read_text(file), file.string(), report);
  const bool wrapped = root.keys.size() == 1 && root.keys[0] == "law";

  schema::Law message;
  read_message(wrapped ? root.items[0] : root, wrapped ? "law" : "", message, report);
  const Law law = to_law(message);
  check_law(law, wrapped ? "law" : "", report);
  report.throw_if_any();
  return law;
}

}  // namespace interply::scene
