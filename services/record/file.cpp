#include "record/file.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <set>
#include <system_error>

#include "record/disk.hpp"
#include "record/history.hpp"

namespace interply::record {
namespace {

constexpr std::size_t kStatusLength = 32, kMessageLength = 1024, kDigestLength = 64;

std::string layer_group(const std::string& name) { return "layers/" + to_path_name(name); }
std::string interface_group(const std::string& name) { return "interfaces/" + to_path_name(name); }
std::string tool_group(const std::string& name) { return "tools/" + to_path_name(name); }

/// [components x points], point innermost -> [points x components], component innermost.
std::vector<double> put_components_last(const double* values, std::size_t components, std::size_t points) {
  std::vector<double> out(components * points);
  for (std::size_t c = 0; c < components; ++c) {
    for (std::size_t p = 0; p < points; ++p) out[p * components + c] = values[c * points + p];
  }
  return out;
}

std::vector<double> put_components_last(const mechanics::NodalVectors& a) {
  return put_components_last(a.data(), 3, static_cast<std::size_t>(a.cols()));
}

void check_names(const std::vector<std::string>& names, const char* kind) {
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (name.empty() || !seen.insert(to_path_name(name)).second) {
      throw Misfit(fmt::format("{} name '{}' cannot be recorded: it is empty or, as '{}', not unique", kind,
                                           name, to_path_name(name)));
    }
  }
}

Handle make_text(const Handle& parent, const std::string& name, const std::string& text,
                 const std::string& description) {
  Handle dataset = create_text(parent, name, text.size(), {}, description);
  write_text(dataset, {text});
  return dataset;
}

void make_list(const Handle& parent, const std::string& name, const std::vector<std::string>& texts,
               const std::string& description) {
  std::size_t length = 1;
  for (const std::string& text : texts) length = std::max(length, text.size());
  write_text(create_text(parent, name, length, {texts.size()}, description), texts);
}

void make_scene(const Handle& file, const observe::RunHeader& header) {
  const Handle scene = create_group(file, "scene");
  make_text(scene, "text", header.scene_text, "resolved scene, YAML");
  make_text(scene, "version", header.version, "version of interply");
  make_text(scene, "digest", header.scene_digest, "digest of the resolved scene");
  make_text(scene, "run", header.run, "unique name of this execution");
  make_list(scene, "layers", header.layers, "layers from bottom to top; the columns of per-layer history");
  make_list(scene, "interfaces", header.interfaces, "interfaces in order; the columns of per-interface history");
  make_list(scene, "tools", header.tools, "tools in order");
}

void make_fields(const Handle& group, hsize_t frames, const std::vector<FieldShape>& fields) {
  for (const FieldShape& f : fields) {
    Shape shape{frames, f.points};
    if (f.components > 1) shape.push_back(static_cast<hsize_t>(f.components));
    const Handle dataset = create_dataset(group, to_path_name(f.name), H5T_NATIVE_DOUBLE, shape, f.unit, f.description);
    write_attribute(dataset, "location", f.nodal ? "node" : "element");
  }
}

void make_corners(const Handle& group, const mechanics::Triangles& t, const std::string& description) {
  const Eigen::Array<int, Eigen::Dynamic, 3, Eigen::RowMajor> corners = t.transpose();
  write_all(create_dataset(group, "triangles", H5T_NATIVE_INT, {static_cast<hsize_t>(t.cols()), 3}, "-", description),
            corners.data());
}

void make_layer(const Handle& layers, hsize_t frames, const observe::LayerMesh& mesh,
                const std::vector<FieldShape>* fields) {
  const Handle group = create_group(layers, to_path_name(mesh.layer));
  const auto n_nodes = static_cast<hsize_t>(mesh.reference.cols());
  write_attribute(group, "name", mesh.layer);
  make_text(group, "kind", mesh.kind, "fabric or metal");
  write_all(create_dataset(group, "initial_thickness", H5T_NATIVE_DOUBLE, {}, "mm", "thickness before forming"),
            &mesh.thickness);
  write_all(create_dataset(group, "reference", H5T_NATIVE_DOUBLE, {n_nodes, 3}, "mm",
                           "midsurface nodes of the flat blank; [node, xyz]"),
            put_components_last(mesh.reference).data());
  make_corners(group, mesh.triangles, "node numbers, counter-clockwise seen from +z; [element, corner]");
  if (!fields) return;
  create_dataset(group, "position", H5T_NATIVE_DOUBLE, {frames, n_nodes, 3}, "mm",
                 "midsurface nodes; [frame, node, xyz]");
  make_fields(group, frames, *fields);
}

void make_tool(const Handle& tools, hsize_t frames, const std::string& tool, const observe::ToolSurface& surface) {
  const Handle group = create_group(tools, to_path_name(tool));
  write_attribute(group, "name", tool);
  create_dataset(group, "position", H5T_NATIVE_DOUBLE, {frames}, "mm", "z of the tool's reference point; [frame]");
  create_dataset(group, "force", H5T_NATIVE_DOUBLE, {frames, 3}, "N",
                 "contact force on the tool, modelled part; [frame, xyz]");
  create_dataset(group, "moment", H5T_NATIVE_DOUBLE, {frames, 3}, "N mm",
                 "moment of the contact forces on the tool about the origin; [frame, xyz]");
  const Handle triangulated = create_group(group, "surface");
  write_all(create_dataset(triangulated, "nodes", H5T_NATIVE_DOUBLE,
                           {static_cast<hsize_t>(surface.nodes.cols()), 3}, "mm",
                           "nodes of the surface relative to the reference point: add position to z; [node, xyz]"),
            put_components_last(surface.nodes).data());
  make_corners(triangulated, surface.triangles,
               "node numbers, counter-clockwise seen from outside; [triangle, corner]");
}

void make_history(const Handle& file, const observe::RunHeader& header) {
  const Handle history = create_group(file, "history");
  const auto rows = static_cast<hsize_t>(std::max(header.history_capacity, 0));
  write_scalar(create_dataset(history, "rows_complete", H5T_NATIVE_INT, {}, "-", "rows recorded so far"), 0);
  create_dataset(history, "step", H5T_NATIVE_INT64, {rows}, "-", "step; -1 beyond rows_complete");
  for (const ScalarColumn& c : scalar_columns()) {
    create_dataset(history, c.name, H5T_NATIVE_DOUBLE, {rows}, c.unit, c.description);
  }
  for (const ListColumn& c : list_columns()) {
    const std::size_t width = c.per_interface ? header.interfaces.size() : header.layers.size();
    create_dataset(history, c.name, H5T_NATIVE_DOUBLE, {rows, width}, c.unit,
                   fmt::format("{}; [row, {}]", c.description, c.per_interface ? "interface" : "layer"));
  }
}

void make_file(const Handle& file, const Layout& layout) {
  const observe::RunHeader& header = layout.header;
  const hsize_t frames = static_cast<hsize_t>(header.frames) + 1;
  make_scene(file, header);
  write_text(create_text(file, "status", kStatusLength, {}, "running, done, diverged, lost, cancelled or interrupted"),
             {"running"});
  create_text(file, "message", kMessageLength, {}, "why the run ended, one sentence");
  create_text(file, "digest", kDigestLength, {}, "digest of the final state of all layers; empty unless done");
  write_scalar(create_dataset(file, "frames_complete", H5T_NATIVE_INT, {}, "-", "frames recorded so far"), 0);
  create_dataset(file, "time", H5T_NATIVE_DOUBLE, {frames}, "s", "time of each frame");
  create_dataset(file, "step", H5T_NATIVE_INT64, {frames}, "-", "step of each frame; -1 beyond frames_complete");

  const Handle layers = create_group(file, "layers");
  for (const auto& [name, mesh] : layout.meshes) {
    const auto fields = layout.layer_fields.find(name);
    make_layer(layers, frames, mesh, fields == layout.layer_fields.end() ? nullptr : &fields->second);
  }
  const Handle interfaces = create_group(file, "interfaces");
  for (std::size_t i = 0; i < header.interfaces.size(); ++i) {
    const std::string& name = header.interfaces[i];
    const Handle group = create_group(interfaces, to_path_name(name));
    write_attribute(group, "name", name);
    make_text(group, "nodes_of", header.interface_nodes_of[i], "layer whose nodes carry the fields");
    make_text(group, "other", header.interface_others[i], "layer or tool on the other side");
    for (const auto* fields_of : {&layout.interface_fields, &layout.other_fields}) {
      const auto fields = fields_of->find(name);
      if (fields != fields_of->end()) make_fields(group, frames, fields->second);
    }
  }
  const Handle tools = create_group(file, "tools");
  for (std::size_t i = 0; i < header.tools.size(); ++i)
    make_tool(tools, frames, header.tools[i], header.tool_surfaces[i]);
  make_history(file, header);
}

bool is_in(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void check_meshes(const Layout& layout) {
  for (const auto& [layer, fields] : layout.layer_fields) check_fields(layer, layout.meshes.at(layer), fields);
  const observe::RunHeader& header = layout.header;
  for (const auto* sides : {&header.interface_nodes_of, &header.interface_others}) {
    if (sides->size() == header.interfaces.size()) continue;
    throw Misfit(fmt::format("the run's header names the sides of {} interfaces, not of {}", sides->size(),
                             header.interfaces.size()));
  }
  if (header.tool_surfaces.size() != header.tools.size()) {
    throw Misfit(fmt::format("the run's header has surfaces of {} tools, not of {}", header.tool_surfaces.size(),
                             header.tools.size()));
  }
  for (std::size_t i = 0; i < header.interfaces.size(); ++i) {
    const std::string& carrier = header.interface_nodes_of[i];
    if (!is_in(header.layers, carrier)) {
      throw Misfit(fmt::format("interface '{}' is carried by '{}', which is no layer of the run",
                                           header.interfaces[i], carrier));
    }
    const auto mesh = layout.meshes.find(carrier);
    const auto fields = layout.interface_fields.find(header.interfaces[i]);
    if (mesh != layout.meshes.end() && fields != layout.interface_fields.end()) {
      check_fields(fields->first, mesh->second, fields->second);
    }
    const auto other = layout.meshes.find(header.interface_others[i]);
    const auto on_other = layout.other_fields.find(header.interfaces[i]);
    if (on_other == layout.other_fields.end() || on_other->second.empty()) continue;
    if (other != layout.meshes.end()) {
      check_fields(on_other->first, other->second, on_other->second);
    } else if (!is_in(header.layers, header.interface_others[i])) {
      throw Misfit(fmt::format("interface '{}' has fields on '{}', which is no layer of the run", header.interfaces[i],
                               header.interface_others[i]));
    }
  }
}

void check_layout(const Layout& layout) {
  if (layout.header.frames < 0) {
    throw Misfit(fmt::format("a run cannot be recorded with {} frames to come", layout.header.frames));
  }
  check_names(layout.header.layers, "layer");
  check_names(layout.header.interfaces, "interface");
  check_names(layout.header.tools, "tool");
  check_meshes(layout);
  for (const auto* fields_of : {&layout.layer_fields, &layout.interface_fields}) {
    for (const auto& [owner, fields] : *fields_of) {
      std::vector<std::string> names = {"kind",      "initial_thickness", "reference", "triangles",
                                        "position", "nodes_of",          "other"};
      for (const FieldShape& f : fields) names.push_back(f.name);
      const auto on_other = layout.other_fields.find(owner);
      if (fields_of == &layout.interface_fields && on_other != layout.other_fields.end())
        for (const FieldShape& f : on_other->second) names.push_back(f.name);
      check_names(names, ("'" + owner + "': field").c_str());
    }
  }
}

/// Creates under a temporary name beside `path`, so that `path` never holds half a file.
Handle create_in_place(const std::filesystem::path& path, const Layout& layout) {
  check_layout(layout);
  const std::filesystem::path partial = path.string() + ".partial";
  if (const auto free = find_free_space(partial); free && *free < measure_record(layout))
    throw std::system_error(ENOSPC, std::generic_category(), "cannot create the record");
  try {
    const Handle file = create_file(partial);
    make_file(file, layout);
    flush(file);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    throw;
  }
  std::filesystem::rename(partial, path);
  return open_file(path, true);
}

std::string describe_fields(const std::string& owner, const std::vector<observe::Field>& fields,
                            const std::vector<FieldShape>& expected) {
  if (fields.size() != expected.size()) {
    return fmt::format("'{}' has {} fields where its first frame had {}", owner, fields.size(), expected.size());
  }
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const observe::Field& f = fields[i];
    const FieldShape& e = expected[i];
    if (f.name != e.name || f.components != e.components || f.values.size() != e.points * e.components) {
      return fmt::format("field '{}' of '{}' ({} values) does not fit '{}' ({} points x {}) of its first frame", f.name,
                         owner, f.values.size(), e.name, e.points, e.components);
    }
  }
  return {};
}

}  // namespace

