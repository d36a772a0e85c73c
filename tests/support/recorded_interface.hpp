/// Frames of an interface as they are recorded, put in arrays: what a reader of the record sees.
#pragma once

#include <stdexcept>
#include <string>

#include "support/memory_sink.hpp"

namespace interply::test {

using mechanics::NodalVectors;
using mechanics::Scalars;
using mechanics::Vector3;

/// A nodal field [components x n], point innermost. @throws std::out_of_range if there is none
template <typename Fields>
Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> take(const Fields& fields,
                                                                           const std::string& name) {
  for (const observe::Field& f : fields) {
    if (f.name != name) continue;
    const auto n = static_cast<Eigen::Index>(f.values.size()) / f.components;
    return Eigen::Map<const Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(f.values.data(),
                                                                                                   f.components, n);
  }
  throw std::out_of_range("no field " + name);
}

template <typename Fields>
bool has(const Fields& fields, const std::string& name) {
  return std::any_of(fields.begin(), fields.end(), [&](const auto& f) { return f.name == name; });
}

/// One interface in one frame, with the positions of the layers and the tool that it lies between.
struct RecordedInterface {
  std::string name, nodes_of, other;
  int frame = 0;
  std::int64_t step = 0;
  Scalars reference_area;                 ///< [n] mm2
  Scalars pressure, true_pressure, slip, friction_work, state, area;  ///< [n]
  NodalVectors traction, true_traction, force, normal;   ///< [3 x n]
  NodalVectors position;                  ///< [3 x n] mm
  NodalVectors other_force;               ///< [3 x n of other] N; against a tool: its force, one column
  NodalVectors other_position;            ///< [3 x n of other] mm; none against a tool
  Vector3 tool_moment = Vector3::Zero();  ///< about the origin, N mm
};

/// All frames of all interfaces of a run.
inline std::vector<RecordedInterface> read_interfaces(const MemorySink& sink) {
  const auto find_layer = [&](const std::string& layer, int frame) -> const observe::LayerFrame& {
    return *std::find_if(sink.layers.begin(), sink.layers.end(),
                         [&](const auto& f) { return f.layer == layer && f.frame == frame; });
  };
  std::vector<RecordedInterface> all;
  for (const observe::InterfaceFrame& f : sink.interfaces) {
    const auto k = std::find(sink.header.interfaces.begin(), sink.header.interfaces.end(), f.interface) -
                   sink.header.interfaces.begin();
    const observe::LayerMesh& mesh = sink.mesh_of(f.nodes_of);
    RecordedInterface r{.name = f.interface,
                        .nodes_of = f.nodes_of,
                        .other = sink.header.interface_others.at(static_cast<std::size_t>(k)),
                        .frame = f.frame,
                        .step = f.step};
    mechanics::TriangleMesh flat;
    flat.reference = mesh.reference;
    flat.triangles = mesh.triangles;
    r.reference_area = mechanics::compute_tributary_areas(flat);
    r.pressure = take(f.fields, "pressure").row(0).transpose();
    r.true_pressure = take(f.fields, "true_pressure").row(0).transpose();
    r.slip = take(f.fields, "slip").row(0).transpose();
    r.friction_work = take(f.fields, "friction_work").row(0).transpose();
    r.state = take(f.fields, "state").row(0).transpose();
    r.area = take(f.fields, "area").row(0).transpose();
    r.traction = take(f.fields, "tangential_traction");
    r.true_traction = take(f.fields, "true_traction");
    r.force = take(f.fields, "force");
    r.normal = take(f.fields, "normal");
    r.position = find_layer(f.nodes_of, f.frame).position;
    if (f.fields_on_other.empty()) {
      const auto tool = std::find_if(sink.tools.begin(), sink.tools.end(),
                                     [&](const auto& t) { return t.tool == r.other && t.frame == f.frame; });
      r.other_force = Eigen::Map<const Eigen::Array3d>(tool->force);
      r.tool_moment = Eigen::Map<const Vector3>(tool->moment);
    } else {
      r.other_force = take(f.fields_on_other, "force_on_other");
      r.other_position = find_layer(r.other, f.frame).position;
    }
    all.push_back(std::move(r));
  }
  return all;
}

}  // namespace interply::test
