/// What is wrong with a scene, and where it was written.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace interply::scene {

/// Collects every problem of one scene as `origin: path: sentence`. The origin is `scene.yaml:12` or `--set
/// path=value`; for a value that was not written (a default) it is that of the nearest enclosing block, and for one
/// that an override changed in part it is the override.
class Report {
 public:
  /// Remembers that the value at `path` was written at `origin`.
  void locate(const std::string& path, const std::string& origin) { origins_[path] = origin; }
  bool is_given(const std::string& path) const { return origins_.contains(path); }

  void add(const std::string& path, const std::string& sentence) { add_at(find_origin(path), path, sentence); }
  void add_at(const std::string& origin, const std::string& path, const std::string& sentence);

  /// Adds a problem that has no place in the scene.
  void add_sentence(const std::string& sentence) { sentences_.push_back(sentence); }

  /// True if a problem was found at `path`, inside or around it: a check of the values there would say nothing
  /// sensible.
  bool is_broken(const std::string& path) const;

  /// @throws SceneError with one sentence per line, if there is any
  void throw_if_any() const;

 private:
  std::string find_origin(std::string path) const;

  std::map<std::string, std::string> origins_;
  std::set<std::string> broken_;
  std::vector<std::string> sentences_;
};

/// "path.key", or "key" at the top.
std::string join(const std::string& path, const std::string& key);

/// "path[index]".
std::string join(const std::string& path, std::size_t index);

/// "; did you mean 'thickness'?" if one of the names is near to `word`, else "; known: a, b, c".
std::string suggest(const std::string& word, const std::vector<std::string>& names);

/// "a, b, c".
std::string enumerate(const std::vector<std::string>& names);

/// Shortest text that reads back to the same double.
std::string to_text(double value);

/// To six significant digits, for results of arithmetic in a sentence.
std::string to_rounded(double value);

}  // namespace interply::scene