void check_fields(const std::string& owner, const observe::LayerMesh& mesh, const std::vector<FieldShape>& fields) {
  for (const FieldShape& f : fields) {
    const Eigen::Index expected = f.nodal ? mesh.reference.cols() : mesh.triangles.cols();
    if (static_cast<Eigen::Index>(f.points) != expected) {
      throw Misfit(fmt::format("field '{}' of '{}' has {} values for {} {} of layer '{}'", f.name, owner,
                                           f.points, expected, f.nodal ? "nodes" : "elements", mesh.layer));
    }
  }
}

RecordFile::RecordFile(const std::filesystem::path& path, Layout layout)
    : layout_(std::move(layout)), file_(create_in_place(path, layout_)) {}

std::string RecordFile::describe_mismatch(const observe::LayerFrame& frame) const {
  const auto fields = layout_.layer_fields.find(frame.layer);
  if (fields == layout_.layer_fields.end()) return fmt::format("layer '{}' has no first frame", frame.layer);
  const Eigen::Index n = layout_.meshes.at(frame.layer).reference.cols();
  if (frame.position.cols() != n) {
    return fmt::format("layer '{}' has {} positions for {} nodes", frame.layer, frame.position.cols(), n);
  }
  return describe_fields(frame.layer, frame.fields, fields->second);
}

