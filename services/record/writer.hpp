/// Writes a run to disk while it happens: one HDF5 file and its .xdmf sidecar (proto/RECORD.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "observe/frames.hpp"

namespace interply::record {

/// Takes what a run publishes, the header first, then in any order between participants, and keeps a record that is
/// valid at any instant.
///
/// The file appears once frame 0 of every layer, interface and tool is there; until then everything is kept in memory.
/// Frame k is complete when every layer, interface and tool has delivered it; frames_complete counts frames 0, 1, ...
/// without a gap. History rows are written in blocks: with a complete frame, by flush(), or when a block is full; rows
/// beyond what the header announced are left out with one log line.
/// Beside the record: scene.yaml, unless there is one, and summary.json at the end of a run that has one.
/// Safe to call from several threads. put() throws Misfit (file.hpp) for what does not belong to this run or does not
/// fit it, std::runtime_error if the disk fails.
class RecordWriter : public observe::Sink {
 public:
  /// @param file       e.g. run/record.h5; the sidecar is run/record.xdmf. Folders are made, and an existing record is
  ///                   removed, when the header comes
  /// @param overwrite  an existing record may be replaced, but nothing that no run wrote
  /// @throws FolderRefused (run_folder.hpp) if something is in the way
  explicit RecordWriter(const std::filesystem::path& file, bool overwrite = false);
  /// close(), errors go to the log.
  ~RecordWriter() override;

  void put(const observe::RunHeader&) override;
  void put(const observe::LayerMesh&) override;
  void put(const observe::LayerFrame&) override;
  void put(const observe::InterfaceFrame&) override;
  void put(const observe::ToolFrame&) override;
  void put(const observe::HistoryRow&) override;
  /// Written by close().
  void put(const observe::RunEnd&) override;
  /// Writes the history rows that wait for others. True.
  bool flush(double seconds) override;

  bool has_header() const;
  bool has_end() const;
  /// RunEnd has arrived, and every frame that it counts.
  bool is_complete() const;
  int frames_complete() const;
  /// History rows in the file, or left out because it has no room for them.
  std::int64_t rows_settled() const;
  /// Which participant's data are missing, one sentence; empty if nothing is.
  std::string describe_missing() const;

  /// Writes status, message and digest of RunEnd ("interrupted" if there was none), and closes. If frame 0 never became
  /// complete the file is made now from what is known; without a header nothing is written. A run that is done is lost
  /// if frames of it are missing.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace interply::record
