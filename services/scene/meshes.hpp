/// Meshes that a scene takes from files: the blank's, and those of single layers.
#pragma once

#include <filesystem>
#include <optional>

#include "geometry/blank_mesh.hpp"
#include "scene/report.hpp"
#include "scene/scene.hpp"

namespace interply::scene {

constexpr double kSmallBlank = 10;  ///< mm; a smaller mesh was most likely drawn in metres

/// Larger side of the bounding rectangle, mm.
double measure_extent(const geometry::FlatMesh& mesh);

/// Resolves every mesh file (scene/files.hpp) and checks those whose content is new: readable, a half where the model
/// is half, and covering the openings of the analytic tools.
void resolve_meshes(Scene& scene, const std::filesystem::path& folder, Report& report);

/// The mesh of a layer from its own file or the blank's; nothing if it is generated.
/// @pre a checked scene
/// @throws SceneError  the file is gone or has changed since the scene was resolved
std::optional<geometry::FlatMesh> read_mesh_of(const Scene& scene, std::size_t layer);

}  // namespace interply::scene
