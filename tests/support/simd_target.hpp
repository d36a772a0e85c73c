/// Kernels of one target, chosen whatever the machine runs best.
#pragma once

#include <cstdlib>
#include <string>

#include "simd/target.hpp"

namespace interply::test {

/// Kernels made in its scope are those of one target.
class Target {
 public:
  explicit Target(const char* name) {
    if (const char* old = std::getenv("INTERPLY_SIMD")) old_ = old;
    setenv("INTERPLY_SIMD", name, 1);
  }
  ~Target() { old_.empty() ? unsetenv("INTERPLY_SIMD") : setenv("INTERPLY_SIMD", old_.c_str(), 1); }

 private:
  std::string old_;
};

/// Whether a target is what runs when it is named: the machine has it.
inline bool is_on_this_machine(const char* name) {
  const Target target(name);
  return std::string(simd::get_name(simd::choose_target())) == name;
}

}  // namespace interply::test
