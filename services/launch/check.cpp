#include "launch/check.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <thread>

#include "coordinator/stack.hpp"
#include "coordinator/tool_check.hpp"
#include "launch/layer_factories.hpp"
#include "launch/run.hpp"
#include "scene/read_scene.hpp"

namespace interply::launch {
namespace {

// Measured on tetrahedron_fml_coarse:
constexpr double kBytesPerProcess = 18e6;  ///< resident before a process has a layer: libraries, carriers
constexpr double kAllWork = 2.8;           ///< work of all processes / work of the layers' elements while elastic
constexpr double kMoreSteps = 1.25;        ///< steps / steps at the initial increment

/// What a layer costs and allows, from its initial state.
struct LayerCheck {
  const scene::Layer* layer = nullptr;
  Eigen::Index n_nodes = 0, n_elements = 0;
  double mass = 0;              ///< without mass scaling, t
  double stable_increment = 0;  ///< of the layer alone, s
  double step_seconds = 0;      ///< of one thread, measured here
};

double measure_step(solve::LayerMechanics& mechanics, const mechanics::TriangleMesh& mesh) {
  mechanics::NodalVectors force(3, mesh.n_nodes());
  double fastest = INFINITY;
  for (int i = 0; i < 5; ++i) {
    const auto start = std::chrono::steady_clock::now();
    mechanics.compute_internal_forces(mesh.reference, {}, force);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    fastest = std::min(fastest, taken.count());
  }
  return fastest;
}

/// @param kept  holds the layer's arrays, so that memory can be measured
LayerCheck check_layer(const scene::Scene& scene, int index, std::unique_ptr<solve::LayerMechanics>& kept) {
  const auto& layer = scene.layers[static_cast<std::size_t>(index)];
  const auto mesh = solve::make_layer_mesh(scene, index);
  kept = find_layer_factory(layer.kind())(scene, index, mesh);
  LayerCheck check{&layer, mesh.n_nodes(), mesh.n_elements()};
  check.mass = mechanics::compute_lumped_mass(mesh, layer.thickness, layer.density).sum();
  check.step_seconds = measure_step(*kept, mesh);
  check.stable_increment = kept->compute_stable_increment(mesh.reference);
  return check;
}

/// Increments of the touching flat stack, as the coordinator will find them.
coordinator::Votes collect_votes(const scene::Scene& scene, const std::vector<LayerCheck>& layers) {
  coordinator::Stack stack(scene);
  stack.begin_step();
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const int index = static_cast<int>(i);
    stack.accept(index, {.vote = layers[i].stable_increment, .position = stack.layer(index).mesh.reference}, 0);
  }
  return stack.collect_votes();
}

double read_resident_bytes() {
  double total = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// Wall time of a step: no faster than the slowest process, nor than all work shared among the cores.
double estimate_step_seconds(const std::vector<LayerCheck>& layers, double cores) {
  double sum = 0, slowest = 0;
  for (const auto& l : layers) {
    sum += l.step_seconds;
    slowest = std::max(slowest, l.step_seconds / l.layer->threads);
  }
  return std::max(slowest, kAllWork * sum / cores);
}

std::string format_duration(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", seconds);
  if (seconds < 5400) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

std::string describe_blank(const scene::Blank& blank) {
  if (blank.mesh) return "blank of " + std::filesystem::path(blank.mesh->file.path).filename().string();
  return fmt::format("{:g} x {:g} mm in {:g} mm mesh", blank.length, blank.width, blank.mesh_size);
}

void print_layers(const scene::Scene& scene, const std::vector<LayerCheck>& layers, std::ostream& out) {
  out << fmt::format("{:<16} {:<7} {:>7} {:>9} {:>10} {:>10} {:>13}\n", "layer", "kind", "nodes", "elements", "mass g",
                     "added g", "increment us");
  for (auto l = layers.rbegin(); l != layers.rend(); ++l) {  // top layer first, as they lie
    const double gram = 1e6 * l->mass;
    out << fmt::format("{:<16} {:<7} {:>7} {:>9} {:>10.2f} {:>10.2f} {:>13.3f}\n", l->layer->name,
                       l->layer->kind() == scene::Kind::Fabric ? "fabric" : "metal", l->n_nodes, l->n_elements, gram,
                       gram * (scene.time.mass_scaling - 1), 1e6 * l->stable_increment);
  }
}

void print_cost(const scene::Scene& scene, const std::vector<LayerCheck>& layers, const coordinator::Votes& votes,
                double layer_bytes, std::ostream& out) {
  const auto fastest = static_cast<std::size_t>(votes.fastest);
  const double dt = scene.time.safety * votes.stack;
  const double steps = std::ceil(scene.end_time() / dt);
  const double cores = std::max(1u, std::thread::hardware_concurrency());
  const auto processes = layers.size() + 2;
  out << fmt::format(
      "\nincrement   {:.3f} us = {} x that of the layers in contact, in whose fastest mode {} moves most; it falls as "
      "fabric stiffens and layers slide\n",
      1e6 * dt, scene.time.safety, fastest < layers.size() ? layers[fastest].layer->name : "the blank holder");
  out << fmt::format("steps       at least {:.0f}, for {:.2f} ms of forming\n", steps, 1e3 * scene.end_time());
  out << fmt::format("memory      about {:.0f} MiB in {} processes\n",
                     (2 * layer_bytes + static_cast<double>(processes) * kBytesPerProcess) / (1 << 20), processes);
  out << fmt::format("time        about {} on {:.0f} cores like these\n",
                     format_duration(kMoreSteps * steps * estimate_step_seconds(layers, cores)), cores);
}

}  // namespace

int check_command(const CheckOptions& options, std::ostream& out) {
  const scene::Scene scene = scene::read_scene(options.scene, options.overrides, options.overlays);
  const auto law_warnings = check_laws(scene);
  const auto tool_warnings = coordinator::check_tools(scene);
  std::string occupied;
  try {
    check_addresses(scene);
  } catch (const scene::SceneError&) {
    throw;
  } catch (const std::exception& e) {  // that may have ended when the run begins
    occupied = e.what();
  }
  const double bytes_before = read_resident_bytes();
  std::vector<LayerCheck> layers;
  std::vector<std::unique_ptr<solve::LayerMechanics>> kept(scene.layers.size());
  for (std::size_t i = 0; i < kept.size(); ++i) layers.push_back(check_layer(scene, static_cast<int>(i), kept[i]));

  const coordinator::Votes votes = collect_votes(scene, layers);

  out << fmt::format("{}: {} layer{}, {}{}, stroke {:g} mm\n\n", scene.name, layers.size(),
                     layers.size() == 1 ? "" : "s", describe_blank(scene.blank),
                     scene.blank.half ? " (half model)" : "", scene.motion.stroke);
  print_layers(scene, layers, out);
  print_cost(scene, layers, votes, read_resident_bytes() - bytes_before, out);
  for (const auto& warning : scene::find_warnings(scene)) out << "warning     " << warning << '\n';
  if (!occupied.empty()) out << "warning     exchange.address: " << occupied << '\n';
  for (const auto& warning : law_warnings) out << "warning     " << warning << '\n';
  for (const auto& warning : tool_warnings) out << "warning     " << warning << '\n';
  return kDone;
}

}  // namespace interply::launch
