#include "launch/datacheck.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <thread>

#include "coordinator/amplitude.hpp"
#include "coordinator/coordinator.hpp"
#include "coordinator/quantity.hpp"
#include "coordinator/stack.hpp"
#include "coordinator/tool_check.hpp"
#include "launch/inertia.hpp"
#include "launch/layer_factories.hpp"
#include "launch/record_size.hpp"
#include "launch/run.hpp"
#include "record/disk.hpp"
#include "scene/convert.hpp"
#include "scene/read_scene.hpp"
#include "solve/session.hpp"

namespace interply::launch {
namespace {

using coordinator::set;
using Mechanics = std::vector<std::unique_ptr<solve::LayerMechanics>>;

// Measured on tetrahedron_fml with 10, 4 and 1.5 mm:
constexpr double kBytesPerProcess = 18e6;  ///< resident before a process has a layer: libraries, carriers
constexpr double kAllBytes = 3.5;    ///< of all processes: meshes on both sides, messages, frames / the arrays alone
constexpr double kAllWork = 2.8;     ///< work of all processes / work of the layers' elements while elastic
constexpr double kMoreSteps = 1.25;  ///< steps / steps at the initial increment

constexpr double kMostElements = 200e3;  ///< of all layers, to measure on
constexpr double kMuchInertia = 0.02;    ///< kinetic share above which the estimate is worth a warning

/// Of one layer.
struct Size {
  double nodes = 0, elements = 0;
  double area = 0;  ///< mm2
};

bool has_mesh_files(const scene::Scene& scene) {
  return scene.blank.mesh || std::any_of(scene.layers.begin(), scene.layers.end(),
                                         [](const scene::Layer& l) { return l.mesh.has_value(); });
}

/// @pre no mesh files
std::vector<Size> count(const scene::Scene& scene) {
  const scene::Blank& blank = scene.blank;
  const double halves = blank.half ? 1 : 2;
  std::vector<Size> sizes;
  for (const scene::Layer& layer : scene.layers) {
    const double h = layer.mesh_size.value_or(blank.mesh_size);
    const double columns = 2.0 * mechanics::count_cells_from_centre(blank.length, h);
    const double rows = halves * mechanics::count_cells_from_centre(blank.width, h);
    sizes.push_back({(columns + 1) * (rows + 1), 2 * columns * rows, blank.length * blank.width * halves / 2});
  }
  return sizes;
}

double sum_elements(const std::vector<Size>& sizes) {
  double sum = 0;
  for (const Size& size : sizes) sum += size.elements;
  return sum;
}

/// The scene, or one of the same elements that is quick to measure: a smaller rectangle of the same cells, and plates
/// with a round opening of the same share in place of surfaces.
scene::Scene make_stand_in(const scene::Scene& scene, double flange_share) {
  if (has_mesh_files(scene)) return scene;
  const double elements = sum_elements(count(scene));
  const bool has_surfaces =
      scene.tools.die.stl || scene.tools.blank_holder.opening.stl || (scene.tools.punch && scene.tools.punch->stl);
  if (elements <= kMostElements && !has_surfaces) return scene;
  scene::Scene small = scene;
  const double scale = std::min(1.0, std::sqrt(kMostElements / elements)), h = scene.blank.mesh_size;
  for (double* side : {&small.blank.length, &small.blank.width}) {
    const int cells = mechanics::count_cells_from_centre(*side, h);
    *side *= std::max(1.0, std::round(scale * cells)) / cells;
  }
  const double area = (1 - flange_share) * small.blank.length * small.blank.width;
  const double radius = std::max(std::sqrt(area / std::numbers::pi), 1e-3);
  for (scene::Opening* opening : {&small.tools.die, &small.tools.blank_holder.opening}) {
    opening->edge = 1e-6 * radius;
    opening->offset = opening->shoulder = 0.5 * radius;
    opening->stl.reset();
  }
  if (small.tools.punch) {
    small.tools.punch->edge = small.tools.punch->height = small.tools.punch->radius = 0.5 * radius;
    small.tools.punch->stl.reset();
  }
  return small;
}

/// What a stack costs and allows, from its initial state.
struct Measured {
  std::vector<Size> sizes;           ///< of each layer
  std::vector<double> increments;    ///< of each layer alone, s
  std::vector<double> step_seconds;  ///< of each layer, one thread, measured here
  coordinator::Votes votes;
  std::vector<contact::InterfaceLaw> laws;  ///< of each interface
  double bytes = 0;                         ///< of all arrays of a run
  double record_bytes = 0;
};

double measure_step(solve::LayerMechanics& mechanics, const mechanics::NodalVectors& reference) {
  mechanics::NodalVectors force(3, reference.cols());
  double fastest = INFINITY;
  for (int i = 0; i < 5; ++i) {
    const auto start = std::chrono::steady_clock::now();
    mechanics.compute_internal_forces(reference, {}, force);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    fastest = std::min(fastest, taken.count());
  }
  return fastest;
}

/// Bytes in use of the heap.
double count_bytes() {
  const auto heap = mallinfo2();
  return static_cast<double>(heap.uordblks + heap.hblkhd);
}

Measured measure(const scene::Scene& scene) {
  const double before = count_bytes();
  Measured found;
  coordinator::Stack stack(scene);
  stack.begin_step();
  Mechanics layers;
  for (int i = 0; i < stack.n_layers(); ++i) {
    const mechanics::TriangleMesh& mesh = stack.layer(i).mesh;
    found.sizes.push_back({static_cast<double>(mesh.n_nodes()), static_cast<double>(mesh.n_elements()),
                           mechanics::compute_areas(mesh).sum()});
    layers.push_back(find_layer_factory(scene.layers[static_cast<std::size_t>(i)].kind())(scene, i, mesh));
    found.step_seconds.push_back(measure_step(*layers.back(), mesh.reference));
    found.increments.push_back(layers.back()->compute_stable_increment(mesh.reference));
    stack.take_motion(i, mesh.reference, {}, found.increments.back());
    stack.compute_contact_of(i, 0);
  }
  found.votes = stack.collect_votes();
  for (int k = 0; k < stack.n_interfaces(); ++k) found.laws.push_back(stack.law(k));
  found.bytes = count_bytes() - before;
  found.record_bytes = static_cast<double>(measure_record(scene, layers, stack));
  return found;
}

/// Wall time of a step: no faster than the slowest process, nor than all work shared among the cores.
double estimate_step_seconds(const scene::Scene& scene, const Measured& measured, double cores) {
  double sum = 0, slowest = 0;
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    sum += measured.step_seconds[i];
    slowest = std::max(slowest, measured.step_seconds[i] / scene.layers[i].threads);
  }
  return std::max(slowest, kAllWork * sum / cores);
}

/// Bytes of main memory that may still be taken, or nothing.
std::optional<double> find_free_memory() {
  std::ifstream in("/proc/meminfo");
  for (std::string key, rest; in >> key && std::getline(in, rest);)
    if (key == "MemAvailable:") return 1024 * std::stod(rest);
  return std::nullopt;
}

/// In the words of the scene.
std::string describe(const scene::schema::Law& law) {
  if (law.has_woven()) return "woven " + scene::schema::WovenLaw::Variant_Name(law.woven().variant());
  if (law.has_vumat()) return "vumat " + std::filesystem::path(law.vumat().library().path()).filename().string();
  const auto& hardening = law.j2().hardening();
  return std::string("j2 ") + (law.j2().has_hill48() ? "hill48 " : "") +
         hardening.GetDescriptor()->FindFieldByNumber(hardening.law_case())->name();
}

std::string describe_blank(const scene::Blank& blank) {
  if (blank.mesh) return "blank of " + std::filesystem::path(blank.mesh->file.path).filename().string();
  return fmt::format("{:g} x {:g} mm in {:g} mm mesh", blank.length, blank.width, blank.mesh_size);
}

void add_layers(const scene::Scene& scene, const std::vector<Size>& sizes, const Measured& measured,
                datacheck::Datacheck& check) {
  const scene::schema::Scene words = scene::to_message(scene);
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    const scene::Layer& layer = scene.layers[i];
    const double gram = 1e6 * sizes[i].area * layer.thickness * layer.density;
    datacheck::Layer& entry = *check.add_layers();
    entry.set_name(layer.name);
    entry.set_kind(solve::to_word(layer.kind()));
    entry.set_law(describe(words.layers(static_cast<int>(i)).law()));
    set(entry.mutable_orientation(), layer.orientation_deg, "deg");
    set(entry.mutable_thickness(), layer.thickness, "mm");
    set(entry.mutable_nodes(), sizes[i].nodes, "-");
    set(entry.mutable_elements(), sizes[i].elements, "-");
    set(entry.mutable_mass(), gram, "g");
    set(entry.mutable_added_mass(), gram * (scene.time.mass_scaling - 1), "g");
    set(entry.mutable_increment(), 1e6 * measured.increments[i], "us");
  }
}

