/// What a watcher of a run has seen.
#pragma once

#include <unistd.h>

#include <string>
#include <vector>

#include "observe/dds.hpp"

namespace interply::observe {

/// Keeps everything it is given.
struct Collector : Sink {
  std::vector<RunHeader> headers;
  std::vector<LayerMesh> meshes;
  std::vector<LayerFrame> layer_frames;
  std::vector<InterfaceFrame> interface_frames;
  std::vector<ToolFrame> tool_frames;
  std::vector<HistoryRow> rows;
  std::vector<RunEnd> ends;
  void put(const RunHeader& a) override { headers.push_back(a); }
  void put(const LayerMesh& a) override { meshes.push_back(a); }
  void put(const LayerFrame& a) override { layer_frames.push_back(a); }
  void put(const InterfaceFrame& a) override { interface_frames.push_back(a); }
  void put(const ToolFrame& a) override { tool_frames.push_back(a); }
  void put(const HistoryRow& a) override { rows.push_back(a); }
  void put(const RunEnd& a) override { ends.push_back(a); }
  bool flush(double) override { return true; }
};

/// Options of a run that no other test uses.
inline DdsOptions make_options(const std::string& name) {
  return {.network = "127.0.0.1", .multicast = false, .domain = 0, .run = name + "-" + std::to_string(getpid())};
}

/// Receives until `done` or nothing has come for 10 s.
template <typename Condition>
void receive_until(DdsSubscriber& subscriber, Sink& sink, Condition done) {
  while (!done() && subscriber.receive(sink, 10.0) > 0) {
  }
}

}  // namespace interply::observe
