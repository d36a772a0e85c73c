/// Files of a scene: its own text and parts, meshes of blanks, surfaces of tools.
#pragma once

#include <filesystem>
#include <string>

#include "geometry/text_lines.hpp"
#include "scene/report.hpp"
#include "scene/scene.hpp"

namespace interply::scene {

/// The text of a scene, law or overlay. @throws SceneError if there is none
std::string read_text(const std::filesystem::path& file);

/// A relative path starts at `folder`.
std::string to_absolute(const std::filesystem::path& path, const std::filesystem::path& folder);

/// Makes the path absolute (a relative one starts at `folder`, that of the scene) and fills in the digest. A file with
/// a digest belongs to a resolved scene: its content is not looked at here, so that a participant which does not need
/// it need not have it.
/// @return the content if it was read, else empty; a file that cannot be read goes to the report
std::string resolve_file(File& file, const std::filesystem::path& folder, const std::string& path, Report& report);

/// The same for a mesh, whose digest is that of all that it includes.
geometry::Pieces resolve_mesh_file(File& file, const std::filesystem::path& folder, const std::string& path,
                                   Report& report);

/// Content of a resolved file. @param path  of the key, for messages, "tools.punch.stl"
/// @throws SceneError if it cannot be read, or has changed since the scene was resolved
std::string read_resolved(const File& file, const std::string& path);
geometry::Pieces read_resolved_mesh(const File& file, const std::string& path);

}  // namespace interply::scene
