#include "launch/bench_stack.hpp"

#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <functional>
#include <numeric>
#include <stdexcept>

#include "bench/loops.hpp"
#include "launch/bench_tools.hpp"
#include "launch/command_line.hpp"
#include "launch/layer_factories.hpp"
#include "launch/process.hpp"
#include "launch/run.hpp"
#include "record/reader.hpp"
#include "scene/read_scene.hpp"

namespace interply::launch {
namespace fs = std::filesystem;
namespace {

/// The ramp of the blank holder and the first millimetres of the punch.
const std::vector<std::string> kShortened = {"tools.blank_holder.ramp=0.2e-3", "motion.forming_time=0.4e-3",
                                             "motion.stroke=1.6"};

fs::path find_default_scene() {
  const fs::path name = "deploy/scenes/tetrahedron_fml.yaml";
  for (const fs::path& root : {fs::path("."), find_program_folder() / "../../.."})
    if (fs::exists(root / name)) return (root / name).lexically_normal();
  throw BadArgument("the default scene " + name.string() + " is not here: name a SCENE");
}

scene::Scene read_shortened(const BenchStackOptions& options) {
  std::vector<std::string> overrides = options.scene.empty() ? kShortened : std::vector<std::string>{};
  overrides.insert(overrides.end(), options.overrides.begin(), options.overrides.end());
  for (const char* few : {"record.frames=1", "record.history=20"}) overrides.push_back(few);
  const scene::Scene scene = scene::read_scene(options.scene.empty() ? find_default_scene() : options.scene, overrides);
  check_laws(scene);
  return scene;
}

double read_thread_cpu() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// One run, or the medians of several.
struct Measured {
  double steps = 0;
  double loop = 0;              ///< s of wall time in the steps
  double outside = 0;           ///< s before and after them: meshes, start and end of processes, the record
  double cpu = 0;               ///< s, of all processes, from start to end
  double contact_cpu = 0;       ///< s of that, of the coordinator
  double coordinator_wait = 0;  ///< share of the coordinator's steps that it waits for layers
  std::vector<double> step;     ///< s of wall time per step, by layer
  std::vector<double> wait;     ///< of that, share of waiting for the coordinator, by layer
  RunResult result;
};

/// Wall time and waits from the rows of the history, each of which holds means since the row before.
void read_history(const fs::path& file, Measured& measured) {
  const record::RecordReader record(file);
  const std::vector<double> at = record.read_history("step").values;
  const auto sum = [&](const char* column, std::size_t columns, std::size_t c) {
    const std::vector<double> mean = record.read_history(column).values;
    double total = 0;
    for (std::size_t row = 1; row < at.size(); ++row) total += (at[row] - at[row - 1]) * mean[row * columns + c];
    return total;
  };
  measured.steps = at.back();
  measured.loop = sum("coordinator_step_seconds", 1, 0);
  measured.coordinator_wait = sum("coordinator_wait_seconds", 1, 0) / measured.loop;
  const std::size_t n = record.layers().size();
  for (std::size_t i = 0; i < n; ++i) {
    const double step = sum("step_seconds", n, i);
    measured.step.push_back(step / measured.steps);
    measured.wait.push_back(sum("wait_seconds", n, i) / step);
  }
}

using Run = std::function<RunResult(const RunFolder&, Terminal&)>;

/// @throws std::runtime_error if the run ends well but left no history
Measured measure(const scene::Scene& scene, const fs::path& folder, const Run& run) {
  Terminal terminal(stdout, true);
  const RunFolder files = prepare_folder(scene, folder, true);
  const double cpu = bench::read_process_cpu(), own = read_thread_cpu();
  const auto start = std::chrono::steady_clock::now();
  Measured measured;
  measured.result = run(files, terminal);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (measured.result.exit_code != kDone) return measured;
  measured.cpu = bench::read_process_cpu() - cpu;
  measured.contact_cpu = read_thread_cpu() - own;  // of a run in this process this thread is the coordinator
  if (!measured.result.cpu.empty()) measured.contact_cpu = 0;
  for (const CpuTime& process : measured.result.cpu) {
    measured.cpu += process.seconds;
    if (process.name == "coordinator") measured.contact_cpu = process.seconds;
  }
  read_history(files.record(), measured);
  measured.outside = wall - measured.loop;
  return measured;
}

template <typename Get>
double find_median_of(const std::vector<Measured>& runs, const Get& get) {
  std::vector<double> values;
  for (const Measured& run : runs) values.push_back(get(run));
  return find_median(values);
}

void print_runs(std::ostream& out, const char* name, const std::vector<Measured>& runs, double elements) {
  const auto median = [&](const auto& get) { return find_median_of(runs, get); };
  out << fmt::format("{:<11} {:>7.3f} {:>8.3f} {:>7.3f} {:>6.2f} {:>10.3g} {:>10.3g} {:>9.1f} {:>11.1f}  {}\n", name,
                     median([](auto& r) { return r.loop; }), median([](auto& r) { return r.outside; }),
                     median([](auto& r) { return r.cpu; }),
                     median([](auto& r) { return r.cpu / (r.loop + r.outside); }),
                     median([&](auto& r) { return elements * r.steps / r.loop; }),
                     median([&](auto& r) { return elements * r.steps / r.cpu; }),
                     median([](auto& r) { return 100 * r.contact_cpu / r.cpu; }),
                     median([](auto& r) { return 100 * r.coordinator_wait; }), runs.front().result.digest);
}

void print_layers(std::ostream& out, const scene::Scene& scene, const std::vector<int>& elements,
                  const std::vector<Measured>& federated, const std::vector<Measured>& in_process) {
  out << fmt::format("{:<14} {:>8} {:>7}   {:>10} {:>7}   {:>10} {:>7}\n", "layer", "elements", "threads", "federated",
                     "wait %", "in-process", "wait %");
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    out << fmt::format("{:<14} {:>8} {:>7}", scene.layers[i].name, elements[i], scene.layers[i].threads);
    for (const auto* runs : {&federated, &in_process})
      out << fmt::format("   {:>7.0f} us {:>7.1f}", find_median_of(*runs, [&](auto& r) { return 1e6 * r.step[i]; }),
                         find_median_of(*runs, [&](auto& r) { return 100 * r.wait[i]; }));
    out << '\n';
  }
}

/// Federated / in-process, pair by pair.
template <typename Get>
double find_ratio_of(const std::vector<Measured>& federated, const std::vector<Measured>& in_process, const Get& get) {
  std::vector<double> ours, reference;
  for (const Measured& run : federated) ours.push_back(get(run));
  for (const Measured& run : in_process) reference.push_back(get(run));
  return find_ratio(ours, reference);
}

}  // namespace

