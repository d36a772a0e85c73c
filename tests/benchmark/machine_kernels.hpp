/// The two numbers that bound every kernel on one core: bytes per second from memory, flops per second from registers.
#pragma once

#include <cstddef>

#include "simd/target.hpp"

namespace interply::benchmarks {

struct MachineKernels {
  /// a = b + s c: 24 bytes and 2 flops per element.
  void (*triad)(double* a, const double* b, const double* c, double s, std::ptrdiff_t n);
  /// Independent fused multiply-adds, as many at a time as hide their latency. Returns something that needs them all.
  double (*multiply_add)(std::ptrdiff_t rounds);
  int flops_per_round;
};

template <class Target>
const MachineKernels& get_machine_kernels();
template <>
const MachineKernels& get_machine_kernels<simd::Scalar>();
template <>
const MachineKernels& get_machine_kernels<simd::Avx2>();
template <>
const MachineKernels& get_machine_kernels<simd::Avx512>();

inline const MachineKernels& choose_machine_kernels() {
  return simd::choose([](auto t) -> auto& { return get_machine_kernels<decltype(t)>(); });
}

}  // namespace interply::benchmarks
