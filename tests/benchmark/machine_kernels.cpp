#include "machine_kernels.hpp"

#include "simd/pack.hpp"

namespace interply::benchmarks {
namespace {

using simd::Pack;

constexpr int kChains = 12;  ///< latency 4, two units, and some to spare; fits 16 registers

void triad(double* a, const double* b, const double* c, double s, std::ptrdiff_t n) {
  const Pack scale(s);
  simd::for_each_pack<Pack>(0, n, [&](const auto& lanes) { lanes.store(a, lanes.load(b) + scale * lanes.load(c)); });
}

double multiply_add(std::ptrdiff_t rounds) {
  Pack sum[kChains];
  for (int i = 0; i < kChains; ++i) sum[i] = Pack(1e-3 * i);
  const Pack factor(0.999), term(1e-3);
  for (std::ptrdiff_t r = 0; r < rounds; ++r)
    for (int i = 0; i < kChains; ++i) sum[i] = sum[i] * factor + term;  // contracted to one instruction
  double total = 0;
  for (const Pack& s : sum) {
    double lanes[simd::kWidth<Pack>];
    simd::Lanes<Pack, false>(0, simd::kWidth<Pack>).store(lanes, s);
    for (const double lane : lanes) total += lane;
  }
  return total;
}

}  // namespace

template <>
const MachineKernels& get_machine_kernels<simd::Target>() {
  static const MachineKernels kernels{triad, multiply_add, 2 * kChains * simd::kWidth<Pack>};
  return kernels;
}

}  // namespace interply::benchmarks
