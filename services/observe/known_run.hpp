/// What a watcher knows of its run, and by that which samples can be the run's. Internal to observe.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "observe/frames.hpp"

namespace interply::observe {

/// A participant of the DDS domain; all zero if it is not known any more.
using Sender = std::array<std::uint8_t, 16>;

/// Anyone who reaches the network can publish into a run's partition. So the first header counts: only who sent it
/// sends tools, interfaces, history and end; only who sent a layer's mesh sends its frames; everything has the sizes
/// that header and meshes say. What is kept for a run follows from these two, never from a later sample.
class KnownRun {
 public:
  explicit KnownRun(std::string run) : run_(std::move(run)) {}

  bool has_header() const { return !header_.layers.empty(); }
  bool has_meshes() const { return has_header() && meshes_.size() == header_.layers.size(); }

  /// Takes a sample in. `run` is its stamp. Meshes wait for the header, frames for all meshes.
  /// @throws std::runtime_error saying why it cannot be of this run; nothing is taken in
  void admit(const RunHeader& a, const std::string& run, const Sender& sender);
  void admit(const LayerMesh& a, const std::string& run, const Sender& sender);
  void admit(const LayerFrame& a, const std::string& run, const Sender& sender) const;
  void admit(const InterfaceFrame& a, const std::string& run, const Sender& sender) const;
  void admit(const ToolFrame& a, const std::string& run, const Sender& sender) const;
  void admit(const HistoryRow& a, const std::string& run, const Sender& sender) const;
  void admit(const RunEnd& a, const std::string& run, const Sender& sender) const;

 private:
  struct Mesh {
    Sender sender{};
    Eigen::Index nodes = 0, elements = 0;
  };
  void check_run(const std::string& run) const;
  void check_coordinator(const std::string& run, const Sender& sender) const;
  void check_frame(int frame) const;
  const Mesh& find_mesh(const std::string& layer) const;
  void check_fields(const std::vector<Field>& fields, const Mesh& mesh) const;

  std::string run_;
  RunHeader header_;  ///< without the text of the scene
  Sender coordinator_{};
  std::map<std::string, Mesh> meshes_;
};

}  // namespace interply::observe
