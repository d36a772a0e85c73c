/// A coordinator's link without anybody behind it: layers that stay where they are, and events as a test writes them.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "coordinator/coordinator.hpp"
#include "coordinator/stack.hpp"
#include "paths.hpp"
#include "scene/read_scene.hpp"
#include "solve/layer_mechanics.hpp"
#include "support/memory_sink.hpp"

namespace interply::test {

inline scene::Scene read_flat_stack(const std::vector<std::string>& overrides = {}) {
  return scene::read_scene(std::string(INTERPLY_SOURCE_DIR) + "/tests/scenes/flat_stack.yaml", overrides);
}

/// A motion that arrives, and the contact that it completes.
inline void accept(coordinator::Stack& stack, int i, const exchange::Motion& motion, double dt) {
  stack.take_motion(i, motion.position, motion.thickness, motion.vote);
  stack.compute_contact_of(i, dt);
}

/// Every answered layer sends its motion of the next step, or its Final after the last one, unless `on_answer` says
/// otherwise. `eager`: at once, before whatever else is in the queue.
class ScriptedLink : public exchange::CoordinatorLink {
 public:
  using Event = exchange::Event;
  using Kind = exchange::Event::Kind;

  explicit ScriptedLink(const scene::Scene& scene) : motions_(scene.layers.size()) {
    for (std::size_t i = 0; i < motions_.size(); ++i) {
      motions_[i].position = solve::make_layer_mesh(scene, static_cast<int>(i)).reference;
      motions_[i].vote = 1e-6;
    }
    join_.host = "script";
  }

  void push(Event event) { eager ? events.push_front(std::move(event)) : events.push_back(std::move(event)); }
  void everyone_joins_and_moves() {
    for (int i = 0; i < n_layers(); ++i) events.push_back({.kind = Kind::Joined, .who = i});
    for (int i = 0; i < n_layers(); ++i) events.push_back({.kind = Kind::Moved, .who = i});
  }
  exchange::Motion& motion_of(int who) { return motions_[static_cast<std::size_t>(who)]; }  ///< what it sends
  int n_layers() const { return static_cast<int>(motions_.size()); }

  Event receive(double timeout) override {
    if (events.empty()) {
      std::this_thread::sleep_for(std::chrono::duration<double>(timeout));
      return {};
    }
    Event event = events.front();
    events.pop_front();
    if (event.kind == Kind::Moved) order.push_back(event.who);
    return event;
  }
  const exchange::Motion& motion(int who) const override { return motions_[static_cast<std::size_t>(who)]; }
  const exchange::Join& joined(int) const override { return join_; }
  bool send(int who, const exchange::Force& force) override {
    if (gone == who) return false;
    answers.push_back({who, force.step});
    if (on_answer) return on_answer(who, force), true;
    answer(who, force);
    return true;
  }
  /// What a layer does by itself.
  void answer(int who, const exchange::Force& force) {
    push(force.last ? Event{.kind = Kind::Ended, .who = who, .final = {.digest = static_cast<std::uint64_t>(who)}}
                    : Event{.kind = Kind::Moved, .who = who});
  }
  void stop(exchange::StopReason reason, const std::string& message) override { stopped.push_back({reason, message}); }
  void cancel(const std::string& message) override { events.push_front({.kind = Kind::Cancelled, .message = message}); }

  bool eager = false;
  int gone = -1;  ///< whose answer cannot be delivered
  std::deque<Event> events;
  std::vector<std::pair<int, std::int64_t>> answers;  ///< (layer, step) in the order they were sent
  std::vector<int> order;                             ///< who moved, in order
  std::vector<std::pair<exchange::StopReason, std::string>> stopped;
  std::function<void(int, const exchange::Force&)> on_answer;

 private:
  std::vector<exchange::Motion> motions_;
  exchange::Join join_;
};

/// A run over such a link with what it said.
struct ScriptedRun {
  coordinator::Outcome outcome;
  MemorySink sink;
  std::vector<std::string> log;
  std::vector<coordinator::Progress> progress;
  void run(const scene::Scene& scene, ScriptedLink& link) {
    outcome = coordinator::run(
        scene, "scripted", link, sink, [&](auto& p) { progress.push_back(p); }, [&](auto& l) { log.push_back(l); });
  }
};

}  // namespace interply::test
