/// `interply bench stack`: what a whole run costs as a federation of processes and in one process, side by side.
#pragma once

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace interply::launch {

struct BenchStackOptions {
  std::filesystem::path scene;         ///< empty: deploy/scenes/tetrahedron_fml.yaml shortened to some 1500 steps
  std::vector<std::string> overrides;  ///< path=value
  int rounds = 3;                      ///< each runs federated and in-process, in turn
};

/// Medians over the rounds: rates, waits, the coordinator's share, digests. Exit code kFailed if digests differ, or
/// that of the run that did not end well.
int bench_stack_command(const BenchStackOptions& options, std::ostream& out);

}  // namespace interply::launch
