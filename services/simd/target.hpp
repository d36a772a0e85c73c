/// Instruction sets that kernels are compiled for, and which of them this machine runs.
///
/// A kernel source is compiled once for each target (interply_kernels() in services/CMakeLists.txt) and defines one
/// specialisation of a function template over these tags; kernels are chosen when a layer is made:
///
///     template <class Target> const FabricKernels& get_fabric_kernels();          // header
///     template <> const FabricKernels& get_fabric_kernels<simd::Scalar>();        // and so for Avx2, Avx512
///     template <> const FabricKernels& get_fabric_kernels<simd::Target>() {...}   // source, simd/pack.hpp
///     const FabricKernels& kernels = simd::choose([](auto t) -> auto& { return get_fabric_kernels<decltype(t)>(); });
///
/// All targets give the same results to round-off, those with packs the same bits (tests/simd).
#pragma once

namespace interply::simd {

struct Scalar {};  ///< one double at a time, the C++ library's functions: the plain reference
struct Avx2 {};    ///< four doubles
struct Avx512 {};  ///< eight doubles

enum class Choice { Scalar, Avx2, Avx512 };

/// The widest that this machine runs, or what the environment variable INTERPLY_SIMD names (scalar, avx2, avx512; what
/// the machine cannot run is passed over).
Choice choose_target();
const char* get_name(Choice choice);

/// `get(tag)` for the chosen target.
template <class Get>
decltype(auto) choose(const Get& get) {
#if defined(__x86_64__)
  switch (choose_target()) {
    case Choice::Avx512:
      return get(Avx512{});
    case Choice::Avx2:
      return get(Avx2{});
    default:
      break;
  }
#endif
  return get(Scalar{});
}

}  // namespace interply::simd