std::string RecordFile::describe_mismatch(const observe::InterfaceFrame& frame) const {
  const auto fields = layout_.interface_fields.find(frame.interface);
  if (fields == layout_.interface_fields.end()) {
    return fmt::format("interface '{}' has no first frame", frame.interface);
  }
  const std::string problem = describe_fields(frame.interface, frame.fields, fields->second);
  if (!problem.empty()) return problem;
  return describe_fields(frame.interface, frame.fields_on_other, layout_.other_fields.at(frame.interface));
}

const Handle& RecordFile::dataset(const std::string& path) {
  const auto found = datasets_.find(path);
  return found != datasets_.end() ? found->second : datasets_.emplace(path, open_dataset(file_, path)).first->second;
}

void RecordFile::write_fields(const std::string& group, int frame, const std::vector<observe::Field>& fields) {
  for (const observe::Field& f : fields) {
    const auto components = static_cast<std::size_t>(f.components);
    write_row(dataset(group + "/" + to_path_name(f.name)), frame,
              put_components_last(f.values.data(), components, f.values.size() / components));
  }
}

void RecordFile::write(const observe::LayerFrame& frame) {
  const std::string group = layer_group(frame.layer);
  write_row(dataset(group + "/position"), frame.frame, put_components_last(frame.position));
  write_fields(group, frame.frame, frame.fields);
}

