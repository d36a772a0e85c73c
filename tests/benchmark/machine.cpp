/// What one core of this machine can do at most: the roof that the kernels are compared with.
#include <benchmark/benchmark.h>

#include <vector>

#include "machine_kernels.hpp"

namespace {

using namespace interply;

/// From memory (192 MB) and from the cache that a layer of 4900 elements lies in (4 MB).
void machine_triad(benchmark::State& state) {
  const auto& kernels = benchmarks::choose_machine_kernels();
  const auto n = static_cast<std::size_t>(state.range(0));
  std::vector<double> a(n, 1.0), b(n, 2.0), c(n, 3.0);
  for (auto _ : state) {
    kernels.triad(a.data(), b.data(), c.data(), 0.5, state.range(0));
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * 24 * state.range(0));
  state.SetLabel(simd::get_name(simd::choose_target()));
}
BENCHMARK(machine_triad)->Arg(8 << 20)->Arg(170000);

void machine_multiply_add(benchmark::State& state) {
  const auto& kernels = benchmarks::choose_machine_kernels();
  constexpr std::ptrdiff_t kRounds = 10000;
  for (auto _ : state) benchmark::DoNotOptimize(kernels.multiply_add(kRounds));
  state.counters["flops_per_s"] = benchmark::Counter(
      static_cast<double>(state.iterations()) * kRounds * kernels.flops_per_round, benchmark::Counter::kIsRate);
  state.SetLabel(simd::get_name(simd::choose_target()));
}
BENCHMARK(machine_multiply_add);

}  // namespace
