/// exp and log of simd/pack.hpp over arrays, compiled for each target.
#pragma once

#include <cstddef>

#include "simd/target.hpp"

namespace interply::simd {

using Function = void (*)(const double* x, double* y, std::ptrdiff_t n);

struct Functions {
  Function exp, log;
};

template <class Target>
Functions get_functions();
template <>
Functions get_functions<Scalar>();
template <>
Functions get_functions<Avx2>();
template <>
Functions get_functions<Avx512>();

}  // namespace interply::simd
