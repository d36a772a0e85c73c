#include "observe/dds_wire.hpp"

#include <spdlog/fmt/fmt.h>

#include <stdexcept>

namespace interply::observe {
namespace {

/// DDS reads but never changes a sample that it writes.
char* view(const std::string& s) { return const_cast<char*>(s.c_str()); }

dds_sequence_double view(const double* data, std::size_t n) {
  const auto length = static_cast<std::uint32_t>(n);
  return {length, length, const_cast<double*>(data), false};
}
dds_sequence_double view(const std::vector<double>& a) { return view(a.data(), a.size()); }
dds_sequence_double view(const mechanics::NodalVectors& a) {
  return view(a.data(), static_cast<std::size_t>(a.size()));
}
dds_sequence_long view(const mechanics::Triangles& a) {
  const auto length = static_cast<std::uint32_t>(a.size());
  return {length, length, const_cast<int*>(a.data()), false};
}
dds_sequence_long_long view(const std::vector<std::int64_t>& a) {
  const auto length = static_cast<std::uint32_t>(a.size());
  return {length, length, const_cast<std::int64_t*>(a.data()), false};
}
dds_sequence_string view(const std::vector<std::string>& a, std::vector<char*>& pointers) {
  for (const std::string& s : a) pointers.push_back(view(s));
  const auto length = static_cast<std::uint32_t>(pointers.size());
  return {length, length, pointers.data(), false};
}
template <typename Sequence>
Sequence view(const std::vector<Field>& a, std::vector<interply_observe_Field>& fields) {
  for (const Field& f : a) {
    fields.push_back({view(f.name), view(f.unit), view(f.description), f.nodal, f.components, view(f.values)});
  }
  const auto length = static_cast<std::uint32_t>(fields.size());
  return {length, length, fields.data(), false};
}

template <typename Sequence>
Sequence view(const std::vector<ToolSurface>& a, std::vector<interply_observe_ToolSurface>& surfaces) {
  for (const ToolSurface& s : a) surfaces.push_back({view(s.nodes), view(s.triangles)});
  const auto length = static_cast<std::uint32_t>(surfaces.size());
  return {length, length, surfaces.data(), false};
}

std::vector<double> copy(const dds_sequence_double& w) { return {w._buffer, w._buffer + w._length}; }
std::vector<std::int64_t> copy(const dds_sequence_long_long& w) { return {w._buffer, w._buffer + w._length}; }
std::vector<std::string> copy(const dds_sequence_string& w) { return {w._buffer, w._buffer + w._length}; }

/// [3 x n] row-major array.
template <typename Array, typename Sequence>
Array copy_rows(const Sequence& w, const char* what, const std::string& owner) {
  if (w._length % 3 != 0) {
    throw std::runtime_error(fmt::format("{} of {} has {} values, not a multiple of 3", what, owner, w._length));
  }
  return Eigen::Map<const Array>(w._buffer, 3, w._length / 3);
}

template <typename Sequence>
std::vector<Field> copy_fields(const Sequence& w) {
  std::vector<Field> fields(w._length);
  for (std::uint32_t i = 0; i < w._length; ++i) {
    const interply_observe_Field& f = w._buffer[i];
    if (f.components < 1 || f.values._length % static_cast<std::uint32_t>(f.components) != 0) {
      throw std::runtime_error(
          fmt::format("field '{}' has {} values in {} components", f.name, f.values._length, f.components));
    }
    fields[i] = {f.name, f.unit, f.description, f.nodal, copy(f.values), f.components};
  }
  return fields;
}

template <typename Sequence>
std::vector<ToolSurface> copy_surfaces(const Sequence& w) {
  std::vector<ToolSurface> surfaces;
  for (std::uint32_t i = 0; i < w._length; ++i) {
    const std::string owner = fmt::format("the surface of tool {}", i);
    surfaces.push_back({copy_rows<mechanics::NodalVectors>(w._buffer[i].nodes, "nodes", owner),
                        copy_rows<mechanics::Triangles>(w._buffer[i].triangles, "triangles", owner)});
  }
  return surfaces;
}

std::string name_layer(const char* layer) { return fmt::format("layer '{}'", layer); }

}  // namespace

namespace {

Qos make_qos(int depth) {
  Qos qos(dds_create_qos(), dds_delete_qos);
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, 0);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth);
  // Transient-local also closes the gap between the moment a writer knows a reader and the reverse: a volatile reader
  // starts at the writer's first heartbeat and would miss what was written before it.
  dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
  return qos;
}

}  // namespace

