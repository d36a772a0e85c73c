/// A sink that keeps everything in memory, for tests that look at frames and history.
#pragma once

#include <algorithm>
#include <mutex>
#include <string>
#include <vector>

#include "observe/frames.hpp"

namespace interply::test {

/// Everything a run has published, in order of arrival. Safe to call from all threads of a run; read it afterwards.
class MemorySink : public observe::Sink {
 public:
  void put(const observe::RunHeader& v) override {
    keep([&] { header = v; });
  }
  void put(const observe::LayerMesh& v) override {
    keep([&] { meshes.push_back(v); });
  }
  void put(const observe::LayerFrame& v) override {
    keep([&] { layers.push_back(v); });
  }
  void put(const observe::InterfaceFrame& v) override {
    keep([&] { interfaces.push_back(v); });
  }
  void put(const observe::ToolFrame& v) override {
    keep([&] { tools.push_back(v); });
  }
  void put(const observe::HistoryRow& v) override {
    keep([&] { rows.push_back(v); });
  }
  void put(const observe::RunEnd& v) override {
    keep([&] { end = v; });
  }
  bool flush(double) override { return true; }

  /// Last frame of a layer, interface or tool. @pre there is one
  const observe::LayerFrame& last_of_layer(const std::string& name) const {
    return *std::find_if(layers.rbegin(), layers.rend(), [&](auto& f) { return f.layer == name; });
  }
  const observe::InterfaceFrame& last_of_interface(const std::string& name) const {
    return *std::find_if(interfaces.rbegin(), interfaces.rend(), [&](auto& f) { return f.interface == name; });
  }
  const observe::LayerMesh& mesh_of(const std::string& name) const {
    return *std::find_if(meshes.begin(), meshes.end(), [&](auto& m) { return m.layer == name; });
  }

  observe::RunHeader header;
  observe::RunEnd end;
  std::vector<observe::LayerMesh> meshes;
  std::vector<observe::LayerFrame> layers;
  std::vector<observe::InterfaceFrame> interfaces;
  std::vector<observe::ToolFrame> tools;
  std::vector<observe::HistoryRow> rows;

 private:
  template <typename F>
  void keep(F f) {
    const std::lock_guard lock(mutex_);
    f();
  }
  std::mutex mutex_;
};

/// Values of a field of any frame. @pre it has that field
template <typename Frame>
const std::vector<double>& field(const Frame& frame, const std::string& name) {
  return std::find_if(frame.fields.begin(), frame.fields.end(), [&](auto& f) { return f.name == name; })->values;
}

}  // namespace interply::test