void add_interfaces(const scene::Scene& scene, const Measured& measured, datacheck::Datacheck& check) {
  const auto names = coordinator::name_interfaces(scene);
  for (std::size_t k = 0; k < names.size(); ++k) {
    datacheck::Interface& entry = *check.add_interfaces();
    entry.set_name(names[k].name);
    set(entry.mutable_friction(), measured.laws[k].friction, "-");
    set(entry.mutable_stiffness(), measured.laws[k].stiffness, "MPa/mm");
  }
}

void add_tools(const coordinator::ToolCheck& tools, datacheck::Datacheck& check) {
  for (const coordinator::ToolFacts& tool : tools.tools) {
    datacheck::Tool& entry = *check.add_tools();
    entry.set_name(tool.name);
    entry.set_shape(tool.shape);
    set(entry.mutable_size_x(), tool.size[0], "mm");
    set(entry.mutable_size_y(), tool.size[1], "mm");
    set(entry.mutable_size_z(), tool.size[2], "mm");
    set(entry.mutable_touching_height(), tool.touching, "mm");
    set(entry.mutable_moved(), tool.moved, "mm");
    if (std::isfinite(tool.radius)) set(entry.mutable_smallest_radius(), tool.radius, "mm");
  }
}

void add_motion(const scene::Scene& scene, const coordinator::ToolCheck& tools, datacheck::Datacheck& check) {
  datacheck::Motion& motion = *check.mutable_motion();
  const double speed = scene.tools.punch ? coordinator::kSteepest * scene.motion.stroke / scene.motion.forming_time : 0;
  set(motion.mutable_stroke(), scene.motion.stroke, "mm");
  set(motion.mutable_time(), 1e3 * scene.end_time(), "ms");
  set(motion.mutable_largest_speed(), 1e-3 * speed, "m/s");
  set(motion.mutable_holder_force(), 1e-3 * scene.tools.blank_holder.pressure * tools.flange_area, "kN");
  const auto share = estimate_kinetic_share(scene, tools.flange_area, tools.blank_area);
  if (!share) return;
  set(motion.mutable_kinetic_share(), 100 * *share, "%");
  if (*share > kMuchInertia)
    check.add_warnings(
        fmt::format("motion.forming_time: inertia may take {:.2g} % of the work: {:.2g} s would leave about 1 %",
                    100 * *share, scene.motion.forming_time * std::sqrt(*share / 0.01)));
}