Qos make_writer_qos(int depth) {
  Qos qos = make_qos(depth);
  dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, 1, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED);
  dds_qset_writer_data_lifecycle(qos.get(), false);
  return qos;
}

Qos make_reader_qos(int depth) {
  constexpr int kInstances = 256;
  Qos qos = make_qos(depth);
  dds_qset_resource_limits(qos.get(), kInstances * 4, kInstances, depth);
  return qos;
}

Qos make_partition_qos(const std::string& run) {
  Qos qos(dds_create_qos(), dds_delete_qos);
  const char* partition = run.c_str();
  dds_qset_partition(qos.get(), 1, &partition);
  return qos;
}

Encoded<RunHeader> encode(const RunHeader& a, const std::string& run) {
  Encoded<RunHeader> e;
  e.sample = {.run = view(run),
              .scene_text = view(a.scene_text),
              .version = view(a.version),
              .scene_digest = view(a.scene_digest),
              .layers = view(a.layers, e.strings[0]),
              .interfaces = view(a.interfaces, e.strings[1]),
              .tools = view(a.tools, e.strings[2]),
              .interface_nodes_of = view(a.interface_nodes_of, e.strings[3]),
              .interface_others = view(a.interface_others, e.strings[4]),
              .tool_surfaces = view<decltype(e.sample.tool_surfaces)>(a.tool_surfaces, e.surfaces),
              .frames = a.frames,
              .history_capacity = a.history_capacity,
              .nodes = view(a.nodes),
              .elements = view(a.elements)};
  return e;
}

Encoded<LayerMesh> encode(const LayerMesh& a, const std::string& run) {
  Encoded<LayerMesh> e;
  e.sample = {.run = view(run),
              .layer = view(a.layer),
              .kind = view(a.kind),
              .thickness = a.thickness,
              .reference = view(a.reference),
              .triangles = view(a.triangles)};
  return e;
}

Encoded<LayerFrame> encode(const LayerFrame& a, const std::string& run) {
  Encoded<LayerFrame> e;
  e.sample = {.run = view(run),
              .layer = view(a.layer),
              .frame = a.frame,
              .step = a.step,
              .time = a.time,
              .position = view(a.position),
              .fields = view<decltype(e.sample.fields)>(a.fields, e.fields)};
  return e;
}

Encoded<InterfaceFrame> encode(const InterfaceFrame& a, const std::string& run) {
  Encoded<InterfaceFrame> e;
  e.sample = {.run = view(run),
              .pair = view(a.interface),
              .nodes_of = view(a.nodes_of),
              .frame = a.frame,
              .step = a.step,
              .time = a.time,
              .fields = view<decltype(e.sample.fields)>(a.fields, e.fields),
              .fields_on_other = view<decltype(e.sample.fields_on_other)>(a.fields_on_other, e.fields_on_other)};
  return e;
}

Encoded<ToolFrame> encode(const ToolFrame& a, const std::string& run) {
  Encoded<ToolFrame> e;
  e.sample = {.run = view(run),
              .tool = view(a.tool),
              .frame = a.frame,
              .step = a.step,
              .time = a.time,
              .position = a.position,
              .force = {a.force[0], a.force[1], a.force[2]},
              .moment = {a.moment[0], a.moment[1], a.moment[2]}};
  return e;
}

Encoded<HistoryRow> encode(const HistoryRow& a, const std::string& run) {
  Encoded<HistoryRow> e;
  e.sample = {.run = view(run),
              .step = a.step,
              .time = a.time,
              .dt = a.dt,
              .stroke = a.stroke,
              .kinetic = a.kinetic,
              .internal = a.internal,
              .contact = a.contact,
              .friction = a.friction,
              .damping = a.damping,
              .thinning = a.thinning,
              .external = a.external,
              .residual = a.residual,
              .punch_force = a.punch_force,
              .blank_holder_force = a.blank_holder_force,
              .blank_holder_target = a.blank_holder_target,
              .peak_penetration = a.peak_penetration,
              .contact_vote = a.contact_vote,
              .layer_kinetic = view(a.layer_kinetic),
              .layer_internal = view(a.layer_internal),
              .layer_residual = view(a.layer_residual),
              .votes = view(a.votes),
              .step_seconds = view(a.step_seconds),
              .wait_seconds = view(a.wait_seconds),
              .coordinator_step_seconds = a.coordinator_step_seconds,
              .coordinator_wait_seconds = a.coordinator_wait_seconds,
              .interface_residual = view(a.interface_residual),
              .interface_friction = view(a.interface_friction)};
  return e;
}

