/// A scene that is written in several files: laws by their path, overlays. Works on trees, before they are read.
#pragma once

#include <google/protobuf/descriptor.h>

#include <filesystem>
#include <string>

#include "scene/report.hpp"
#include "scene/value.hpp"

namespace interply::scene {

/// Parses a file that goes into a scene: without keys `x-...` at its top, which are there for anchors, and with paths
/// of files made absolute from its own folder. @param type  of its content. @throws SceneError
Value parse_part(const std::filesystem::path& file, const google::protobuf::Descriptor& type, Report& report);

/// Removes keys `x-...`.
void drop_anchors(Value& root);

/// Puts what it holds in place of every `law: {file: PATH}` of a scene's layers. @param folder  that PATH starts at
void include_laws(Value& root, const std::filesystem::path& folder, Report& report);

/// The same for one `law` block, at `path` of the scene.
void include_law(Value& law, const std::filesystem::path& folder, const std::string& path, Report& report);

/// Lays one tree over another: blocks key by key, everything else replaces. The alternatives of a block (of laws, of
/// hardening) replace one another; layers may be given as a block by their names.
/// @param type  of both
void lay_over(Value& base, Value over, const google::protobuf::Descriptor& type, const std::string& path,
              Report& report);

}  // namespace interply::scene
