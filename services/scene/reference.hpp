/// The keys of a scene file, for a person: made from proto/scene.proto and the defaults of scene.hpp.
#pragma once

#include <string>

namespace interply::scene {

/// The part of a scene below `path` ("" for all of it, "layers.law.woven" or "layers[0].law.woven"; layers have no
/// names here) as YAML: each key with its default, and behind it unit, range and meaning.
/// @throws SceneError naming the nearest key if there is no such part
std::string describe_keys(const std::string& path);

}  // namespace interply::scene
