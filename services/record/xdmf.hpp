/// The .xdmf sidecar that lets ParaView and VTK open a record. Internal to record.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "record/file.hpp"

namespace interply::record {

/// XDMF 2 text: a temporal collection per layer, then one per interface on the deformed nodes of the layer that carries
/// it. (A temporal collection of spatial ones would give the blocks of VTK another name in every frame.) All numbers
/// stay in the HDF5 file.
/// @param record  name of the HDF5 file, relative to the sidecar
/// @param times   of the complete frames, s
std::string make_xdmf(const std::string& record, const Layout& layout, const std::vector<double>& times);

/// Replaces `path` atomically. @throws std::runtime_error
void write_xdmf(const std::filesystem::path& path, const std::string& record, const Layout& layout,
                const std::vector<double>& times);

}  // namespace interply::record
