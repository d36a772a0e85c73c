/// Abaqus .inp meshes of blanks.
#include "fuzz/blank.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  interply::fuzz::read_blank(data, size, "fuzz.inp");
  return 0;
}
