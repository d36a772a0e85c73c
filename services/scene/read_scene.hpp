/// Scene file -> checked plain structs. The only place that parses scenes.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace interply::scene {

/// A scene or law that cannot be used. `what()` holds one sentence per problem, one per line:
/// `scene.yaml:12: layers[2].law.woven.p_min: 1.4 is not in [0, 1]`.
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads, overrides, checks types and physics, fills in defaults.
/// @param overrides  "path=value", path with layer names or indices: layers.ply_2.law.woven.variant=biaxial
/// @param overlays   files with part of a scene each, laid over it one after the other, before the overrides; in them
///                   `layers` may be a block by name
/// @throws SceneError with every problem found
Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {},
                 const std::vector<std::filesystem::path>& overlays = {});

/// The same from text; `origin` stands for the file name in messages. A resolved scene (`Scene::text`) reads back to an
/// equal scene with the same digest.
Scene parse_scene(const std::string& text, const std::string& origin, const std::vector<std::string>& overrides = {},
                  const std::vector<std::filesystem::path>& overlays = {});

/// Reads a file that holds exactly the `law` block of a scene's layer.
/// @param overrides  "path=value", path from the law: woven.variant=biaxial   @throws SceneError
Law read_law(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The same from text; `origin` stands for the file name in messages. @throws SceneError
Law parse_law(const std::string& text, const std::string& origin, const std::vector<std::string>& overrides = {});

/// Warnings about a checked scene, one sentence each: an indefinite law, a mesh across the fibres, values that look
/// like another unit.
std::vector<std::string> find_warnings(const Scene& scene);

}  // namespace interply::scene
