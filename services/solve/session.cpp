#include "solve/session.hpp"

#include <chrono>

#include "solve/layer_run.hpp"

namespace interply::solve {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double kWatchers = 0.2;  ///< s that whoever watches has for the last samples

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

}  // namespace

void run_session(const scene::Scene& scene, int layer, LayerFactory make_layer, exchange::SolverLink& link,
                 observe::Sink& sink) try {
  const mechanics::TriangleMesh mesh = make_layer_mesh(scene, layer);
  LayerRun run(scene, layer, mesh, make_layer(scene, layer, mesh));

  const double patience = scene.exchange.wait_deadline + scene.exchange.startup_deadline;
  exchange::Force force;
  force.force.resize(3, mesh.n_nodes());
  exchange::Motion& motion = run.motion();
  auto step_start = Clock::now();
  while (true) {
    link.send(motion);
    run.compute_internal_forces();  // while the coordinator computes contact
    const auto wait_start = Clock::now();
    link.receive(force, patience);
    motion.wait_seconds = seconds_since(wait_start);
    run.kick(force);
    if (force.frame == 0) sink.put(run.describe_mesh());  // everybody is here now, the recorder, too
    if (force.frame >= 0) sink.put(run.describe_frame(force.frame));
    if (force.last) break;
    run.drift(force.next_dt);
    motion.step_seconds = seconds_since(step_start);
    step_start = Clock::now();
  }
  link.send(run.describe_end());
  sink.flush(kWatchers);
  link.wait_until_received(patience);
} catch (const mechanics::Divergence& failure) {
  link.send_failure(failure.what());
  throw;
}

}  // namespace interply::solve
