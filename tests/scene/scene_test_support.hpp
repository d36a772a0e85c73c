#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "scene/read_scene.hpp"

namespace interply::scene {

/// Two layers, one of each kind, every other key at its default; line numbers are stated by the tests.
inline const std::string kSmallScene = R"(name: small
layers:
  - name: sheet
    thickness: 1.0
    density: 7.85e-9
    law: {j2: {}}
  - name: ply_1
    thickness: 1.2
    density: 6.19e-10
    law:
      woven:
        variant: full
tools:
  punch: {edge: 100, height: 50, radius: 15}
)";

/// What parse_scene says about the scene; empty if it says nothing.
inline std::string refuse(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    parse_scene(text, "scene.yaml", overrides);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

/// The small scene with one part of its text replaced.
inline std::string with(const std::string& old_part, const std::string& new_part) {
  std::string text = kSmallScene;
  const std::size_t at = text.find(old_part);
  if (at == std::string::npos) throw std::logic_error("no '" + old_part + "' in the small scene");
  return text.replace(at, old_part.size(), new_part);
}

/// What is said about the small scene with one override, without the origin.
inline std::string refuse_value(const std::string& override) {
  const std::string said = refuse(kSmallScene, {override});
  const std::string origin = "--set " + override + ": ";
  return said.starts_with(origin) ? said.substr(origin.size()) : said;
}

inline std::string read_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace interply::scene
