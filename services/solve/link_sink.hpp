/// A sink that hands everything to the run's recorder, over the link that a participant has anyway.
#pragma once

#include <string>
#include <utility>

#include "exchange/link.hpp"
#include "observe/sample.hpp"

namespace interply::solve {

/// Used by the thread that uses the link. Nothing here waits: the coordinator orders no more frames than the recorder
/// keeps up with.
/// @tparam Link  exchange::SolverLink or exchange::CoordinatorLink
template <typename Link>
class LinkSink : public observe::Sink {
 public:
  /// @param layer  of a solver; empty for the coordinator
  explicit LinkSink(Link& link, std::string layer = {}) : link_(link), layer_(std::move(layer)) {}

  void put(const observe::RunHeader& a) override { send(a); }
  void put(const observe::LayerMesh& a) override { send(a); }
  void put(const observe::LayerFrame& a) override { send(a, a.frame); }
  void put(const observe::InterfaceFrame& a) override { send(a, a.frame); }
  void put(const observe::ToolFrame& a) override { send(a, a.frame); }
  void put(const observe::HistoryRow& a) override { send(a); }
  void put(const observe::RunEnd& a) override { send(a); }
  bool flush(double) override { return true; }

 private:
  template <typename T>
  void send(const T& a, int frame = -1) {
    const std::string bytes = observe::encode_sample(a);
    link_.send(exchange::Sample{.layer = layer_, .frame = frame, .payload = std::as_bytes(std::span(bytes))});
  }
  Link& link_;
  const std::string layer_;
};

}  // namespace interply::solve
