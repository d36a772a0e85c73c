/// `interply run`: one scene, formed by a federation of processes or in this one.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "launch/terminal.hpp"
#include "scene/scene.hpp"

namespace interply::launch {

/// Exit codes of every interply program.
enum ExitCode { kDone = 0, kFailed = 1, kRefused = 2, kDiverged = 3, kLost = 4, kCancelled = 5 };

struct RunOptions {
  std::filesystem::path scene;
  std::vector<std::string> overrides;  ///< path=value
  std::filesystem::path out;           ///< empty: runs/<scene name>
  std::string address;                 ///< empty: the scene's
  bool overwrite = false;
  bool in_process = false;
  bool no_record = false;
  bool quiet = false;
};

/// A record of an earlier run is in the way.
class OutputExists : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// CPU time of one participant, s.
struct CpuTime {
  std::string name;  ///< "coordinator", "recorder" or the layer's name
  double seconds = 0;
};

/// How a run ended, whoever computed it.
struct RunResult {
  int exit_code = kDone;
  std::string message;       ///< why, if not done
  std::string summary;       ///< one screen
  std::string digest;        ///< of the final state of all layers; empty unless done
  std::string summary_json;  ///< its numbers (proto/summary.proto); empty unless done
  std::vector<CpuTime> cpu;  ///< of each process; empty if there was only one
};

/// Where one run puts its files.
struct RunFolder {
  std::filesystem::path out;
  std::filesystem::path scene() const { return out / "scene.yaml"; }
  std::filesystem::path record() const { return out / "record.h5"; }
  std::filesystem::path sidecar() const { return out / "record.xdmf"; }
  std::filesystem::path summary() const { return out / "summary.json"; }
  std::filesystem::path logs() const { return out / "logs"; }
};

/// Creates the folder with the resolved scene. Records and logs of an earlier run are removed if `overwrite`.
/// @throws OutputExists naming the record that is in the way; std::runtime_error if the folder cannot be written
RunFolder prepare_folder(const scene::Scene& scene, const std::filesystem::path& out, bool overwrite);

/// The scene's name with a unique ending; letters, digits, '_', '-' and '.' only.
std::string make_run_name(const std::string& scene_name);

/// Launches and supervises one process per participant: coordinator, layers, recorder (unless the scene has no frames).
RunResult run_federated(const scene::Scene& scene, const RunFolder& folder, const std::string& run_name,
                        const std::string& address, Terminal& terminal);

/// Runs the same objects in this process, one thread per layer.
RunResult run_in_process(const scene::Scene& scene, const RunFolder& folder, const std::string& run_name,
                         Terminal& terminal);

/// The whole command: reads the scene, runs it, prints summary and digest. Returns the exit code.
int run_command(const RunOptions& options);

}  // namespace interply::launch
