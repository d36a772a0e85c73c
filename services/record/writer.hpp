/// Writes a run to disk while it happens: one HDF5 file and its .xdmf sidecar (proto/RECORD.md).
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "observe/frames.hpp"

namespace interply::record {

/// Takes what a run publishes, in any order between participants, and keeps a record that is valid at any instant.
///
/// The file appears once the header, all meshes and frame 0 of every layer, interface and tool are there; until then
/// everything is kept in memory. Frame k is complete when every layer, interface and tool has delivered it;
/// frames_complete counts frames 0, 1, ... without a gap. What does not fit (a stranger's layer, another shape, a frame
/// or history row beyond what the header announced) is left out with one log line.
/// Safe to call from several threads. put() throws std::runtime_error if the disk fails.
class RecordWriter : public observe::Sink {
 public:
  /// @param file       e.g. run/record.h5; folders are made; the sidecar is run/record.xdmf
  /// @param overwrite  remove an existing record first
  /// @throws std::runtime_error if there is a record already and `overwrite` is false
  explicit RecordWriter(const std::filesystem::path& file, bool overwrite = false);
  /// close(), errors go to the log.
  ~RecordWriter() override;

  void put(const observe::RunHeader&) override;
  void put(const observe::LayerMesh&) override;
  void put(const observe::LayerFrame&) override;
  void put(const observe::InterfaceFrame&) override;
  void put(const observe::ToolFrame&) override;
  void put(const observe::HistoryRow&) override;
  void put(const observe::RunEnd&) override;
  /// Always true: everything put so far has been handed to the operating system.
  bool flush(double seconds) override;

  bool has_header() const;
  bool has_end() const;
  /// RunEnd has arrived, and every frame that it counts.
  bool is_complete() const;
  int frames_complete() const;
  /// Which participant's data are missing, one sentence; empty if nothing is.
  std::string describe_missing() const;

  /// Writes status, message and digest of RunEnd ("interrupted" if there was none), and closes. If frame 0 never became
  /// complete the file is made now from what is known; without a header nothing is written.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace interply::record
