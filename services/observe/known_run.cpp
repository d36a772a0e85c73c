#include "observe/known_run.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <stdexcept>

namespace interply::observe {
namespace {

constexpr std::size_t kMostNames = 1000;  ///< layers, interfaces, tools; fields of a frame
constexpr int kMostFrames = 100'000;      ///< as a scene may ask for
constexpr int kMostRows = 10'000'000;     ///< as a scene may ask for

/// @throws std::runtime_error of the text unless `condition`
template <typename... Values>
void require(bool condition, fmt::format_string<Values...> text, Values&&... values) {
  if (!condition) throw std::runtime_error(fmt::format(text, std::forward<Values>(values)...));
}

std::size_t index_of(const std::vector<std::string>& names, const std::string& name, const char* what) {
  const auto found = std::find(names.begin(), names.end(), name);
  require(found != names.end(), "the run has no {} '{}'", what, name);
  return static_cast<std::size_t>(found - names.begin());
}

void require_distinct(std::vector<std::string> names, const char* what) {
  std::sort(names.begin(), names.end());
  require(names.size() <= kMostNames && std::adjacent_find(names.begin(), names.end()) == names.end(),
          "a header with {} {} of which some are too many or the same", names.size(), what);
}

}  // namespace

void KnownRun::check_run(const std::string& run) const {
  require(run == run_, "it is of run '{}', this one is '{}'", run, run_);
}

void KnownRun::check_coordinator(const std::string& run, const Sender& sender) const {
  check_run(run);
  require(has_header() && sender == coordinator_, "it comes from another participant than the run's header");
}

void KnownRun::check_frame(int frame) const {
  require(frame >= 0 && frame <= header_.frames, "frame {} is not in [0, {}]", frame, header_.frames);
}

const KnownRun::Mesh& KnownRun::find_mesh(const std::string& layer) const {
  const auto found = meshes_.find(layer);
  require(found != meshes_.end(), "no mesh of layer '{}' is known", layer);
  return found->second;
}

void KnownRun::check_fields(const std::vector<Field>& fields, const Mesh& mesh) const {
  require(fields.size() <= kMostNames, "{} fields are too many", fields.size());
  for (const Field& f : fields) {
    const auto points = static_cast<std::size_t>(f.nodal ? mesh.nodes : mesh.elements);
    require(f.values.size() == points * static_cast<std::size_t>(f.components),
            "field '{}' has {} values for {} {} of {} components", f.name, f.values.size(), points,
            f.nodal ? "nodes" : "elements", f.components);
  }
}

void KnownRun::admit(const RunHeader& a, const std::string& run, const Sender& sender) {
  check_run(run);
  require(sender != Sender{}, "its sender is not known any more");
  require(!has_header() || sender == coordinator_, "another participant has sent the run's header already");
  require(!a.layers.empty(), "a header without layers");
  require_distinct(a.layers, "layers");
  require_distinct(a.interfaces, "interfaces");
  require_distinct(a.tools, "tools");
  require(a.interface_nodes_of.size() == a.interfaces.size(), "a header with {} interfaces on the nodes of {} layers",
          a.interfaces.size(), a.interface_nodes_of.size());
  require(a.nodes.size() == a.elements.size() && (a.nodes.empty() || a.nodes.size() == a.layers.size()),
          "a header with {} layers and sizes of {} and {} meshes", a.layers.size(), a.nodes.size(), a.elements.size());
  for (const std::string& layer : a.interface_nodes_of) index_of(a.layers, layer, "layer");
  require(a.interface_others.size() == a.interfaces.size() && a.tool_surfaces.size() == a.tools.size(),
          "a header with {} interfaces of {} others and {} tools of {} surfaces", a.interfaces.size(),
          a.interface_others.size(), a.tools.size(), a.tool_surfaces.size());
  require(a.frames >= 0 && a.frames <= kMostFrames, "a header of {} frames", a.frames);
  require(a.history_capacity >= 0 && a.history_capacity <= kMostRows, "a header of {} history rows",
          a.history_capacity);
  require(!has_header() || (a.layers == header_.layers && a.interfaces == header_.interfaces &&
                            a.tools == header_.tools && a.nodes == header_.nodes && a.elements == header_.elements &&
                            a.frames == header_.frames),
          "a second header that says something else");
  header_ = a;
  header_.scene_text.clear();
  header_.tool_surfaces.clear();
  coordinator_ = sender;
}

void KnownRun::admit(const LayerMesh& a, const std::string& run, const Sender& sender) {
  check_run(run);
  require(sender != Sender{}, "its sender is not known any more");
  const std::size_t i = index_of(header_.layers, a.layer, "layer");
  const Mesh mesh{sender, a.reference.cols(), a.triangles.cols()};
  require(header_.nodes.empty() || (header_.nodes[i] == mesh.nodes && header_.elements[i] == mesh.elements),
          "a mesh of {} nodes and {} elements, which layer '{}' has not", mesh.nodes, mesh.elements, a.layer);
  const auto known = meshes_.find(a.layer);
  require(known == meshes_.end() || (known->second.sender == sender && known->second.nodes == mesh.nodes &&
                                     known->second.elements == mesh.elements),
          "a second mesh of layer '{}'", a.layer);
  require(a.triangles.size() == 0 || (a.triangles.minCoeff() >= 0 && a.triangles.maxCoeff() < mesh.nodes),
          "the mesh of layer '{}' has triangles of nodes that it has not", a.layer);
  meshes_.insert_or_assign(a.layer, mesh);
}

void KnownRun::admit(const LayerFrame& a, const std::string& run, const Sender& sender) const {
  check_run(run);
  const Mesh& mesh = find_mesh(a.layer);
  require(sender == mesh.sender, "it comes from another participant than the mesh of layer '{}'", a.layer);
  check_frame(a.frame);
  require(a.position.cols() == mesh.nodes, "layer '{}' has {} nodes, not {}", a.layer, mesh.nodes, a.position.cols());
  check_fields(a.fields, mesh);
}

void KnownRun::admit(const InterfaceFrame& a, const std::string& run, const Sender& sender) const {
  check_coordinator(run, sender);
  const std::size_t i = index_of(header_.interfaces, a.interface, "interface");
  require(a.nodes_of == header_.interface_nodes_of[i], "interface '{}' is on the nodes of layer '{}', not '{}'",
          a.interface, header_.interface_nodes_of[i], a.nodes_of);
  check_frame(a.frame);
  check_fields(a.fields, find_mesh(a.nodes_of));
  if (!a.fields_on_other.empty()) check_fields(a.fields_on_other, find_mesh(header_.interface_others[i]));
}

void KnownRun::admit(const ToolFrame& a, const std::string& run, const Sender& sender) const {
  check_coordinator(run, sender);
  index_of(header_.tools, a.tool, "tool");
  check_frame(a.frame);
}

void KnownRun::admit(const HistoryRow& a, const std::string& run, const Sender& sender) const {
  check_coordinator(run, sender);
  const std::size_t layers = header_.layers.size(), interfaces = header_.interfaces.size();
  for (const auto* list :
       {&a.layer_kinetic, &a.layer_internal, &a.layer_residual, &a.votes, &a.step_seconds, &a.wait_seconds}) {
    require(list->empty() || list->size() == layers, "a history row of {} layers, not {}", list->size(), layers);
  }
  for (const auto* list : {&a.interface_residual, &a.interface_friction})
    require(list->empty() || list->size() == interfaces, "a history row of {} interfaces, not {}", list->size(),
            interfaces);
}

void KnownRun::admit(const RunEnd& a, const std::string& run, const Sender& sender) const {
  check_coordinator(run, sender);
  require(a.frames_complete >= 0 && a.frames_complete <= header_.frames + 1, "{} complete frames of {}",
          a.frames_complete, header_.frames + 1);
}

}  // namespace interply::observe
