#include "launch/run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "coordinator/tools.hpp"
#include "launch/layer_factories.hpp"
#include "scene/read_scene.hpp"
#include "solve/watch.hpp"

namespace interply::launch {
namespace fs = std::filesystem;

RunFolder prepare_folder(const scene::Scene& scene, const fs::path& out, bool overwrite) {
  const RunFolder folder{out.empty() ? fs::path("runs") / scene.name : out};
  if (fs::exists(folder.record()) && !overwrite) {
    throw OutputExists(
        fmt::format("{} holds a record already: choose another --out, or say --overwrite", folder.out.string()));
  }
  for (const auto& old : {folder.record(), folder.sidecar(), folder.logs()}) fs::remove_all(old);
  fs::create_directories(folder.logs());
  std::ofstream file(folder.scene());
  file << scene.text;
  file.close();
  if (!file) throw std::runtime_error(fmt::format("cannot write {}", folder.scene().string()));
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
    if (!fs::is_empty(folder.logs())) terminal.print(fmt::format("logs     {}", folder.logs().string()));
  }
  if (!result.digest.empty()) terminal.print("digest " + result.digest);
}

}  // namespace

int run_command(const RunOptions& options) {
  auto overrides = options.overrides;
  if (options.no_record) overrides.push_back("record.frames=0");
  const scene::Scene scene = scene::read_scene(options.scene, overrides);
  check_laws(scene);
  solve::check_network(scene);
  std::vector<std::string> warnings = scene::find_warnings(scene);
  for (const std::string& warning : coordinator::check_tools(scene)) warnings.push_back(warning);
  const RunFolder folder = prepare_folder(scene, options.out, options.overwrite);
  Terminal terminal(stdout, options.quiet);
  for (const auto& warning : warnings) terminal.note("warning: " + warning);

  const std::string run_name = make_run_name(scene.name);
  const std::string address = options.address.empty() ? scene.exchange.address : options.address;
  const RunResult result = options.in_process ? run_in_process(scene, folder, run_name, terminal)
                                              : run_federated(scene, folder, run_name, address, terminal);
  print_result(result, folder, options.quiet, terminal);
  return result.exit_code;
}

}  // namespace interply::launch
