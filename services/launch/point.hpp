/// `interply point`: a law at one material point along a prescribed deformation, for calibration.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <stdexcept>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace interply::launch {

/// A path that cannot be used; what() is one sentence with file and line.
class PathError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The columns of a path and of the response to it, by law, with their units: for `interply point --help`.
extern const char* const kPointColumns;

/// The response of a law along a path, both as CSV text (columns: kPointColumns); `origin` stands for the path's file
/// name.
/// @throws PathError
std::string follow_path(const scene::Law& law, const std::string& csv, const std::string& origin);

/// Reads a law (the `law` block of a scene's layer) and a path, writes the response as CSV with 17 significant digits.
///
/// A law or a row that cannot be used is refused on `err` with file name and line number, and nothing is written.
/// @param overrides  of the law, "path=value" as in woven.variant=biaxial
/// @return 0, 2 if refused, or 3 if the law diverges
int run_point(const std::filesystem::path& law, const std::filesystem::path& path_csv, std::ostream& out,
              std::ostream& err, const std::vector<std::string>& overrides = {});

}  // namespace interply::launch
