#include "scene/report.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>

#include "process/nearest.hpp"
#include "process/words.hpp"
#include "scene/read_scene.hpp"

namespace interply::scene {
namespace {

/// True for `path` itself and for everything in it.
bool is_inside(const std::string& inner, const std::string& path) {
  if (!inner.starts_with(path)) return false;
  return path.empty() || inner.size() == path.size() || inner[path.size()] == '.' || inner[path.size()] == '[';
}

}  // namespace

void Report::add_at(const std::string& origin, const std::string& path, const std::string& sentence) {
  broken_.insert(path);
  sentences_.push_back(origin + ": " + (path.empty() ? "" : path + ": ") + sentence);
}

bool Report::is_broken(const std::string& path) const {
  return std::any_of(broken_.begin(), broken_.end(),
                     [&](const std::string& other) { return is_inside(other, path) || is_inside(path, other); });
}

void Report::throw_if_any() const {
  if (sentences_.empty()) return;
  std::string text;
  for (const std::string& sentence : sentences_) {
    if (!text.empty()) text += '\n';
    text += process::to_line(sentence);
  }
  throw SceneError(text);
}

std::string Report::find_origin(std::string path) const {
  // A value that an override changed in part is the override's.
  for (const auto& [inner, origin] : origins_)
    if (is_inside(inner, path) && origin.starts_with("--set ")) return origin;
  while (!origins_.contains(path)) {
    if (path.empty()) return "scene";
    const std::size_t cut = path.find_last_of(".[");
    path.resize(cut == std::string::npos ? 0 : cut);
  }
  return origins_.at(path);
}

std::string join(const std::string& path, const std::string& key) { return path.empty() ? key : path + "." + key; }

std::string join(const std::string& path, std::size_t index) { return path + "[" + std::to_string(index) + "]"; }

std::string suggest(const std::string& word, const std::vector<std::string>& names) {
  if (names.empty()) return "";
  const std::string nearest = process::find_nearest(word, names);
  return nearest.empty() ? "; known: " + enumerate(names) : "; did you mean '" + nearest + "'?";
}

std::string enumerate(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string to_text(double value) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

std::string to_rounded(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

}  // namespace interply::scene
