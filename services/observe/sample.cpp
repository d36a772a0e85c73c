#include "observe/sample.hpp"

#include <spdlog/fmt/fmt.h>

#include <stdexcept>

#include "sample.pb.h"

namespace interply::observe {
namespace {

template <typename Numbers, typename Array>
void put(Numbers* to, const Array& a) {
  to->Add(a.data(), a.data() + a.size());
}

template <typename Texts>
void put_texts(Texts* to, const std::vector<std::string>& texts) {
  to->Add(texts.begin(), texts.end());
}

template <typename Fields>
void put_fields(Fields* to, const std::vector<Field>& fields) {
  for (const Field& f : fields) {
    sample::Field& field = *to->Add();
    field.set_name(f.name);
    field.set_unit(f.unit);
    field.set_description(f.description);
    field.set_nodal(f.nodal);
    field.set_components(f.components);
    put(field.mutable_values(), f.values);
  }
}

template <typename Array, typename Numbers>
Array get_triples(const Numbers& from) {
  if (from.size() % 3 != 0)
    throw std::invalid_argument(fmt::format("has {} coordinates or corners, which is no multiple of 3", from.size()));
  return Eigen::Map<const Array>(from.data(), 3, from.size() / 3);
}

template <typename Value, typename Numbers>
std::vector<Value> get(const Numbers& from) {
  return {from.begin(), from.end()};
}

template <typename Fields>
std::vector<Field> get_fields(const Fields& from) {
  std::vector<Field> fields;
  for (const sample::Field& f : from) {
    if (f.components() < 1 || f.values_size() % f.components() != 0)
      throw std::invalid_argument(fmt::format("has a field of {} values in {} components", f.values_size(), f.components()));
    fields.push_back({.name = f.name(),
                      .unit = f.unit(),
                      .description = f.description(),
                      .nodal = f.nodal(),
                      .values = get<double>(f.values()),
                      .components = f.components()});
  }
  return fields;
}

RunHeader get(const sample::RunHeader& from) {
  std::vector<ToolSurface> surfaces;
  for (const sample::ToolSurface& s : from.tool_surfaces())
    surfaces.push_back(
        {get_triples<mechanics::NodalVectors>(s.nodes()), get_triples<mechanics::Triangles>(s.triangles())});
  return {.run = from.run(),
          .scene_text = from.scene_text(),
          .version = from.version(),
          .scene_digest = from.scene_digest(),
          .layers = get<std::string>(from.layers()),
          .interfaces = get<std::string>(from.interfaces()),
          .tools = get<std::string>(from.tools()),
          .interface_nodes_of = get<std::string>(from.interface_nodes_of()),
          .interface_others = get<std::string>(from.interface_others()),
          .tool_surfaces = std::move(surfaces),
          .frames = from.frames(),
          .history_capacity = from.history_capacity(),
          .nodes = get<std::int64_t>(from.nodes()),
          .elements = get<std::int64_t>(from.elements())};
}

LayerMesh get(const sample::LayerMesh& from) {
  return {.layer = from.layer(),
          .kind = from.kind(),
          .thickness = from.thickness(),
          .reference = get_triples<mechanics::NodalVectors>(from.reference()),
          .triangles = get_triples<mechanics::Triangles>(from.triangles())};
}

LayerFrame get(const sample::LayerFrame& from) {
  return {.layer = from.layer(),
          .frame = from.frame(),
          .step = from.step(),
          .time = from.time(),
          .position = get_triples<mechanics::NodalVectors>(from.position()),
          .fields = get_fields(from.fields())};
}

InterfaceFrame get(const sample::InterfaceFrame& from) {
  return {.interface = from.interface(),
          .nodes_of = from.nodes_of(),
          .frame = from.frame(),
          .step = from.step(),
          .time = from.time(),
          .fields = get_fields(from.fields()),
          .fields_on_other = get_fields(from.fields_on_other())};
}

ToolFrame get(const sample::ToolFrame& from) {
  for (const int n : {from.force_size(), from.moment_size()})
    if (n != 3) throw std::invalid_argument(fmt::format("has a force or moment of {} numbers", n));
  return {.tool = from.tool(),
          .frame = from.frame(),
          .step = from.step(),
          .time = from.time(),
          .position = from.position(),
          .force = {from.force(0), from.force(1), from.force(2)},
          .moment = {from.moment(0), from.moment(1), from.moment(2)}};
}

HistoryRow get(const sample::HistoryRow& from) {
  HistoryRow row{.step = from.step(), .time = from.time(), .dt = from.dt(), .stroke = from.stroke()};
  row.kinetic = from.kinetic();
  row.internal = from.internal();
  row.contact = from.contact();
  row.friction = from.friction();
  row.damping = from.damping();
  row.thinning = from.thinning();
  row.external = from.external();
  row.residual = from.residual();
  row.punch_force = from.punch_force();
  row.blank_holder_force = from.blank_holder_force();
  row.blank_holder_target = from.blank_holder_target();
  row.peak_penetration = from.peak_penetration();
  row.contact_vote = from.contact_vote();
  row.layer_kinetic = get<double>(from.layer_kinetic());
  row.layer_internal = get<double>(from.layer_internal());
  row.layer_residual = get<double>(from.layer_residual());
  row.votes = get<double>(from.votes());
  row.step_seconds = get<double>(from.step_seconds());
  row.wait_seconds = get<double>(from.wait_seconds());
  row.coordinator_step_seconds = from.coordinator_step_seconds();
  row.coordinator_wait_seconds = from.coordinator_wait_seconds();
  row.interface_residual = get<double>(from.interface_residual());
  row.interface_friction = get<double>(from.interface_friction());
  return row;
}

RunEnd get(const sample::RunEnd& from) {
  return {.status = from.status(),
          .message = from.message(),
          .digest = from.digest(),
          .frames_complete = from.frames_complete(),
          .summary = from.summary()};
}

}  // namespace

std::string encode_sample(const RunHeader& a) {
  sample::Sample whole;
  sample::RunHeader& to = *whole.mutable_header();
  to.set_run(a.run);
  to.set_scene_text(a.scene_text);
  to.set_version(a.version);
  to.set_scene_digest(a.scene_digest);
  put_texts(to.mutable_layers(), a.layers);
  put_texts(to.mutable_interfaces(), a.interfaces);
  put_texts(to.mutable_tools(), a.tools);
  put_texts(to.mutable_interface_nodes_of(), a.interface_nodes_of);
  put_texts(to.mutable_interface_others(), a.interface_others);
  for (const ToolSurface& s : a.tool_surfaces) {
    sample::ToolSurface& surface = *to.add_tool_surfaces();
    put(surface.mutable_nodes(), s.nodes);
    put(surface.mutable_triangles(), s.triangles);
  }
  to.set_frames(a.frames);
  to.set_history_capacity(a.history_capacity);
  put(to.mutable_nodes(), a.nodes);
  put(to.mutable_elements(), a.elements);
  return whole.SerializeAsString();
}

std::string encode_sample(const LayerMesh& a) {
  sample::Sample whole;
  sample::LayerMesh& to = *whole.mutable_mesh();
  to.set_layer(a.layer);
  to.set_kind(a.kind);
  to.set_thickness(a.thickness);
  put(to.mutable_reference(), a.reference);
  put(to.mutable_triangles(), a.triangles);
  return whole.SerializeAsString();
}

std::string encode_sample(const LayerFrame& a) {
  sample::Sample whole;
  sample::LayerFrame& to = *whole.mutable_layer();
  to.set_layer(a.layer);
  to.set_frame(a.frame);
  to.set_step(a.step);
  to.set_time(a.time);
  put(to.mutable_position(), a.position);
  put_fields(to.mutable_fields(), a.fields);
  return whole.SerializeAsString();
}

std::string encode_sample(const InterfaceFrame& a) {
  sample::Sample whole;
  sample::InterfaceFrame& to = *whole.mutable_interface();
  to.set_interface(a.interface);
  to.set_nodes_of(a.nodes_of);
  to.set_frame(a.frame);
  to.set_step(a.step);
  to.set_time(a.time);
  put_fields(to.mutable_fields(), a.fields);
  put_fields(to.mutable_fields_on_other(), a.fields_on_other);
  return whole.SerializeAsString();
}

std::string encode_sample(const ToolFrame& a) {
  sample::Sample whole;
  sample::ToolFrame& to = *whole.mutable_tool();
  to.set_tool(a.tool);
  to.set_frame(a.frame);
  to.set_step(a.step);
  to.set_time(a.time);
  to.set_position(a.position);
  to.mutable_force()->Add(a.force, a.force + 3);
  to.mutable_moment()->Add(a.moment, a.moment + 3);
  return whole.SerializeAsString();
}

std::string encode_sample(const HistoryRow& a) {
  sample::Sample whole;
  sample::HistoryRow& to = *whole.mutable_row();
  to.set_step(a.step);
  to.set_time(a.time);
  to.set_dt(a.dt);
  to.set_stroke(a.stroke);
  to.set_kinetic(a.kinetic);
  to.set_internal(a.internal);
  to.set_contact(a.contact);
  to.set_friction(a.friction);
  to.set_damping(a.damping);
  to.set_thinning(a.thinning);
  to.set_external(a.external);
  to.set_residual(a.residual);
  to.set_punch_force(a.punch_force);
  to.set_blank_holder_force(a.blank_holder_force);
  to.set_blank_holder_target(a.blank_holder_target);
  to.set_peak_penetration(a.peak_penetration);
  to.set_contact_vote(a.contact_vote);
  put(to.mutable_layer_kinetic(), a.layer_kinetic);
  put(to.mutable_layer_internal(), a.layer_internal);
  put(to.mutable_layer_residual(), a.layer_residual);
  put(to.mutable_votes(), a.votes);
  put(to.mutable_step_seconds(), a.step_seconds);
  put(to.mutable_wait_seconds(), a.wait_seconds);
  to.set_coordinator_step_seconds(a.coordinator_step_seconds);
  to.set_coordinator_wait_seconds(a.coordinator_wait_seconds);
  put(to.mutable_interface_residual(), a.interface_residual);
  put(to.mutable_interface_friction(), a.interface_friction);
  return whole.SerializeAsString();
}

std::string encode_sample(const RunEnd& a) {
  sample::Sample whole;
  sample::RunEnd& to = *whole.mutable_end();
  to.set_status(a.status);
  to.set_message(a.message);
  to.set_digest(a.digest);
  to.set_frames_complete(a.frames_complete);
  to.set_summary(a.summary);
  return whole.SerializeAsString();
}

void decode_sample(std::span<const std::byte> bytes, Sink& sink) {
  sample::Sample whole;
  if (!whole.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) throw std::invalid_argument("is unreadable");
  switch (whole.kind_case()) {
    case sample::Sample::kHeader:
      return sink.put(get(whole.header()));
    case sample::Sample::kMesh:
      return sink.put(get(whole.mesh()));
    case sample::Sample::kLayer:
      return sink.put(get(whole.layer()));
    case sample::Sample::kInterface:
      return sink.put(get(whole.interface()));
    case sample::Sample::kTool:
      return sink.put(get(whole.tool()));
    case sample::Sample::kRow:
      return sink.put(get(whole.row()));
    case sample::Sample::kEnd:
      return sink.put(get(whole.end()));
    case sample::Sample::KIND_NOT_SET:
      break;
  }
  throw std::invalid_argument("is of no known kind");
}

}  // namespace interply::observe
