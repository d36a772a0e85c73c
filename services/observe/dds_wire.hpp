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

/// `lasting`: sent once, only the last sample of an instance matters; else every sample does.
template <typename T>
struct Wire;

#define INTERPLY_WIRE(T, NAME, LASTING)                                                       \
  template <>                                                                                 \
  struct Wire<T> {                                                                            \
    using Type = interply_observe_##T;                                                        \
    static constexpr const char* name = NAME;                                                 \
    static constexpr const dds_topic_descriptor_t* descriptor = &interply_observe_##T##_desc; \
    static constexpr bool lasting = LASTING;                                                  \
  };
INTERPLY_WIRE(RunHeader, "interply_run_header", true)
INTERPLY_WIRE(LayerMesh, "interply_layer_mesh", true)
INTERPLY_WIRE(LayerFrame, "interply_layer_frame", false)
INTERPLY_WIRE(InterfaceFrame, "interply_interface_frame", false)
INTERPLY_WIRE(ToolFrame, "interply_tool_frame", false)
INTERPLY_WIRE(HistoryRow, "interply_history_row", false)
INTERPLY_WIRE(RunEnd, "interply_run_end", true)
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

/// Quality of service of T's writer and reader in the partition `run`.
using Qos = std::unique_ptr<dds_qos_t, void (*)(dds_qos_t*)>;
Qos make_qos(bool lasting);
/// Quality of service of a publisher or subscriber: the partition.
Qos make_partition_qos(const std::string& run);

/// User data by which a writer tells a recorder's readers from others.
inline constexpr const char* kRecorderMark = "interply-recorder";

/// A wire sample and the small arrays it points to.
template <typename T>
struct Encoded {
  typename Wire<T>::Type sample{};
  std::vector<interply_observe_Field> fields, fields_on_other;
  std::array<std::vector<char*>, 5> strings;
  std::vector<interply_observe_ToolSurface> surfaces;
};
Encoded<RunHeader> encode(const RunHeader& a);
Encoded<LayerMesh> encode(const LayerMesh& a);
Encoded<LayerFrame> encode(const LayerFrame& a);
Encoded<InterfaceFrame> encode(const InterfaceFrame& a);
Encoded<ToolFrame> encode(const ToolFrame& a);
Encoded<HistoryRow> encode(const HistoryRow& a);
/// `run` is the key.
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
