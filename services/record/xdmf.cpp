#include "record/xdmf.hpp"

#include <spdlog/fmt/fmt.h>

#include <fstream>
#include <stdexcept>

namespace interply::record {
namespace {

std::string escape(const std::string& s) {
  std::string out;
  for (const char c : s) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

/// What all grids of one file share.
struct Source {
  std::string record;
  std::size_t frames;  ///< extent of the datasets
};

/// Frame `frame` of a dataset [frames, points] or [frames, points, components].
std::string make_slab(const Source& source, const std::string& path, int frame, std::size_t points, int components) {
  const bool flat = components == 1;
  const std::string tail = flat ? "" : fmt::format(" {}", components);
  return fmt::format(
      R"(<DataItem ItemType="HyperSlab" Dimensions="{points}{tail}"><DataItem Dimensions="3 {rank}" Format="XML">)"
      R"({frame} {zeros} {ones} 1 {points}{tail}</DataItem><DataItem Format="HDF" NumberType="Float" Precision="8" )"
      R"(Dimensions="{frames} {points}{tail}">{record}:/{path}</DataItem></DataItem>)",
      fmt::arg("points", points), fmt::arg("tail", tail), fmt::arg("rank", flat ? 2 : 3), fmt::arg("frame", frame),
      fmt::arg("zeros", flat ? "0" : "0 0"), fmt::arg("ones", flat ? "1 1" : "1 1 1"),
      fmt::arg("frames", source.frames), fmt::arg("record", escape(source.record)), fmt::arg("path", path));
}

std::string name_type(int components) {
  switch (components) {
    case 1:
      return "Scalar";
    case 3:
      return "Vector";
    case 6:
      return "Tensor6";
    case 9:
      return "Tensor";
    default:
      return "Matrix";
  }
}

std::string make_attribute(const Source& source, const std::string& group, int frame, const FieldShape& f) {
  return fmt::format("<Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">{}</Attribute>\n", escape(f.name),
                     name_type(f.components), f.nodal ? "Node" : "Cell",
                     make_slab(source, group + "/" + to_path_name(f.name), frame, f.points, f.components));
}

/// Fields of `group` on the deformed mesh of a layer.
std::string make_grid(const Source& source, const std::string& name, const std::string& group, int frame,
                      const observe::LayerMesh& mesh, const std::vector<FieldShape>& fields) {
  const std::string layer = "layers/" + to_path_name(mesh.layer);
  std::string grid = fmt::format(
      "<Grid Name=\"{}\" GridType=\"Uniform\">\n"
      "<Topology TopologyType=\"Triangle\" NumberOfElements=\"{}\"><DataItem Format=\"HDF\" NumberType=\"Int\" "
      "Precision=\"4\" Dimensions=\"{} 3\">{}:/{}/triangles</DataItem></Topology>\n"
      "<Geometry GeometryType=\"XYZ\">{}</Geometry>\n",
      escape(name), mesh.triangles.cols(), mesh.triangles.cols(), escape(source.record), layer,
      make_slab(source, layer + "/position", frame, static_cast<std::size_t>(mesh.reference.cols()), 3));
  for (const FieldShape& f : fields) grid += make_attribute(source, group, frame, f);
  return grid + "</Grid>\n";
}

std::string make_time(const Source& source, const Layout& layout, int frame, double time) {
  std::string text =
      fmt::format("<Grid Name=\"frame {}\" GridType=\"Collection\" CollectionType=\"Spatial\">\n<Time Value=\"{}\"/>\n",
                  frame, time);
  for (const std::string& layer : layout.header.layers) {
    text += make_grid(source, layer, "layers/" + to_path_name(layer), frame, layout.meshes.at(layer),
                      layout.layer_fields.at(layer));
  }
  for (std::size_t i = 0; i < layout.header.interfaces.size(); ++i) {
    const std::string& name = layout.header.interfaces[i];
    text += make_grid(source, name, "interfaces/" + to_path_name(name), frame,
                      layout.meshes.at(layout.header.interface_nodes_of.at(i)), layout.interface_fields.at(name));
  }
  return text + "</Grid>\n";
}

}  // namespace

std::string make_xdmf(const std::string& record, const Layout& layout, const std::vector<double>& times) {
  const Source source{record, static_cast<std::size_t>(layout.header.frames) + 1};
  std::string text =
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n"
      "<Grid Name=\"run\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (std::size_t k = 0; k < times.size(); ++k) text += make_time(source, layout, static_cast<int>(k), times[k]);
  return text + "</Grid>\n</Domain>\n</Xdmf>\n";
}

void write_xdmf(const std::filesystem::path& path, const std::string& record, const Layout& layout,
                const std::vector<double>& times) {
  const std::filesystem::path partial = path.string() + ".partial";
  std::ofstream file(partial, std::ios::trunc);
  file << make_xdmf(record, layout, times);
  file.close();
  if (!file) throw std::runtime_error(fmt::format("cannot write {}", partial.string()));
  std::filesystem::rename(partial, path);
}

}  // namespace interply::record
