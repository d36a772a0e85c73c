#include "scene/files.hpp"

#include <xxhash.h>

#include <algorithm>

#include "geometry/read_file.hpp"
#include "mechanics/digest.hpp"
#include "scene/read_scene.hpp"

namespace interply::scene {
namespace {

std::string compute_digest(const std::string& content) {
  return mechanics::to_hex(XXH3_64bits(content.data(), content.size()));
}

}  // namespace

std::string resolve_file(File& file, const std::filesystem::path& folder, const std::string& path, Report& report) {
  if (report.is_broken(path)) return "";
  if (file.path.empty() || std::any_of(file.path.begin(), file.path.end(), [](unsigned char c) { return c < ' '; })) {
    report.add(path, "is empty or holds a control character; give the path of a file");
    return "";
  }
  std::filesystem::path full = file.path;
  if (full.is_relative()) full = std::filesystem::absolute(folder / full);
  file.path = full.lexically_normal().string();
  if (!file.digest.empty()) return "";
  try {
    std::string content = geometry::read_file(file.path);
    file.digest = compute_digest(content);
    return content;
  } catch (const geometry::Unreadable& error) {
    report.add(path, error.what());
    return "";
  }
}

std::string read_resolved(const File& file, const std::string& path) {
  std::string content;
  try {
    content = geometry::read_file(file.path);
  } catch (const geometry::Unreadable& error) {
    throw SceneError(path + ": " + error.what());
  }
  const std::string digest = compute_digest(content);
  if (digest != file.digest)
    throw SceneError(path + ": " + file.path + " has changed since the scene was resolved (digest " + digest +
                     " instead of " + file.digest + "); give its path alone to take it as it is now");
  return content;
}

}  // namespace interply::scene
