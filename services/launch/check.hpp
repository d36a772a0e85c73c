/// `interply check`: what a scene would cost and what looks doubtful, without running it.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace interply::launch {

struct CheckOptions {
  std::filesystem::path scene;
  std::vector<std::string> overrides;           ///< path=value
  std::vector<std::filesystem::path> overlays;  ///< laid over the scene before the overrides
  bool json = false;
};

/// Validates and prints what check_data() finds, as text or JSON. Returns the exit code.
/// @throws scene::SceneError
int check_command(const CheckOptions& options, std::ostream& out);

}  // namespace interply::launch
