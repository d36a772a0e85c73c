/// Cost per element-step against the size of a layer (does it leave the caches?) and the number of its threads.
///
///     build/release/bin/interply-benchmarks --benchmark_filter='layer_size|layer_threads'
#include "layers.hpp"

namespace {

using namespace interply;
using benchmarks::deform;

/// Side of the elements for which the half blank has about `n`.
double find_element_size(std::int64_t n) { return std::sqrt(2 * 280.0 * 140.0 / static_cast<double>(n)); }

void run_fabric(benchmark::State& state, std::int64_t elements, int threads) {
  scene::Layer layer = benchmarks::make_ply();
  layer.threads = threads;
  const auto mesh = benchmarks::make_blank(find_element_size(elements));
  fabric::FabricLayer ply(layer, 1, mesh);
  benchmarks::run_layer(state, ply, mesh, deform(mesh, 20, 0.002), deform(mesh, 20, 0.004));
  state.counters["elements"] = static_cast<double>(mesh.n_elements());
}

/// Elastic: the swing of a step of forming, where few elements yield in any one step.
void run_metal(benchmark::State& state, std::int64_t elements, int threads) {
  scene::Layer layer = benchmarks::make_sheet();
  layer.threads = threads;
  const auto mesh = benchmarks::make_blank(find_element_size(elements));
  metal::MetalLayer sheet(layer, 7.85e-9, mesh);
  benchmarks::run_layer(state, sheet, mesh, deform(mesh, 0.1, 1e-5), deform(mesh, 0.1, -1e-5));
  state.counters["elements"] = static_cast<double>(mesh.n_elements());
}

void fabric_layer_size(benchmark::State& state) { run_fabric(state, state.range(0), 1); }
void metal_layer_size(benchmark::State& state) { run_metal(state, state.range(0), 1); }
void fabric_layer_threads(benchmark::State& state) { run_fabric(state, 100000, static_cast<int>(state.range(0))); }
void metal_layer_threads(benchmark::State& state) { run_metal(state, 100000, static_cast<int>(state.range(0))); }

BENCHMARK(fabric_layer_size)->Arg(2000)->Arg(8000)->Arg(30000)->Arg(125000)->Arg(500000);
BENCHMARK(metal_layer_size)->Arg(2000)->Arg(8000)->Arg(30000)->Arg(125000)->Arg(500000);
BENCHMARK(fabric_layer_threads)->Arg(1)->Arg(2)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(metal_layer_threads)->Arg(1)->Arg(2)->UseRealTime()->MeasureProcessCPUTime();

}  // namespace
