/// The HDF5 file of one run (proto/RECORD.md), laid out completely before the first value is written.
///
/// Crash safety by construction: the file is created with every dataset contiguous, at its final extent, allocated and
/// filled, under a temporary name; then it is closed and renamed. From then on only raw data are overwritten in place,
/// so that no metadata change and the file is valid at any instant, also after the writer was killed. Internal to
/// record.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "observe/frames.hpp"
#include "record/hdf5.hpp"
#include "record/layout.hpp"

namespace interply::record {

/// Values that do not belong to this run or do not fit it: whose, and what is wrong.
class Misfit : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Every field needs one value per node or element of the mesh that carries it. @throws Misfit
void check_fields(const std::string& owner, const observe::LayerMesh& mesh, const std::vector<FieldShape>& fields);

class RecordFile {
 public:
  /// Creates the file at `path`. @throws Misfit; std::system_error if it cannot be written; if there is no room for it
  /// and its sidecar, before a byte is
  RecordFile(const std::filesystem::path& path, Layout layout);

  const Layout& layout() const { return layout_; }

  /// Empty if `frame` fits the layout, else a sentence that says why not.
  std::string describe_mismatch(const observe::LayerFrame& frame) const;
  std::string describe_mismatch(const observe::InterfaceFrame& frame) const;

  /// @pre frames fit the layout
  void write(const observe::LayerFrame& frame);
  void write(const observe::InterfaceFrame& frame);
  void write(const observe::ToolFrame& frame);
  /// Rows `first`, `first` + 1, ... of /history, then rows_complete: a write per column however many they are. A list
  /// without one value per layer (interface) stays NaN.
  void write(std::span<const observe::HistoryRow> rows, int first);
  /// Time and step of frame `frame`; then, once all its data are in the file, frames_complete = frame + 1.
  void complete_frame(int frame, double time, std::int64_t step);
  void write_end(const std::string& status, const std::string& message, const std::string& digest);

 private:
  const Handle& dataset(const std::string& path);
  void write_fields(const std::string& group, int frame, const std::vector<observe::Field>& fields);

  Layout layout_;
  Handle file_;
  std::map<std::string, Handle> datasets_;
};

}  // namespace interply::record
