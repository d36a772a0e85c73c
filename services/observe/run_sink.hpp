/// What one participant of a federated run publishes for those who watch: over DDS, or nothing.
#pragma once

#include <memory>

#include "observe/dds.hpp"

namespace interply::observe {

/// Keeps nothing.
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

/// For whoever watches a run: a DdsSink, or a NullSink if nothing is published or (one line in the log) nothing can be.
std::unique_ptr<Sink> make_watch_sink(bool published, const DdsOptions& options);

}  // namespace interply::observe
