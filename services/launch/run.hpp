/// `interply run`: one scene, formed by a federation of processes or in this one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "launch/terminal.hpp"
#include "process/exit_codes.hpp"
#include "record/run_folder.hpp"
#include "scene/scene.hpp"

namespace interply::launch {

using enum process::ExitCode;

struct RunOptions {
  std::filesystem::path scene;
  std::vector<std::string> overrides;           ///< path=value
  std::vector<std::filesystem::path> overlays;  ///< laid over the scene before the overrides
  std::filesystem::path out;                    ///< empty: runs/<scene name>
  std::string address;                          ///< empty: the scene's
  bool overwrite = false;
  bool in_process = false;
  bool no_record = false;
  bool quiet = false;
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

/// Where one run puts its files; taken as long as this lives.
struct RunFolder {
  std::filesystem::path out;
  record::FolderLock lock;
  std::filesystem::path scene() const { return out / "scene.yaml"; }
  std::filesystem::path record() const { return out / "record.h5"; }
  std::filesystem::path sidecar() const { return out / "record.xdmf"; }
  std::filesystem::path summary() const { return out / "summary.json"; }
  std::filesystem::path logs() const { return out / "logs"; }
  std::filesystem::path log(const std::string& participant) const { return logs() / (participant + ".log"); }
};

/// The sentence about a run that ended early. @param reason  as the coordinator says it
std::string describe_early_end(int exit_code, const std::string& reason);

/// Whether this host can listen and publish where the scene says, or `address` if that is given.
/// @throws scene::SceneError; std::runtime_error if somebody else listens there at present
void check_addresses(const scene::Scene& scene, const std::string& address = {});

/// Takes the folder (empty: runs/<scene name>) and puts the resolved scene there. What an earlier run wrote is removed
/// if `overwrite`, once nothing is in the way any more.
/// @throws record::FolderRefused; std::runtime_error if the folder cannot be written
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
