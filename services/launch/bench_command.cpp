#include "launch/bench_command.hpp"

#include <CLI/CLI.hpp>

#include "bench/carriers.hpp"
#include "launch/run.hpp"

namespace interply::launch {
namespace {

/// Both benchmarks within two minutes.
int bench_shortly(std::ostream& out) {
  BenchExchangeOptions exchange;
  exchange.nodes = {1000, 5041};
  exchange.seconds = 0.3;
  exchange.rounds = 3;
  const int exit_code = bench_exchange_command(exchange, out);
  if (exit_code == kCancelled) return exit_code;
  out << std::endl;
  BenchStackOptions stack;
  stack.rounds = 1;
  const int stack_code = bench_stack_command(stack, out);
  return exit_code == kDone ? stack_code : exit_code;
}

void add_exchange(CLI::App& bench, BenchExchangeOptions& options) {
  auto* exchange = bench.add_subcommand("exchange", "wall and CPU time of a step of the exchange, by carrier");
  exchange->add_option("--peers", options.peers, "solvers of the star")->delimiter(',')->check(CLI::Range(1, 64));
  exchange->add_option("--nodes", options.nodes, "nodes of each solver")->delimiter(',')->check(CLI::Range(1, 1000000));
  exchange->add_option("--seconds", options.seconds, "measured per carrier and size")->check(CLI::Range(0.001, 3600.0));
  exchange->add_option("--rounds", options.rounds, "that these seconds are divided into; each measures all carriers")
      ->check(CLI::Range(1, 1000));
  std::string names;
  for (const auto& carrier : bench::list_carriers()) names += (names.empty() ? "" : ", ") + carrier.name;
  exchange->add_option("--carriers", options.carriers, "some of " + names)->delimiter(',');
  exchange->footer(
      R"(A row is the median over the rounds. CPU time is that of all processes. "x wall" and "x CPU" compare with the raw
carrier that moves bytes in the same way, round by round. The digest tells what arrived, and depends on the size alone.

example:
  interply bench exchange --peers 5 --nodes 5041 --carriers zeromq-ipc,raw-unix --seconds 3
)");
}

void add_stack(CLI::App& bench, BenchStackOptions& options) {
  auto* stack = bench.add_subcommand("stack", "a whole run, federated and in one process");
  stack
      ->add_option("scene", options.scene, "scene file (default: deploy/scenes/tetrahedron_fml.yaml, 1500 steps of it)")
      ->type_name("SCENE");
  stack->add_option("--set", options.overrides, "override any key of the scene; may be repeated")
      ->type_name("PATH=VALUE")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false);
  stack->add_option("--rounds", options.rounds, "runs of each kind, in turn")->check(CLI::Range(1, 1000));
  stack->footer(
      R"("loop s" is wall time in the steps, "around s" before and after them; "/CPU s" are element-steps per second of CPU
time of all processes, start and end included. "contact %" is the coordinator's share of that CPU time, "hub waits %" the
share of its wall time that it waits for layers, "wait %" that of a layer waiting for the coordinator.

example:
  interply bench stack --rounds 5 --set layers.ply_2.threads=2
)");
}

/// What a star's processes are started with.
void add_star(CLI::App& bench, BenchStarOptions& options) {
  for (const char* name : {"hub", "peer"}) {
    auto* star = bench.add_subcommand(name, "started by exchange")->group("");
    star->add_option("--carrier", options.carrier);
    star->add_option("--folder", options.folder);
    star->add_option("--address", options.address);
    star->add_option("--peers", options.peers);
    star->add_option("--nodes", options.nodes);
    star->add_option("--peer", options.peer);
    star->add_option("--seconds", options.seconds);
  }
}

}  // namespace

CLI::App* add_bench(CLI::App& app, BenchOptions& options) {
  auto* bench = app.add_subcommand("bench", "measure this machine: the exchange, and a whole run");
  bench->require_subcommand(0, 1);
  add_exchange(*bench, options.exchange);
  add_stack(*bench, options.stack);
  add_star(*bench, options.star);
  bench->footer(R"(Without `exchange` or `stack` it runs both shortly, in less than two minutes.

example:
  interply bench
  interply bench exchange --peers 5 --nodes 5041
)");
  return bench;
}

int bench_command(const CLI::App& bench, const BenchOptions& options, std::ostream& out) {
  const auto chosen = bench.get_subcommands();
  if (chosen.empty()) return bench_shortly(out);
  const std::string name = chosen.front()->get_name();
  if (name == "exchange") return bench_exchange_command(options.exchange, out);
  if (name == "stack") return bench_stack_command(options.stack, out);
  return name == "hub" ? bench_hub_command(options.star) : bench_peer_command(options.star);
}

}  // namespace interply::launch
