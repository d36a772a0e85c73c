#include "record/xdmf.hpp"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <limits>
#include <system_error>

namespace interply::record {
namespace {

/// Fit for text and attributes, and for a comment around them: no two hyphens.
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
      case '-':
        out += out.ends_with('-') ? "&#45;" : "-";
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
/// The instruction is for VTK 9: its reader takes the first child's text as the identity of a geometry and would show
/// one frame's mesh for all frames if that were blank space.
std::string make_slab(const Source& source, const std::string& path, int frame, std::size_t points, int components,
                      const std::string& instruction = "") {
  const bool flat = components == 1;
  const std::string tail = flat ? "" : fmt::format(" {}", components);
  return fmt::format(
      R"(<DataItem ItemType="HyperSlab" Dimensions="{points}{tail}">{instruction}<DataItem Dimensions="3 {rank}" )"
      R"(Format="XML">{frame} {zeros} {ones} 1 {points}{tail}</DataItem><DataItem Format="HDF" NumberType="Float" )"
      R"(Precision="8" Dimensions="{frames} {points}{tail}">{record}:/{path}</DataItem></DataItem>)",
      fmt::arg("points", points), fmt::arg("tail", tail), fmt::arg("instruction", instruction),
      fmt::arg("rank", flat ? 2 : 3), fmt::arg("frame", frame), fmt::arg("zeros", flat ? "0" : "0 0"), fmt::arg("ones", flat ? "1 1" : "1 1 1"),
      fmt::arg("frames", source.frames), fmt::arg("record", escape(source.record)), fmt::arg("path", escape(path)));
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
  const std::string identity = fmt::format("<?interply {} {}?>", escape(to_path_name(grid.group)), frame);
  std::string text = fmt::format(
      "<Grid Name=\"{0} {1}\" GridType=\"Uniform\"><Time Value=\"{2}\"/>\n"
      "<Topology TopologyType=\"Triangle\" NumberOfElements=\"{3}\"><DataItem Format=\"HDF\" NumberType=\"Int\" "
      "Precision=\"4\" Dimensions=\"{3} 3\">{4}:/{5}/triangles</DataItem></Topology>\n"
      "<Geometry GeometryType=\"XYZ\">{6}</Geometry>\n",
      escape(grid.name), frame, time, grid.mesh->triangles.cols(), escape(source.record), escape(layer),
      make_slab(source, layer + "/position", frame, n_nodes, 3, identity));
  for (const FieldShape& f : *grid.fields) text += make_attribute(source, grid.group, frame, f);
  return text + "</Grid>\n";
}

/// The surface of a tool, which moves along z.
struct ToolSource {
  std::string name;
  const observe::ToolSurface* surface;
};

constexpr double kFar = 1e6;  ///< mm, where no tool goes

/// Coordinate `axis` of the nodes of a tool's surface.
std::string make_coordinate(const Source& source, const std::string& group, std::size_t n_nodes, int axis,
                            const std::string& instruction = "") {
  return fmt::format(
      R"(<DataItem ItemType="HyperSlab" Dimensions="{0}">{1}<DataItem Dimensions="3 2" Format="XML">0 {2} 1 1 {0} 1)"
      R"(</DataItem><DataItem Format="HDF" NumberType="Float" Precision="8" Dimensions="{0} 3">{3}:/{4}/nodes</DataItem>)"
      "</DataItem>",
      n_nodes, instruction, axis, escape(source.record), escape(group));
}

/// @param z  of the reference point, mm. It is part of the text: VTK 9 adds numbers to arrays, but no part of one array
///           to another
std::string make_instant(const Source& source, const ToolSource& tool, int frame, double time, double z) {
  const std::string group = "tools/" + to_path_name(tool.name) + "/surface";
  const auto n = static_cast<std::size_t>(tool.surface->nodes.cols());
  const std::string identity = fmt::format("<?interply {} {}?>", escape(group), frame);
  return fmt::format(
      "<Grid Name=\"{0} {1}\" GridType=\"Uniform\"><Time Value=\"{2}\"/>\n"
      "<Topology TopologyType=\"Triangle\" NumberOfElements=\"{3}\"><DataItem Format=\"HDF\" NumberType=\"Int\" "
      "Precision=\"4\" Dimensions=\"{3} 3\">{4}:/{5}/triangles</DataItem></Topology>\n"
      "<Geometry GeometryType=\"X_Y_Z\">{6}{7}<DataItem ItemType=\"Function\" Function=\"$0 {8} {9:.9f}\" "
      "Dimensions=\"{10}\">{11}</DataItem></Geometry>\n</Grid>\n",
      escape(tool.name), frame, time, tool.surface->triangles.cols(), escape(source.record), escape(group),
      make_coordinate(source, group, n, 0, identity), make_coordinate(source, group, n, 1), z < 0 ? '-' : '+',
      std::min(std::abs(z), kFar), n, make_coordinate(source, group, n, 2));
}

std::vector<ToolSource> list_tools(const Layout& layout) {
  std::vector<ToolSource> tools;
  for (std::size_t i = 0; i < layout.header.tools.size(); ++i)
    tools.push_back({layout.header.tools[i], &layout.header.tool_surfaces.at(i)});
  return tools;
}

/// None if the run ended before everyone's first frame.
std::vector<GridSource> list_grids(const Layout& layout) {
  std::vector<GridSource> grids;
  if (layout.layer_fields.size() < layout.header.layers.size() ||
      layout.interface_fields.size() < layout.header.interfaces.size())
    return grids;
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

constexpr std::string_view kHide = "<!--", kHideEnd = "-->";

/// The opening of the comment around a place must not cross a page, so that it disappears at once.
constexpr std::size_t kAlignment = 64;

std::string fill_up(std::string text) {
  text.resize((text.size() + kAlignment - 1) / kAlignment * kAlignment, ' ');
  text.back() = '\n';
  return text;
}

/// Room for any frame of a grid. @param z  longest of a tool
template <typename Grid, typename... Z>
std::size_t measure_place(const Source& source, const Grid& grid, Z... z) {
  const double longest_time = -std::numeric_limits<double>::min() * (1 + 1e-15);
  const std::string longest = make_instant(source, grid, static_cast<int>(source.frames) - 1, longest_time, z...);
  return fill_up(std::string(kHide) + longest + std::string(kHideEnd) + '\n').size();
}

std::string make_empty_place(std::size_t size) {
  std::string place(size, ' ');
  place.replace(0, kHide.size(), kHide);
  place.replace(size - 1 - kHideEnd.size(), kHideEnd.size(), kHideEnd);
  place.back() = '\n';
  return place;
}

[[noreturn]] void fail(const std::filesystem::path& path) {
  throw std::system_error(errno, std::generic_category(), fmt::format("cannot write {}", path.string()));
}

}  // namespace

std::uint64_t Sidecar::measure(const std::string& record, const Layout& layout) {
  constexpr std::uint64_t kCollection = 200;  // beginning and end of one
  const Source source{record, static_cast<std::size_t>(layout.header.frames) + 1};
  const std::vector<GridSource> grids = list_grids(layout);
  std::uint64_t size = kCollection;
  for (const GridSource& grid : grids) size += kCollection + source.frames * measure_place(source, grid);
  if (!grids.empty())
    for (const ToolSource& tool : list_tools(layout))
      size += kCollection + source.frames * measure_place(source, tool, -kFar);
  return size;
}

Sidecar::Sidecar(const std::filesystem::path& path, const std::string& record, const Layout& layout)
    : path_(path), record_(record), layout_(layout) {
  const std::filesystem::path partial = path.string() + ".partial";
  const Source source{record, static_cast<std::size_t>(layout.header.frames) + 1};
  std::ofstream file(partial, std::ios::trunc);
  std::size_t size = 0;
  const auto add = [&](const std::string& text) {
    file << text;
    size += text.size();
  };
  add("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n");
  const auto add_collection = [&](const std::string& name, std::size_t size_of_place) {
    const std::string begin =
        fmt::format("<Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n", escape(name));
    add(std::string((kAlignment - (size + begin.size()) % kAlignment) % kAlignment, '\n') + begin);
    places_.push_back({size, size_of_place});
    const std::string place = make_empty_place(size_of_place);
    for (std::size_t k = 0; k < source.frames; ++k) add(place);
    add("</Grid>\n");
  };
  const std::vector<GridSource> grids = list_grids(layout);
  for (const GridSource& grid : grids) add_collection(grid.name, measure_place(source, grid));
  if (!grids.empty())
    for (const ToolSource& tool : list_tools(layout)) add_collection(tool.name, measure_place(source, tool, -kFar));
  add("</Domain>\n</Xdmf>\n");
  file.close();
  if (!file) {
    const int error = errno;
    std::filesystem::remove(partial);
    errno = error;
    fail(path);
  }
  std::filesystem::rename(partial, path);
  file_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file_ < 0) fail(path);
}

Sidecar::~Sidecar() {
  if (file_ >= 0) ::close(file_);
}

void Sidecar::show(int frame, double time, const std::map<std::string, double>& tool_positions) {
  const Source source{record_, static_cast<std::size_t>(layout_.header.frames) + 1};
  std::vector<std::string> texts;
  for (const GridSource& grid : list_grids(layout_)) texts.push_back(make_instant(source, grid, frame, time));
  for (const ToolSource& tool : list_tools(layout_))
    texts.push_back(make_instant(source, tool, frame, time, tool_positions.at(tool.name)));
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const std::size_t at = places_[i].begin + places_[i].size * static_cast<std::size_t>(frame);
    write(texts[i], at + kHide.size());
    write(std::string(kHide.size(), ' '), at);  // what is left of the comment is text: -->
    write(std::string(kHideEnd.size(), ' '), at + places_[i].size - 1 - kHideEnd.size());
  }
}

void Sidecar::write(const std::string& text, std::size_t offset) const {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::pwrite(file_, text.data() + done, text.size() - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno != EINTR) fail(path_);
    done += n > 0 ? static_cast<std::size_t>(n) : 0;
  }
}

}  // namespace interply::record
