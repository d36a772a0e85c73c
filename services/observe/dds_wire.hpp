/// Between the structs of frames.hpp and their wire types generated from proto/observe.idl. Internal to observe.
///
/// The wire type of T is Wire<T>::Type. `Encoded<T>` is a wire sample that points into a T without copying its arrays:
/// valid while the T lives.
#pragma once

#include <dds/dds.h>
#include <observe.h>  // generated

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "observe/frames.hpp"

namespace interply::observe {

/// `depth`: samples of an instance (run, layer, interface, tool; all history rows are one) kept for a reader that is
/// slow: older ones give way.
template <typename T>
struct Wire;

#define INTERPLY_WIRE(T, NAME, DEPTH)                                                         \
  template <>                                                                                 \
  struct Wire<T> {                                                                            \
    using Type = interply_observe_##T;                                                        \
    static constexpr const char* name = NAME;                                                 \
    static constexpr const dds_topic_descriptor_t* descriptor = &interply_observe_##T##_desc; \
    static constexpr int depth = DEPTH;                                                       \
  };
INTERPLY_WIRE(RunHeader, "interply_run_header", 1)
INTERPLY_WIRE(LayerMesh, "interply_layer_mesh", 1)
INTERPLY_WIRE(LayerFrame, "interply_layer_frame", 8)
INTERPLY_WIRE(InterfaceFrame, "interply_interface_frame", 8)
INTERPLY_WIRE(ToolFrame, "interply_tool_frame", 8)
INTERPLY_WIRE(HistoryRow, "interply_history_row", 1000)
INTERPLY_WIRE(RunEnd, "interply_run_end", 1)
#undef INTERPLY_WIRE

inline constexpr int kTopics = 7;
/// Position of T's topic among the seven, in the order a reader handles them.
template <typename T>
constexpr int topic_index();
template <>
constexpr int topic_index<RunHeader>() {
  return 0;
}
template <>
constexpr int topic_index<LayerMesh>() {
  return 1;
}
template <>
constexpr int topic_index<LayerFrame>() {
  return 2;
}
template <>
constexpr int topic_index<InterfaceFrame>() {
  return 3;
}
template <>
constexpr int topic_index<ToolFrame>() {
  return 4;
}
template <>
constexpr int topic_index<HistoryRow>() {
  return 5;
}
template <>
constexpr int topic_index<RunEnd>() {
  return 6;
}

/// Calls `f.template operator()<T>()` for the seven structs in that order.
template <typename F>
void for_each_topic(F&& f) {
  f.template operator()<RunHeader>();
  f.template operator()<LayerMesh>();
  f.template operator()<LayerFrame>();
  f.template operator()<InterfaceFrame>();
  f.template operator()<ToolFrame>();
  f.template operator()<HistoryRow>();
  f.template operator()<RunEnd>();
}

/// Quality of service of a writer and reader that keep `depth` samples of an instance. A writer never waits; a reader
/// keeps a bounded number of instances and samples.
using Qos = std::unique_ptr<dds_qos_t, void (*)(dds_qos_t*)>;
Qos make_writer_qos(int depth);
Qos make_reader_qos(int depth);
/// Quality of service of a publisher or subscriber: the partition.
Qos make_partition_qos(const std::string& run);

/// A wire sample and the small arrays it points to.
template <typename T>
struct Encoded {
  typename Wire<T>::Type sample{};
  std::vector<interply_observe_Field> fields, fields_on_other;
  std::array<std::vector<char*>, 5> strings;
  std::vector<interply_observe_ToolSurface> surfaces;
};
/// @param run  stamp of the sample; lives as long as the result
Encoded<RunHeader> encode(const RunHeader& a, const std::string& run);
Encoded<LayerMesh> encode(const LayerMesh& a, const std::string& run);
Encoded<LayerFrame> encode(const LayerFrame& a, const std::string& run);
Encoded<InterfaceFrame> encode(const InterfaceFrame& a, const std::string& run);
Encoded<ToolFrame> encode(const ToolFrame& a, const std::string& run);
Encoded<HistoryRow> encode(const HistoryRow& a, const std::string& run);
Encoded<RunEnd> encode(const RunEnd& a, const std::string& run);

/// @throws std::runtime_error naming what is malformed
RunHeader decode(const interply_observe_RunHeader& w);
LayerMesh decode(const interply_observe_LayerMesh& w);
LayerFrame decode(const interply_observe_LayerFrame& w);
InterfaceFrame decode(const interply_observe_InterfaceFrame& w);
ToolFrame decode(const interply_observe_ToolFrame& w);
HistoryRow decode(const interply_observe_HistoryRow& w);
RunEnd decode(const interply_observe_RunEnd& w);

}  // namespace interply::observe
