/// A whole run inside a test: coordinator and layers as threads of this process, everything published kept in memory.
#pragma once

#include <chrono>
#include <filesystem>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "coordinator/coordinator.hpp"
#include "exchange/in_process.hpp"
#include "launch/layer_factories.hpp"
#include "paths.hpp"
#include "scene/read_scene.hpp"
#include "support/memory_sink.hpp"

namespace interply::test {

inline scene::Scene read_test_scene(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return scene::read_scene(std::filesystem::path(INTERPLY_SOURCE_DIR) / "tests/scenes" / name, overrides);
}
inline scene::Scene read_shipped_scene(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return scene::read_scene(std::filesystem::path(INTERPLY_SOURCE_DIR) / "deploy/scenes" / name, overrides);
}

struct InProcessOptions {
  solve::LayerFactory factory = nullptr;  ///< of every layer; null: the solver that the layer's law asks for
  int delay_seed = 0;                     ///< not 0: every motion is held back for a random time up to 0.2 ms
};

/// What is left of a run.
struct InProcessResult {
  coordinator::Outcome outcome;
  std::unique_ptr<MemorySink> sink = std::make_unique<MemorySink>();
};

/// A link that is late by random times, so that motions arrive in another order at every step.
class LateLink : public exchange::SolverLink {
 public:
  LateLink(std::unique_ptr<exchange::SolverLink> link, int seed)
      : link_(std::move(link)), random_(static_cast<unsigned>(seed)) {}
  exchange::Welcome join(const exchange::Join& join, double deadline) override { return link_->join(join, deadline); }
  void send(const exchange::Motion& motion) override {
    std::this_thread::sleep_for(std::chrono::microseconds(std::uniform_int_distribution(0, 200)(random_)));
    link_->send(motion);
  }
  void receive(exchange::Force& force, double deadline) override { link_->receive(force, deadline); }
  void send(const exchange::Final& final) override { link_->send(final); }
  void send_failure(const std::string& message) override { link_->send_failure(message); }

 private:
  std::unique_ptr<exchange::SolverLink> link_;
  std::mt19937 random_;
};

inline coordinator::Outcome run_in_process(const scene::Scene& scene, const InProcessOptions& options,
                                           observe::Sink& sink) {
  std::vector<exchange::Expected> expected;
  for (std::size_t i = 0; i < scene.layers.size(); ++i)
    expected.push_back({.layer = scene.layers[i].name,
                        .n_nodes = solve::make_layer_mesh(scene, static_cast<int>(i)).n_nodes(),
                        .kind = solve::to_word(scene.layers[i].kind())});
  exchange::InProcessHub hub(scene.digest, expected);
  const auto run_layer = [&](int i) {
    const scene::Layer& layer = scene.layers[static_cast<std::size_t>(i)];
    std::unique_ptr<exchange::SolverLink> link = hub.connect();
    if (options.delay_seed) link = std::make_unique<LateLink>(std::move(link), 100 * options.delay_seed + i);
    try {
      link->join(
          {.scene_digest = scene.digest, .layer = layer.name, .host = "test", .kind = solve::to_word(layer.kind())}, 60);
      solve::run_session(scene, i, options.factory ? options.factory : launch::find_layer_factory(layer.kind()), *link,
                         sink);
    } catch (const std::exception&) {  // the coordinator has been told
    }
  };
  std::vector<std::jthread> threads;
  for (int i = 0; i < static_cast<int>(scene.layers.size()); ++i) threads.emplace_back(run_layer, i);
  const auto outcome = coordinator::run(
      scene, "test", hub.coordinator(), sink, [](auto&) {}, [](auto&) {});
  hub.close();
  threads.clear();
  return outcome;
}

inline InProcessResult run_in_process(const scene::Scene& scene, const InProcessOptions& options = {}) {
  InProcessResult result;
  result.outcome = run_in_process(scene, options, *result.sink);
  return result;
}

}  // namespace interply::test
