#include "scene/files.hpp"

#include <xxhash.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "geometry/blank_mesh.hpp"
#include "geometry/read_file.hpp"
#include "mechanics/digest.hpp"
#include "scene/read_scene.hpp"

namespace interply::scene {
namespace {

std::string compute_digest(const std::string& content) {
  return mechanics::to_hex(XXH3_64bits(content.data(), content.size()));
}

/// Of a file without others that of its content.
std::string compute_digest(const geometry::Pieces& pieces) {
  if (pieces.size() == 1) return compute_digest(pieces.front().text);
  std::string all;
  for (const geometry::Piece& piece : pieces) all += piece.text;
  return compute_digest(all);
}

/// @param read  the content of a file by its path
template <class Read>
auto resolve(File& file, const std::filesystem::path& folder, const std::string& path, Report& report, Read read)
    -> decltype(read(path)) {
  if (report.is_broken(path)) return {};
  if (file.path.empty() || std::any_of(file.path.begin(), file.path.end(), [](unsigned char c) { return c < ' '; })) {
    report.add(path, "is empty or holds a control character; give the path of a file");
    return {};
  }
  file.path = to_absolute(file.path, folder);
  if (!file.digest.empty()) return {};
  try {
    auto content = read(file.path);
    file.digest = compute_digest(content);
    return content;
  } catch (const geometry::Unreadable& error) {
    report.add(path, error.what());
    return {};
  }
}

template <class Read>
auto read_unchanged(const File& file, const std::string& path, Read read) -> decltype(read(path)) {
  decltype(read(path)) content;
  try {
    content = read(file.path);
  } catch (const geometry::Unreadable& error) {
    throw SceneError(path + ": " + error.what());
  }
  const std::string digest = compute_digest(content);
  if (digest != file.digest)
    throw SceneError(path + ": " + file.path + " has changed since the scene was resolved (digest " + digest +
                     " instead of " + file.digest + "); give its path alone to take it as it is now");
  return content;
}

}  // namespace

std::string read_text(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) throw SceneError(file.string() + ": is a folder, not a file");
  if (!std::filesystem::exists(file) || std::filesystem::is_regular_file(file)) {
    try {
      return geometry::read_file(file.string());
    } catch (const geometry::Unreadable& error) {
      throw SceneError(error.what());
    }
  }
  std::ifstream stream(file, std::ios::binary);  // a pipe, such as <(...)
  if (!stream) throw SceneError(file.string() + ": cannot be opened");
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string to_absolute(const std::filesystem::path& path, const std::filesystem::path& folder) {
  return std::filesystem::absolute(folder / path).lexically_normal().string();
}

std::string resolve_file(File& file, const std::filesystem::path& folder, const std::string& path, Report& report) {
  return resolve(file, folder, path, report, geometry::read_file);
}

geometry::Pieces resolve_mesh_file(File& file, const std::filesystem::path& folder, const std::string& path,
                                   Report& report) {
  return resolve(file, folder, path, report, geometry::read_mesh_file);
}

std::string read_resolved(const File& file, const std::string& path) {
  return read_unchanged(file, path, geometry::read_file);
}

geometry::Pieces read_resolved_mesh(const File& file, const std::string& path) {
  return read_unchanged(file, path, geometry::read_mesh_file);
}

}  // namespace interply::scene
