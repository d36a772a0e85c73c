#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <stdexcept>

#include "launch/federation.hpp"

namespace interply::launch {
namespace fs = std::filesystem;
namespace {

/// Folder for the run's socket, short because a Unix socket's path has at most 107 bytes; removed with this object.
class SocketFolder {
 public:
  SocketFolder() {
    std::string path = "/tmp/interply-XXXXXX";
    if (mkdtemp(path.data()) == nullptr) throw std::runtime_error("cannot create a folder for the socket in /tmp");
    path_ = path;
  }
  ~SocketFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  SocketFolder(const SocketFolder&) = delete;
  SocketFolder& operator=(const SocketFolder&) = delete;
  /// @param carrier  shm or ipc
  std::string address(const std::string& carrier) const { return carrier + "://" + (path_ / "link").string(); }

 private:
  fs::path path_;
};

std::vector<Participant> list_others(const scene::Scene& scene, const fs::path& out, const std::string& bound) {
  const fs::path programs = find_program_folder();
  std::vector<Participant> others;
  if (scene.record.frames > 0) {
    others.push_back({"recorder", {programs / "interply-recorder", "--connect", bound, "--out", out}});
  }
  for (const auto& layer : scene.layers) {
    const auto* program = layer.kind() == scene::Kind::Fabric ? "interply-solver-fabric" : "interply-solver-metal";
    others.push_back({layer.name, {programs / program, "--connect", bound, "--layer", layer.name}});
  }
  return others;
}

}  // namespace

RunResult run_federated(const scene::Scene& scene, const RunFolder& folder, const std::string& run_name,
                        const std::string& address, Terminal& terminal) {
  const SocketFolder socket;
  const bool is_private = address == "shm" || address == "ipc";
  FederationPlan plan;
  plan.coordinator = {"coordinator",
                      {find_program_folder() / "interply-coordinator", "--bind",
                       is_private ? socket.address(address) : address, "--scene", folder.scene(), "--run", run_name}};
  plan.others = [&](const std::string& bound) { return list_others(scene, folder.out, bound); };
  plan.logs = folder.logs();
  plan.startup_deadline = scene.exchange.startup_deadline;
  Federation federation(std::move(plan), terminal);
  return federation.supervise();
}

}  // namespace interply::launch
