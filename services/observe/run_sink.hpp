/// The sink of one participant of a federated run: DDS with a recorder listening, or nothing.
#pragma once

#include <memory>

#include "observe/dds.hpp"

namespace interply::observe {

/// Keeps nothing: runs without a record.
class NullSink : public Sink {
 public:
  void put(const RunHeader&) override {}
  void put(const LayerMesh&) override {}
  void put(const LayerFrame&) override {}
  void put(const InterfaceFrame&) override {}
  void put(const ToolFrame&) override {}
  void put(const HistoryRow&) override {}
  void put(const RunEnd&) override {}
  bool flush(double) override { return true; }
};

/// For whoever watches a run: a DdsSink; a NullSink if nothing is published or, with one warning, if DDS cannot be opened
/// (more than 120 participants on this host, no descriptors left): who watches never holds a run.
std::unique_ptr<Sink> make_watch_sink(bool published, const DdsOptions& options);

/// A DdsSink whose recorder is listening, or a NullSink if the run keeps no record.
/// @param deadline  s to wait for the recorder
/// @throws std::runtime_error naming the run and how to start a recorder, if none appears in time
std::unique_ptr<Sink> make_run_sink(bool recorded, const DdsOptions& options, double deadline);

}  // namespace interply::observe
