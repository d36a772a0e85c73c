/// Reads a finished, running or broken-off record (proto/RECORD.md).
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mechanics/nodal.hpp"

namespace interply::record {

/// Numbers of one dataset or of a part of it, last dimension innermost.
struct Numbers {
  std::vector<std::size_t> shape;
  std::vector<double> values;
  std::string unit, description;
};

/// Layers, interfaces and fields are named as in the scene. All calls throw std::runtime_error that names what is
/// missing.
class RecordReader {
 public:
  explicit RecordReader(const std::filesystem::path& file);
  ~RecordReader();

  int frames_complete() const;
  int rows_complete() const;
  /// Times of the complete frames, s.
  std::vector<double> times() const;
  std::vector<std::string> layers() const;
  std::vector<std::string> interfaces() const;
  /// A text dataset: "status", "message", "digest", "scene/text", "layers/ply_1/kind", ...
  std::string read_text(const std::string& path) const;
  /// A whole numeric dataset.
  Numbers read(const std::string& path) const;

  /// Positions of a layer. [3 x n_nodes] mm
  mechanics::NodalVectors read_position(const std::string& layer, int frame) const;
  mechanics::Triangles read_triangles(const std::string& layer) const;
  /// Field of a layer in one complete frame. [points] or [points, components]
  Numbers read_layer_field(const std::string& layer, const std::string& field, int frame) const;
  /// Field of an interface in one complete frame. [nodes] or [nodes, components]
  Numbers read_interface_field(const std::string& interface, const std::string& field, int frame) const;
  /// Column of /history. [rows_complete] or [rows_complete, layers or interfaces]
  Numbers read_history(const std::string& column) const;

 private:
  Numbers read_frame(const std::string& path, int frame) const;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace interply::record