void RecordFile::write(const observe::InterfaceFrame& frame) {
  write_fields(interface_group(frame.interface), frame.frame, frame.fields);
  write_fields(interface_group(frame.interface), frame.frame, frame.fields_on_other);
}

void RecordFile::write(const observe::ToolFrame& frame) {
  const std::string group = tool_group(frame.tool);
  write_row(dataset(group + "/position"), frame.frame, std::vector{frame.position});
  write_row(dataset(group + "/force"), frame.frame, {frame.force, frame.force + 3});
  write_row(dataset(group + "/moment"), frame.frame, {frame.moment, frame.moment + 3});
}

void RecordFile::write(std::span<const observe::HistoryRow> rows, int first) {
  const auto begin = static_cast<hsize_t>(first), count = static_cast<hsize_t>(rows.size());
  std::vector<std::int64_t> steps;
  for (const observe::HistoryRow& row : rows) steps.push_back(row.step);
  write_rows(dataset("history/step"), begin, count, steps);
  std::vector<double> values;
  for (const ScalarColumn& c : scalar_columns()) {
    values.clear();
    for (const observe::HistoryRow& row : rows) values.push_back(row.*c.value);
    write_rows(dataset(std::string("history/") + c.name), begin, count, values);
  }
  for (const ListColumn& c : list_columns()) {
    const std::size_t width = c.per_interface ? layout_.header.interfaces.size() : layout_.header.layers.size();
    if (width == 0) continue;
    values.clear();
    for (const observe::HistoryRow& row : rows) {
      const std::vector<double>& list = row.*c.values;
      if (list.size() == width)
        values.insert(values.end(), list.begin(), list.end());
      else
        values.insert(values.end(), width, std::numeric_limits<double>::quiet_NaN());
    }
    write_rows(dataset(std::string("history/") + c.name), begin, count, values);
  }
  write_scalar(dataset("history/rows_complete"), first + static_cast<int>(rows.size()));
}

void RecordFile::complete_frame(int frame, double time, std::int64_t step) {
  write_row(dataset("time"), frame, std::vector{time});
  write_row(dataset("step"), frame, step);
  flush(file_);
  write_scalar(dataset("frames_complete"), frame + 1);
  flush(file_);
}

void RecordFile::write_end(const std::string& status, const std::string& message, const std::string& digest) {
  write_text(dataset("message"), {message});
  write_text(dataset("digest"), {digest});
  write_text(dataset("status"), {status});
  flush(file_);
}

}  // namespace interply::record
