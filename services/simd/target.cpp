#include "simd/target.hpp"

#include <cstdlib>
#include <string_view>

namespace interply::simd {

namespace {

Choice find_widest() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd"))
    return Choice::Avx512;
  return Choice::Avx2;  // all of interply is compiled for it
#else
  return Choice::Scalar;
#endif
}

}  // namespace

Choice choose_target() {
  const Choice widest = find_widest();
  const char* named = std::getenv("INTERPLY_SIMD");
  if (!named) return widest;
  for (const Choice choice : {Choice::Scalar, Choice::Avx2})
    if (std::string_view(named) == get_name(choice) && choice <= widest) return choice;
  return widest;
}

const char* get_name(Choice choice) {
  return choice == Choice::Avx512 ? "avx512" : choice == Choice::Avx2 ? "avx2" : "scalar";
}

}  // namespace interply::simd
