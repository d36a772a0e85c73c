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
/// The comment is for VTK 9: its reader takes the first child's text as the identity of a geometry and would show one
/// frame's mesh for all frames if that were blank space.
std::string make_slab(const Source& source, const std::string& path, int frame, std::size_t points, int components,
                      const std::string& comment = "") {
  const bool flat = components == 1;
  const std::string tail = flat ? "" : fmt::format(" {}", components);
  return fmt::format(
      R"(<DataItem ItemType="HyperSlab" Dimensions="{points}{tail}">{comment}<DataItem Dimensions="3 {rank}" )"
      R"(Format="XML">{frame} {zeros} {ones} 1 {points}{tail}</DataItem><DataItem Format="HDF" NumberType="Float" )"
      R"(Precision="8" Dimensions="{frames} {points}{tail}">{record}:/{path}</DataItem></DataItem>)",
      fmt::arg("points", points), fmt::arg("tail", tail), fmt::arg("comment", comment), fmt::arg("rank", flat ? 2 : 3),
      fmt::arg("frame", frame), fmt::arg("zeros", flat ? "0" : "0 0"), fmt::arg("ones", flat ? "1 1" : "1 1 1"),
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

/// A grid through time: fields of `group` on the deformed mesh of a layer.
struct GridSource {
  std::string name, group;
  const observe::LayerMesh* mesh;
  const std::vector<FieldShape>* fields;
};

std::string make_instant(const Source& source, const GridSource& grid, int frame, double time) {
  const std::string layer = "layers/" + to_path_name(grid.mesh->layer);
  const auto n_nodes = static_cast<std::size_t>(grid.mesh->reference.cols());
  const std::string identity = fmt::format("<!-- {} {} -->", to_path_name(grid.group), frame);
  std::string text = fmt::format(
      "<Grid Name=\"{0} {1}\" GridType=\"Uniform\"><Time Value=\"{2}\"/>\n"
      "<Topology TopologyType=\"Triangle\" NumberOfElements=\"{3}\"><DataItem Format=\"HDF\" NumberType=\"Int\" "
      "Precision=\"4\" Dimensions=\"{3} 3\">{4}:/{5}/triangles</DataItem></Topology>\n"
      "<Geometry GeometryType=\"XYZ\">{6}</Geometry>\n",
      escape(grid.name), frame, time, grid.mesh->triangles.cols(), escape(source.record), layer,
      make_slab(source, layer + "/position", frame, n_nodes, 3, identity));
  for (const FieldShape& f : *grid.fields) text += make_attribute(source, grid.group, frame, f);
  return text + "</Grid>\n";
}

std::vector<GridSource> list_grids(const Layout& layout) {
  std::vector<GridSource> grids;
  for (const std::string& layer : layout.header.layers) {
    grids.push_back({layer, "layers/" + to_path_name(layer), &layout.meshes.at(layer), &layout.layer_fields.at(layer)});
  }
  for (std::size_t i = 0; i < layout.header.interfaces.size(); ++i) {
    const std::string& name = layout.header.interfaces[i];
    grids.push_back({name, "interfaces/" + to_path_name(name),
                     &layout.meshes.at(layout.header.interface_nodes_of.at(i)), &layout.interface_fields.at(name)});
  }
  return grids;
}

}  // namespace

std::string make_xdmf(const std::string& record, const Layout& layout, const std::vector<double>& times) {
  const Source source{record, static_cast<std::size_t>(layout.header.frames) + 1};
  std::string text = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n";
  if (!times.empty()) {
    for (const GridSource& grid : list_grids(layout)) {
      text +=
          fmt::format("<Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n", escape(grid.name));
      for (std::size_t k = 0; k < times.size(); ++k) text += make_instant(source, grid, static_cast<int>(k), times[k]);
      text += "</Grid>\n";
    }
  }
  return text + "</Domain>\n</Xdmf>\n";
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
