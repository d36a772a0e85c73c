/// A YAML document as a plain tree in which every value knows where it was written.
#pragma once

#include <string>
#include <vector>

#include "scene/report.hpp"

namespace interply::scene {

struct Value {
  enum class Kind { Null, Scalar, List, Block };
  Kind kind = Kind::Null;
  std::string scalar{};             ///< Scalar: the text
  std::vector<std::string> keys{};  ///< Block: in the order of the file, parallel to items
  std::vector<Value> items{};       ///< List, Block
  std::string origin{};             ///< "scene.yaml:12" or "--set path=value"

  /// The value of a key, or null.
  Value* find(const std::string& key);
};

/// "a single value", "a list", "a block of keys" or "empty".
std::string describe(Value::Kind kind);

/// Parses one YAML document; aliases become copies. Keys given twice go to the report.
/// @throws SceneError if the text is not YAML
Value parse_yaml(const std::string& text, const std::string& origin, Report& report);

/// The item of a list of blocks with this `name`, or with this number; null, and why in the report, if there is none.
/// @param path  of the list, then of the item
Value* find_item(Value& list, const std::string& name, const std::string& origin, std::string& path, Report& report);

/// Replaces or adds the value that "path=value" names: blocks by key, list items by index, layers also by name.
/// Keys are not checked here: one that the schema does not know is found when the tree is read.
void apply_override(Value& root, const std::string& override, Report& report);

}  // namespace interply::scene
