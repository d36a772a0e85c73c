#include <algorithm>
#include <cctype>
#include <charconv>

#include "scene/read_scene.hpp"
#include "scene/value.hpp"

namespace interply::scene {
namespace {

/// One part of a path: a key or name, or the number of a list item.
struct PathPart {
  std::string key;
  bool is_index = false;
};

/// "layers[2].law" -> layers, [2], law. Empty if the path is malformed.
std::vector<PathPart> split_path(const std::string& path) {
  std::vector<PathPart> parts;
  std::size_t at = 0;
  while (at < path.size()) {
    if (path[at] == '[') {
      const std::size_t close = path.find(']', at);
      if (close == std::string::npos || parts.empty()) return {};
      parts.push_back({path.substr(at + 1, close - at - 1), true});
      at = close + 1;
    } else {
      if (!parts.empty() && path[at++] != '.') return {};
      const std::size_t end = std::min(path.find_first_of(".[", at), path.size());
      if (end == at) return {};
      parts.push_back({path.substr(at, end - at), false});
      at = end;
    }
  }
  return parts;
}

void set_origin(Value& value, const std::string& origin) {
  value.origin = origin;
  for (Value& item : value.items) set_origin(item, origin);
}

/// Goes down one block by key, which is added if it is new.
Value* step_into_block(Value& block, const PathPart& part, const std::string& origin, std::string& path,
                       Report& report) {
  if (part.is_index || block.kind == Value::Kind::Scalar) {
    report.add_at(origin, path, "is " + describe(block.kind) + ", so it has no part '" + part.key + "'; set all of it");
    return nullptr;
  }
  block.kind = Value::Kind::Block;
  path = join(path, part.key);
  if (Value* found = block.find(part.key)) return found;
  block.keys.push_back(part.key);
  return &block.items.emplace_back(Value{.origin = origin});
}

}  // namespace

Value* find_item(Value& list, const std::string& name, const std::string& origin, std::string& path, Report& report) {
  std::size_t index = list.items.size();
  const bool digits =
      !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c); });
  if (digits) {
    std::from_chars(name.data(), name.data() + name.size(), index);
  } else {
    std::vector<std::string> names;
    for (Value& item : list.items) {
      const Value* given = item.find("name");
      names.push_back(given ? given->scalar : "");
    }
    index = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    if (index == names.size()) {
      report.add_at(origin, path, "holds no item named '" + name + "'" + suggest(name, names));
      return nullptr;
    }
  }
  if (index >= list.items.size()) {
    report.add_at(origin, path, "has " + std::to_string(list.items.size()) + " items, so no item " + name);
    return nullptr;
  }
  path = join(path, index);
  return &list.items[index];
}

void apply_override(Value& root, const std::string& override, Report& report) {
  const std::string origin = "--set " + override;
  const std::size_t equals = override.find('=');
  const std::vector<PathPart> parts =
      equals == std::string::npos ? std::vector<PathPart>{} : split_path(override.substr(0, equals));
  if (parts.empty()) return report.add_at(origin, "", "is not of the form path=value, such as blank.mesh_size=10");

  Value value;
  try {
    value = parse_yaml(override.substr(equals + 1), origin, report);
  } catch (const SceneError& error) {
    return report.add_sentence(error.what());
  }
  set_origin(value, origin);
  std::string path;
  Value* target = &root;
  for (const PathPart& part : parts) {
    target = target->kind == Value::Kind::List ? find_item(*target, part.key, origin, path, report)
                                               : step_into_block(*target, part, origin, path, report);
    if (!target) return;
  }
  *target = std::move(value);
}

}  // namespace interply::scene
