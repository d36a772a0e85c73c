/// The .xdmf sidecar that lets ParaView and VTK open a record. Internal to record.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "record/layout.hpp"

namespace interply::record {

/// XDMF 2 text: a temporal collection per layer, then one per interface on the deformed nodes of the layer that carries
/// it, then one per tool. (A temporal collection of spatial ones would give the blocks of VTK another name in every frame.) All numbers
/// stay in the HDF5 file.
///
/// The file has its full size from the start, a place for every frame in every collection, so that a frame costs the
/// same however many there are, and a disk that is too small is found early. A place is a comment until its frame is
/// shown; what is under way is inside that comment: the sidecar is well-formed at any instant.
class Sidecar {
 public:
  /// Bytes of the file. @param record, layout  as below
  static std::uint64_t measure(const std::string& record, const Layout& layout);

  /// Makes the file at `path`, without frames. @throws std::runtime_error
  /// @param record  name of the HDF5 file, relative to the sidecar
  Sidecar(const std::filesystem::path& path, const std::string& record, const Layout& layout);
  ~Sidecar();
  Sidecar(const Sidecar&) = delete;
  Sidecar& operator=(const Sidecar&) = delete;

  /// @param time  of the frame, s   @param tool_positions  of each tool, mm   @throws std::runtime_error
  void show(int frame, double time, const std::map<std::string, double>& tool_positions);

 private:
  /// Where the places of a collection are.
  struct Places {
    std::size_t begin = 0, size = 0;  ///< of the first; of each, bytes
  };
  void write(const std::string& text, std::size_t offset) const;

  const std::filesystem::path path_;
  const std::string record_;
  const Layout& layout_;
  std::vector<Places> places_;  ///< of each collection
  int file_ = -1;
};

}  // namespace interply::record