Encoded<RunEnd> encode(const RunEnd& a, const std::string& run) {
  Encoded<RunEnd> e;
  e.sample = {.run = view(run),
              .status = view(a.status),
              .message = view(a.message),
              .digest = view(a.digest),
              .frames_complete = a.frames_complete,
              .summary = view(a.summary)};
  return e;
}

RunHeader decode(const interply_observe_RunHeader& w) {
  return {.run = w.run,
          .scene_text = w.scene_text,
          .version = w.version,
          .scene_digest = w.scene_digest,
          .layers = copy(w.layers),
          .interfaces = copy(w.interfaces),
          .tools = copy(w.tools),
          .interface_nodes_of = copy(w.interface_nodes_of),
          .interface_others = copy(w.interface_others),
          .tool_surfaces = copy_surfaces(w.tool_surfaces),
          .frames = w.frames,
          .history_capacity = w.history_capacity,
          .nodes = copy(w.nodes),
          .elements = copy(w.elements)};
}

LayerMesh decode(const interply_observe_LayerMesh& w) {
  return {.layer = w.layer,
          .kind = w.kind,
          .thickness = w.thickness,
          .reference = copy_rows<mechanics::NodalVectors>(w.reference, "reference", name_layer(w.layer)),
          .triangles = copy_rows<mechanics::Triangles>(w.triangles, "triangles", name_layer(w.layer))};
}

LayerFrame decode(const interply_observe_LayerFrame& w) {
  return {.layer = w.layer,
          .frame = w.frame,
          .step = w.step,
          .time = w.time,
          .position = copy_rows<mechanics::NodalVectors>(w.position, "position", name_layer(w.layer)),
          .fields = copy_fields(w.fields)};
}

InterfaceFrame decode(const interply_observe_InterfaceFrame& w) {
  return {.interface = w.pair,
          .nodes_of = w.nodes_of,
          .frame = w.frame,
          .step = w.step,
          .time = w.time,
          .fields = copy_fields(w.fields),
          .fields_on_other = copy_fields(w.fields_on_other)};
}

ToolFrame decode(const interply_observe_ToolFrame& w) {
  return {.tool = w.tool,
          .frame = w.frame,
          .step = w.step,
          .time = w.time,
          .position = w.position,
          .force = {w.force[0], w.force[1], w.force[2]},
          .moment = {w.moment[0], w.moment[1], w.moment[2]}};
}

HistoryRow decode(const interply_observe_HistoryRow& w) {
  return {.step = w.step,
          .time = w.time,
          .dt = w.dt,
          .stroke = w.stroke,
          .kinetic = w.kinetic,
          .internal = w.internal,
          .contact = w.contact,
          .friction = w.friction,
          .damping = w.damping,
          .thinning = w.thinning,
          .external = w.external,
          .residual = w.residual,
          .punch_force = w.punch_force,
          .blank_holder_force = w.blank_holder_force,
          .blank_holder_target = w.blank_holder_target,
          .peak_penetration = w.peak_penetration,
          .contact_vote = w.contact_vote,
          .layer_kinetic = copy(w.layer_kinetic),
          .layer_internal = copy(w.layer_internal),
          .layer_residual = copy(w.layer_residual),
          .votes = copy(w.votes),
          .step_seconds = copy(w.step_seconds),
          .wait_seconds = copy(w.wait_seconds),
          .coordinator_step_seconds = w.coordinator_step_seconds,
          .coordinator_wait_seconds = w.coordinator_wait_seconds,
          .interface_residual = copy(w.interface_residual),
          .interface_friction = copy(w.interface_friction)};
}

RunEnd decode(const interply_observe_RunEnd& w) {
  return {.status = w.status,
          .message = w.message,
          .digest = w.digest,
          .frames_complete = w.frames_complete,
          .summary = w.summary};
}

}  // namespace interply::observe