int bench_stack_command(const BenchStackOptions& options, std::ostream& out) {
  const scene::Scene scene = read_shortened(options);
  const TemporaryFolder folder;
  const std::string run_name = make_run_name(scene.name);
  const Run run_processes = [&](const RunFolder& files, Terminal& terminal) {
    return run_federated(scene, files, run_name, scene.exchange.address, terminal);
  };
  const Run run_threads = [&](const RunFolder& files, Terminal& terminal) {
    return run_in_process(scene, files, run_name, terminal);
  };
  std::vector<Measured> federated, in_process;
  for (int round = 0; round < options.rounds; ++round)
    for (auto* runs : {&federated, &in_process}) {
      runs->push_back(measure(scene, folder.make_empty("run"), runs == &federated ? run_processes : run_threads));
      const RunResult& result = runs->back().result;
      if (result.exit_code != kDone) {
        out << (runs == &federated ? "federated: " : "in-process: ") << result.message << std::endl;
        return result.exit_code;
      }
    }

  std::vector<int> elements;
  for (int i = 0; i < static_cast<int>(scene.layers.size()); ++i)
    elements.push_back(static_cast<int>(solve::make_layer_mesh(scene, i).n_elements()));
  const double all = std::accumulate(elements.begin(), elements.end(), 0.0);
  out << fmt::format("stack: {}, {} layers, {} elements, {} steps over {}; medians of {} rounds\n", scene.name,
                     scene.layers.size(), all, federated.front().steps, scene.exchange.address, options.rounds)
      << fmt::format("{:<11} {:>7} {:>8} {:>7} {:>6} {:>10} {:>10} {:>9} {:>11}  {}\n", "", "loop s", "around s",
                     "CPU s", "cores", "el-steps/s", "/CPU s", "contact %", "hub waits %", "digest");
  print_runs(out, "federated", federated, all);
  print_runs(out, "in-process", in_process, all);
  out << fmt::format("federated / in-process: {:.3f} wall in the loop, {:.3f} CPU\n",
                     find_ratio_of(federated, in_process, [](auto& r) { return r.loop; }),
                     find_ratio_of(federated, in_process, [](auto& r) { return r.cpu; }));
  print_layers(out, scene, elements, federated, in_process);
  for (const auto* runs : {&federated, &in_process})
    for (const Measured& run : *runs)
      if (run.result.digest != federated.front().result.digest) {
        out << "the digests differ: " << run.result.digest << " and " << federated.front().result.digest << std::endl;
        return kFailed;
      }
  return kDone;
}

}  // namespace interply::launch
