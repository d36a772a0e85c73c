/// Files that users bring: meshes of blanks (.msh, .inp) and surfaces of tools (.stl).
#pragma once

#include <stdexcept>
#include <string>

namespace interply::geometry {

/// One sentence: file, line where there is one, what is wrong, what to change.
struct Unreadable : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Whole content of a regular file.
/// @throws Unreadable  if it is missing, no regular file, larger than 1 GiB, or cannot be read
std::string read_file(const std::string& path);

}  // namespace interply::geometry
