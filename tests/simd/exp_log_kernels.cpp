#include "exp_log_kernels.hpp"

#include "simd/pack.hpp"

namespace interply::simd {
namespace {

void compute_exps(const double* x, double* y, Index n) {
  for_each_pack<Pack>(0, n, [&](const auto& lanes) { lanes.store(y, exp(lanes.load(x))); });
}

void compute_logs(const double* x, double* y, Index n) {
  for_each_pack<Pack>(0, n, [&](const auto& lanes) { lanes.store(y, log(lanes.load(x))); });
}

}  // namespace

template <>
Functions get_functions<Target>() {
  return {compute_exps, compute_logs};
}

}  // namespace interply::simd
