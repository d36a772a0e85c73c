/// A small made-up run whose every value is a formula of (owner, field, frame, component, point), so that tests in C++
/// and Python (check_record.py) know what must be where.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "observe/frames.hpp"
#include "paths.hpp"

namespace interply::test {

/// Numbers 0 and 1 are the layers, 10 and 11 the interfaces, 20 the tool.
inline double sample_value(int owner, int field, int frame, int component, int point) {
  return owner * 1e6 + field * 1e5 + frame * 1e3 + component * 100.0 + point * 0.5;
}

class SampleRun {
 public:
  /// nodes: along each side of the square blanks
  explicit SampleRun(int frames = 3, int nodes = 5, int history = 6) {
    header_.run = "sample";
    header_.scene_text = "name: sample\nlayers: [ply_1, sheet]\n";
    header_.version = "0.1.0";
    header_.scene_digest = "0123456789abcdef";
    header_.layers = {"ply_1", "sheet"};
    header_.interfaces = {"ply_1|sheet", "die|ply_1"};
    header_.tools = {"punch"};
    header_.interface_nodes_of = {"ply_1", "ply_1"};
    header_.interface_others = {"sheet", "die"};
    header_.tool_surfaces = {make_wedge()};
    header_.frames = frames;
    header_.history_capacity = history;
    meshes_ = {make_mesh("ply_1", "fabric", 1.2, nodes, 0.0), make_mesh("sheet", "metal", 1.0, nodes + 1, 1.1)};
  }

  const observe::RunHeader& header() const { return header_; }
  const observe::LayerMesh& mesh(int layer) const { return meshes_[layer]; }

  observe::LayerFrame layer_frame(int layer, int k) const {
    const observe::LayerMesh& mesh = meshes_[layer];
    observe::LayerFrame f{
        .layer = mesh.layer, .frame = k, .step = 100 * k, .time = 0.5 * k, .position = mesh.reference, .fields = {}};
    f.position.row(0) += 0.001 * k;
    f.position.row(2) -= k;
    f.fields = {make_field("stress", "MPa", layer, 0, k, mesh.triangles.cols(), 3, false),
                make_field("thickness", "mm", layer, 1, k, mesh.triangles.cols(), 1, false),
                make_field("fibre & <pair>", "-", layer, 2, k, mesh.triangles.cols(), 2, false),
                make_field("velocity", "mm/s", layer, 3, k, mesh.reference.cols(), 3, true)};
    return f;
  }
  observe::InterfaceFrame interface_frame(int i, int k) const {
    const auto n = meshes_[0].reference.cols();
    return {.interface = header_.interfaces[i],
            .nodes_of = "ply_1",
            .frame = k,
            .step = 100 * k,
            .time = 0.5 * k,
            .fields = {make_field("pressure", "MPa", 10 + i, 0, k, n, 1, true),
                       make_field("tangential_traction", "MPa", 10 + i, 1, k, n, 3, true)},
            .fields_on_other = i == 1 ? std::vector<observe::Field>()
                                      : std::vector{make_field("force_on_other", "N", 10 + i, 2, k,
                                                               meshes_[1].reference.cols(), 3, true)}};
  }
  observe::ToolFrame tool_frame(int k) const {
    observe::ToolFrame f{.tool = "punch", .frame = k, .step = 100 * k, .time = 0.5 * k};
    f.position = 7.5 - 3.25 * k;
    for (int c = 0; c < 3; ++c) f.force[c] = sample_value(20, 1, k, c, 0);
    for (int c = 0; c < 3; ++c) f.moment[c] = sample_value(20, 2, k, c, 0);
    return f;
  }
  observe::HistoryRow history_row(int i) const {
    observe::HistoryRow r;
    r.step = 10 * i;
    r.time = 0.05 * i;
    r.dt = 1e-7 * (i + 1);
    r.stroke = 2.0 * i;
    r.contact_vote = 3.0 * i;
    r.residual = 1e-3 * i;
    r.layer_kinetic = {1.0 * i, 2.0 * i};
    r.layer_internal = {3.0 * i, 4.0 * i};
    r.layer_residual = {5.0 * i, 6.0 * i};
    r.votes = {7.0 * i, 8.0 * i};
    r.step_seconds = {9.0 * i, 10.0 * i};
    r.wait_seconds = {11.0 * i, 12.0 * i};
    r.interface_residual = {13.0 * i, 14.0 * i};
    r.interface_friction = {15.0 * i, 16.0 * i};
    return r;
  }
  observe::RunEnd end(int frames_complete) const {
    return {.status = "done", .message = "All is well.", .digest = "feedbeef", .frames_complete = frames_complete};
  }

  void put_start(observe::Sink& sink) const {
    sink.put(header_);
    for (const auto& mesh : meshes_) sink.put(mesh);
  }
  void put_frame(observe::Sink& sink, int k) const {
    for (int layer = 0; layer < 2; ++layer) sink.put(layer_frame(layer, k));
    for (int i = 0; i < 2; ++i) sink.put(interface_frame(i, k));
    sink.put(tool_frame(k));
  }

  static observe::Field make_field(const std::string& name, const std::string& unit, int owner, int field, int frame,
                                   Eigen::Index points, int components, bool nodal) {
    observe::Field f{.name = name,
                     .unit = unit,
                     .description = "made-up " + name,
                     .nodal = nodal,
                     .values = {},
                     .components = components};
    for (int c = 0; c < components; ++c) {
      for (int p = 0; p < points; ++p) f.values.push_back(sample_value(owner, field, frame, c, p));
    }
    return f;
  }

  /// The tool: two triangles.
  static observe::ToolSurface make_wedge() {
    observe::ToolSurface wedge{mechanics::NodalVectors(3, 4), mechanics::Triangles(3, 2)};
    wedge.nodes << 0, 20, 20, 0, 0, 0, 30, 30, 5, 0, 0, 5;
    wedge.triangles << 0, 0, 1, 2, 2, 3;
    return wedge;
  }

 private:
  static observe::LayerMesh make_mesh(const std::string& name, const std::string& kind, double thickness, int n,
                                      double z) {
    observe::LayerMesh mesh{name, kind, thickness, mechanics::NodalVectors(3, n * n),
                            mechanics::Triangles(3, 2 * (n - 1) * (n - 1))};
    for (int i = 0; i < n * n; ++i) mesh.reference.col(i) << 10.0 * (i % n), 10.0 * (i / n), z;
    int e = 0;
    for (int j = 0; j + 1 < n; ++j) {
      for (int i = 0; i + 1 < n; ++i) {
        const int a = j * n + i;
        mesh.triangles.col(e++) << a, a + 1, a + n;
        mesh.triangles.col(e++) << a + 1, a + n + 1, a + n;
      }
    }
    return mesh;
  }

  observe::RunHeader header_;
  std::vector<observe::LayerMesh> meshes_;
};

/// An empty folder of its own, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "interply_record_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Runs `check_record.py` of this folder. @return its exit status, 0 if the record is as it must be
inline int run_check(const std::string& arguments) {
  const int status =
      std::system(("/usr/bin/python3 " INTERPLY_SOURCE_DIR "/tests/record/check_record.py " + arguments).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace interply::test
