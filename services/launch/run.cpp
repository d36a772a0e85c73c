#include "launch/run.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>

#include "coordinator/tool_check.hpp"
#include "exchange/address.hpp"
#include "launch/layer_factories.hpp"
#include "process/limits.hpp"
#include "process/signals.hpp"
#include "process/words.hpp"
#include "record/reader.hpp"
#include "scene/read_scene.hpp"
#include "solve/watch.hpp"

namespace interply::launch {
namespace fs = std::filesystem;

namespace {

// What the hungriest process of a run takes, measured, and as much again: the coordinator, or this one in process.
constexpr int kDescriptors = 64, kDescriptorsPerLayer = 6;
constexpr std::int64_t kAddressSpace = INT64_C(1) << 30;  ///< bytes, without the layers' arrays

/// Everything that the run will write.
std::vector<fs::path> list_files(const scene::Scene& scene, const RunFolder& folder) {
  std::vector<fs::path> files = record::list_run_files(folder.out);
  for (const char* name : {"coordinator", "recorder"}) files.push_back(folder.log(name));
  for (const scene::Layer& layer : scene.layers) files.push_back(folder.log(layer.name));
  return files;
}

/// Logs of an earlier run, whatever layers it had.
std::vector<fs::path> find_old_logs(const RunFolder& folder) {
  std::vector<fs::path> logs;
  if (fs::is_directory(folder.logs()))
    for (const auto& entry : fs::directory_iterator(folder.logs()))
      if (entry.path().extension() == ".log" && record::was_written_by_a_run(entry.path()))
        logs.push_back(entry.path());
  return logs;
}

}  // namespace

std::string describe_early_end(int exit_code, const std::string& reason) {
  const std::string what = exit_code == kDiverged    ? "the mechanics diverged"
                           : exit_code == kLost      ? "a participant was lost"
                           : exit_code == kCancelled ? "the run was cancelled"
                                                     : "the run could not go on";
  if (reason.starts_with(what)) return reason;
  return reason.empty() ? what : what + ": " + reason;
}

void check_addresses(const scene::Scene& scene, const std::string& address) {
  solve::check_network(scene);
  const std::string& chosen = address.empty() ? scene.exchange.address : address;
  if (chosen == "shm" || chosen == "ipc") return;
  try {
    exchange::check_listening(chosen);
  } catch (const exchange::BadAddress& e) {
    throw scene::SceneError((address.empty() ? "exchange.address: " : "--address: ") + std::string(e.what()));
  }
}

RunFolder prepare_folder(const scene::Scene& scene, const fs::path& out, bool overwrite) {
  const fs::path path = out.empty() ? fs::path("runs") / scene.name : out;
  RunFolder folder{path, record::FolderLock(path, "scene " + process::to_line(scene.name))};
  const std::vector<fs::path> files = list_files(scene, folder);
  record::check_room_for(files, overwrite);
  record::make_room_for(files);
  record::make_room_for(find_old_logs(folder));
  fs::create_directories(folder.logs());
  record::write_scene(folder.scene(), scene.text);
  return folder;
}

std::string make_run_name(const std::string& scene_name) {
  std::string name;
  for (const char c : scene_name) {
    const bool plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
    name += plain ? c : '_';
  }
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return fmt::format("{}-{:x}-{}", name, std::chrono::duration_cast<std::chrono::milliseconds>(now).count(), getpid());
}

namespace {

/// Of a run that is not done.
std::string find_status(int exit_code) {
  switch (exit_code) {
    case kDiverged:
      return "diverged";
    case kLost:
      return "lost";
    case kCancelled:
      return "cancelled";
    default:
      return "failed";
  }
}

/// What a run that ended early has left. Empty: nothing that can be read.
std::string describe_record(const scene::Scene& scene, const RunFolder& folder) try {
  return fmt::format("the record holds {} of {} frames", record::RecordReader(folder.record()).frames_complete(),
                     scene.record.frames + 1);
} catch (const std::exception&) {
  return "";
}

void print_result(const RunResult& result, const RunFolder& folder, bool quiet, Terminal& terminal) {
  terminal.end_progress();
  if (!result.message.empty()) std::fprintf(stderr, "interply: %s\n", result.message.c_str());
  if (!quiet) {
    if (!result.summary.empty())
      terminal.print(result.summary.substr(0, result.summary.find_last_not_of('\n') + 1) + '\n');
    if (fs::exists(folder.record())) {
      terminal.print(fmt::format("record   {}   (in ParaView open {})", folder.record().string(),
                                 folder.sidecar().filename().string()));
    }
    terminal.print(fmt::format("scene    {}", folder.scene().string()));
    if (fs::exists(folder.summary())) terminal.print(fmt::format("summary  {}", folder.summary().string()));
    if (!fs::is_empty(folder.logs())) terminal.print(fmt::format("logs     {}", folder.logs().string()));
  }
  if (!result.digest.empty()) terminal.print("digest " + result.digest);
}

}  // namespace

int run_command(const RunOptions& options) {
  ::umask(0077);                  // what a run writes is the user's alone
  std::signal(SIGPIPE, SIG_IGN);  // whoever reads us may leave; the run goes on
  process::end_at_once_by_signals(kCancelled);
  auto overrides = options.overrides;
  if (options.no_record) overrides.push_back("record.frames=0");
  const scene::Scene scene = scene::read_scene(options.scene, overrides, options.overlays);
  process::require_descriptors(kDescriptors + kDescriptorsPerLayer * static_cast<int>(scene.layers.size()));
  process::require_address_space(kAddressSpace);
  std::vector<std::string> warnings = check_laws(scene);
  for (const std::string& warning : scene::find_warnings(scene)) warnings.push_back(warning);
  for (const std::string& warning : coordinator::check_tools(scene).warnings) warnings.push_back(warning);
  check_addresses(scene, options.address);
  const RunFolder folder = prepare_folder(scene, options.out, options.overwrite);
  Terminal terminal(stdout, options.quiet);
  for (const auto& warning : warnings) terminal.note("warning: " + warning);

  const std::string run_name = make_run_name(scene.name);
  const std::string address = options.address.empty() ? scene.exchange.address : options.address;
  RunResult result = options.in_process ? run_in_process(scene, folder, run_name, terminal)
                                        : run_federated(scene, folder, run_name, address, terminal);
  if (!result.summary_json.empty() && !fs::exists(folder.summary()))  // else it came with the record
    std::ofstream(folder.summary()) << result.summary_json;
  try {
    if (result.exit_code != kDone) record::settle_record(folder.out, find_status(result.exit_code), result.message);
  } catch (const std::exception& e) {  // the disk that ended the run
    terminal.note(fmt::format("warning: the record does not say how the run ended: {}", e.what()));
  }
  if (const std::string kept = describe_record(scene, folder); result.exit_code != kDone && !kept.empty())
    result.message += (result.message.find('\n') == std::string::npos ? "; " : "\n") + kept;
  print_result(result, folder, options.quiet, terminal);
  return result.exit_code;
}

}  // namespace interply::launch
