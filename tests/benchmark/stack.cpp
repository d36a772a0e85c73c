/// The five-layer FML stack with contact, in one process: element-steps per second and core.
///
///     cmake --preset release && cmake --build build/release --target interply-benchmarks
///     build/release/bin/interply-benchmarks --benchmark_filter=stack
///
/// The rate is elements x steps over the CPU time of the whole process (all layer threads and the coordinator), from
/// the end of the first step, so that set-up does not count and a second core neither helps nor hurts. Read it with the
/// digest beside it: the same digest is the same answer.
#include <benchmark/benchmark.h>

#include <ctime>

#include "support/in_process_run.hpp"

namespace {

using namespace interply;

/// CPU time and step of the first and of the last history row.
class StopWatch : public test::MemorySink {
 public:
  using test::MemorySink::put;
  void put(const observe::HistoryRow& row) override {
    const double now = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
    if (row.step == 0) start_ = now;
    seconds_ = now - start_;
    steps_ = row.step;
  }
  double seconds() const { return seconds_; }
  std::int64_t steps() const { return steps_; }

 private:
  double start_ = 0, seconds_ = 0;
  std::int64_t steps_ = 0;
};

/// 4 mm half model of the shipped scene: the blank-holder ramp and the first millimetres of the punch in some 300
/// steps.
void stack(benchmark::State& state) {
  const scene::Scene scene = test::read_shipped_scene(
      "tetrahedron_fml.yaml", {"tools.blank_holder.ramp=0.05e-3", "motion.forming_time=0.07e-3", "motion.stroke=0.3",
                               "record.frames=0", "record.history=2"});
  double element_steps = 0, seconds = 0;
  std::string digest;
  std::int64_t steps = 0;
  for (auto _ : state) {
    StopWatch watch;
    const coordinator::Outcome outcome = test::run_in_process(scene, {}, watch);
    if (outcome.exit_code != 0) return state.SkipWithError(outcome.message.c_str());
    for (int i = 0; i < static_cast<int>(scene.layers.size()); ++i)
      element_steps += static_cast<double>(solve::make_layer_mesh(scene, i).n_elements() * watch.steps());
    seconds += watch.seconds();
    steps = watch.steps();
    state.SetIterationTime(watch.seconds());
    digest = outcome.digest;
  }
  state.counters["steps"] = static_cast<double>(steps);
  state.counters["element_steps_per_s_and_core"] = element_steps / seconds;
  state.SetLabel("digest " + digest);
}
BENCHMARK(stack)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
