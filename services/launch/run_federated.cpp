#include <fmt/format.h>

#include <random>

#include "launch/federation.hpp"
#include "mechanics/digest.hpp"

namespace interply::launch {
namespace fs = std::filesystem;
namespace {

/// An address that only this user reaches and that leaves nothing in the file system, whatever is killed.
/// @param carrier  shm or ipc
std::string make_private_address(const std::string& carrier, const std::string& run_name) {
  std::random_device random;
  return fmt::format("{}://@interply-{}-{:08x}{:08x}", carrier, run_name.substr(0, 60), random(), random());
}

std::vector<Participant> list_others(const scene::Scene& scene, const RunFolder& folder, const std::string& bound) {
  const fs::path programs = find_program_folder();
  const std::string silence = fmt::format("{}", scene.exchange.wait_deadline);
  std::vector<Participant> others;
  if (scene.record.frames > 0) {
    others.push_back({"recorder",
                      {programs / "interply-recorder", "--connect", bound, "--out", folder.out, "--folder-taken",
                       "--silence", silence},
                      folder.lock.descriptor()});
  }
  for (const auto& layer : scene.layers) {
    const auto* program = layer.kind() == scene::Kind::Fabric ? "interply-solver-fabric" : "interply-solver-metal";
    others.push_back(
        {layer.name, {programs / program, "--connect", bound, "--layer", layer.name, "--silence", silence}});
  }
  return others;
}

}  // namespace

RunResult run_federated(const scene::Scene& scene, const RunFolder& folder, const std::string& run_name,
                        const std::string& address, Terminal& terminal) {
  const bool is_private = address == "shm" || address == "ipc";
  FederationPlan plan;
  plan.coordinator = {"coordinator",
                      {find_program_folder() / "interply-coordinator", "--bind",
                       is_private ? make_private_address(address, run_name) : address, "--scene", folder.scene(),
                       "--scene-digest", mechanics::to_hex(scene.digest), "--run", run_name, "--for-launcher"}};
  plan.others = [&](const std::string& bound) { return list_others(scene, folder, bound); };
  plan.logs = folder.logs();
  plan.startup_deadline = scene.exchange.startup_deadline;
  Federation federation(std::move(plan), terminal);
  return federation.supervise();
}

}  // namespace interply::launch