/// @param more  elements of the scene / elements of what was measured
void add_cost(const scene::Scene& scene, const Measured& measured, double more, datacheck::Datacheck& check) {
  datacheck::Cost& cost = *check.mutable_cost();
  const auto fastest = static_cast<std::size_t>(measured.votes.fastest);
  const double frames = scene.record.frames;
  const double dt = scene.time.safety * measured.votes.stack;
  const double steps = std::max(frames, std::ceil(scene.end_time() / dt));
  const double cores = std::max(1u, std::thread::hardware_concurrency());
  const double processes = static_cast<double>(scene.layers.size()) + (frames > 0 ? 2 : 1);
  set(cost.mutable_increment(), 1e6 * dt, "us");
  cost.set_fastest(fastest < scene.layers.size() ? scene.layers[fastest].name : "the blank holder");
  set(cost.mutable_steps(), steps, "-");
  set(cost.mutable_frames(), frames > 0 ? frames + 1 : 0, "-");
  set(cost.mutable_processes(), processes, "-");
  const double memory = kAllBytes * more * measured.bytes + processes * kBytesPerProcess,
               record = more * measured.record_bytes;
  set(cost.mutable_memory(), memory / (1 << 20), "MiB");
  set(cost.mutable_record(), record / (1 << 20), "MiB");
  set(cost.mutable_cores(), cores, "-");
  set(cost.mutable_wall_time(), kMoreSteps * steps * more * estimate_step_seconds(scene, measured, cores), "s");
  if (const auto free = find_free_memory()) {
    set(cost.mutable_free_memory(), *free / (1 << 20), "MiB");
    if (memory > *free)
      check.add_warnings(fmt::format("memory: the run needs about {:.1f} GiB and {:.1f} GiB are free",
                                     memory / (1 << 30), *free / (1 << 30)));
  }
  if (const auto free = record::find_free_space(std::filesystem::path("runs") / scene.name)) {
    set(cost.mutable_free_disk(), static_cast<double>(*free) / (1 << 20), "MiB");
    if (record > static_cast<double>(*free))
      check.add_warnings(
          fmt::format("record.frames: the record takes about {:.1f} GiB and {:.1f} GiB are free in runs/{}: keep fewer "
                      "frames or give `interply run` another --out",
                      record / (1 << 30), static_cast<double>(*free) / (1 << 30), scene.name));
  }
}

}  // namespace

datacheck::Datacheck check_data(const scene::Scene& scene) {
  datacheck::Datacheck check;
  check.set_interply(exchange::kVersion);
  check.set_scene(scene.name);
  check.set_blank(describe_blank(scene.blank));
  check.set_modelled_part(scene.blank.half ? "half model" : "full model");
  for (const auto& warning : scene::find_warnings(scene)) check.add_warnings(warning);
  for (const auto& warning : check_laws(scene)) check.add_warnings(warning);
  const coordinator::ToolCheck tools = coordinator::check_tools(scene);
  for (const auto& warning : tools.warnings) check.add_warnings(warning);
  try {
    check_addresses(scene);
  } catch (const scene::SceneError&) {
    throw;
  } catch (const std::exception& e) {  // that may have ended when the run begins
    check.add_warnings(fmt::format("exchange.address: {}", e.what()));
  }
  const Measured measured = measure(make_stand_in(scene, tools.flange_area / tools.blank_area));
  const std::vector<Size> sizes = has_mesh_files(scene) ? measured.sizes : count(scene);
  add_layers(scene, sizes, measured, check);
  add_interfaces(scene, measured, check);
  add_tools(tools, check);
  add_motion(scene, tools, check);
  add_cost(scene, measured, sum_elements(sizes) / sum_elements(measured.sizes), check);
  return check;
}

}  // namespace interply::launch
