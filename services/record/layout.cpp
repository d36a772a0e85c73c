#include "record/layout.hpp"

#include <algorithm>
#include <cctype>

#include "record/history.hpp"
#include "record/xdmf.hpp"

namespace interply::record {
namespace {

constexpr std::uint64_t kNumber = 8;     ///< bytes of a double, and of an int64
constexpr std::uint64_t kCorner = 4;     ///< bytes of an int
constexpr std::uint64_t kDataset = 700;  ///< bytes of a dataset without its values: names, unit, description, place

/// Adds up datasets.
struct Sum {
  std::uint64_t bytes = 0;
  void add(std::uint64_t values, std::uint64_t size = kNumber) { bytes += values * size + kDataset; }
};

void add_fields(const std::map<std::string, std::vector<FieldShape>>& fields_of, std::uint64_t frames, Sum& sum) {
  for (const auto& [owner, fields] : fields_of)
    for (const FieldShape& f : fields) sum.add(frames * f.points * static_cast<std::uint64_t>(f.components));
}

void add_surface(const mechanics::NodalVectors& nodes, const mechanics::Triangles& triangles, Sum& sum) {
  sum.add(static_cast<std::uint64_t>(nodes.size()));
  sum.add(static_cast<std::uint64_t>(triangles.size()), kCorner);
}

void add_history(const observe::RunHeader& header, Sum& sum) {
  const auto rows = static_cast<std::uint64_t>(std::max(header.history_capacity, 0));
  sum.add(rows);  // step
  for (std::size_t i = 0; i < scalar_columns().size(); ++i) sum.add(rows);
  for (const ListColumn& c : list_columns())
    sum.add(rows * (c.per_interface ? header.interfaces.size() : header.layers.size()));
}

}  // namespace

std::string to_path_name(const std::string& name) {
  std::string out = name;
  for (char& c : out) {
    const bool kept = std::isalnum(static_cast<unsigned char>(c)) || std::string("._-|+").find(c) != std::string::npos;
    if (!kept) c = '_';
  }
  return out == "." || out == ".." ? "_" : out;
}

std::vector<FieldShape> shapes_of(const std::vector<observe::Field>& fields) {
  std::vector<FieldShape> shapes;
  for (const observe::Field& f : fields) {
    shapes.push_back({f.name, f.unit, f.description, f.nodal, f.components,
                      f.values.size() / static_cast<std::size_t>(std::max(f.components, 1))});
  }
  return shapes;
}

std::uint64_t measure_record(const Layout& layout) {
  const observe::RunHeader& header = layout.header;
  const auto frames = static_cast<std::uint64_t>(std::max(header.frames, 0)) + 1;
  Sum sum{header.scene_text.size()};
  sum.add(frames);  // time
  sum.add(frames);  // step
  for (const auto& [layer, mesh] : layout.meshes) {
    add_surface(mesh.reference, mesh.triangles, sum);
    if (layout.layer_fields.contains(layer)) sum.add(frames * static_cast<std::uint64_t>(mesh.reference.size()));
  }
  for (const auto* fields_of : {&layout.layer_fields, &layout.interface_fields, &layout.other_fields})
    add_fields(*fields_of, frames, sum);
  for (const observe::ToolSurface& surface : header.tool_surfaces) {
    add_surface(surface.nodes, surface.triangles, sum);
    for (const std::uint64_t values : {1, 3, 3}) sum.add(frames * values);  // position, force, moment
  }
  add_history(header, sum);
  return sum.bytes + Sidecar::measure("record.h5", layout);
}

}  // namespace interply::record
