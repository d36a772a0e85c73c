#include <pthread.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <iostream>
#include <sstream>
#include <thread>

#include "coordinator/coordinator.hpp"
#include "coordinator/tools.hpp"
#include "exchange/zeromq.hpp"
#include "observe/run_sink.hpp"
#include "scene/read_scene.hpp"
#include "solve/layer_mechanics.hpp"
#include "solve/watch.hpp"

namespace {

using namespace interply;

std::vector<exchange::Expected> list_expected(const scene::Scene& scene) {
  std::vector<exchange::Expected> expected;
  for (std::size_t i = 0; i < scene.layers.size(); ++i)
    expected.push_back(
        {.layer = scene.layers[i].name, .n_nodes = solve::make_layer_mesh(scene, static_cast<int>(i)).n_nodes()});
  return expected;
}

/// Turns SIGINT and SIGTERM into a cancelled run. All threads must have them blocked.
void watch_signals(exchange::CoordinatorLink& link) {
  std::thread([&link] {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    int signal = 0;
    while (sigwait(&set, &signal) == 0) link.cancel("interrupted");
  }).detach();
}

void block_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Hosts contact, tools and time of one run and waits for its solvers.\n"
      "Example: interply-coordinator --bind tcp://127.0.0.1:7100 --scene scene.yaml --run test"};
  std::string address, scene_file, run_name = "run";
  std::vector<std::string> overrides;
  app.add_option(
         "--bind", address,
         "address to listen on: shm://PATH (one host, the fastest), ipc://PATH or tcp://HOST:PORT (port * chooses one)")
      ->required();
  app.add_option("--scene", scene_file, "scene file")->required();
  app.add_option("--set", overrides, "path=value that overrides a key of the scene");
  app.add_option("--run", run_name, "unique name of this run; recorders and monitors use it");
  CLI11_PARSE(app, argc, argv);
  block_signals();
  try {
    const scene::Scene scene = scene::read_scene(scene_file, overrides);
    coordinator::check_tools(scene);
    solve::check_network(scene);
    const auto link = exchange::bind_zeromq(address, {scene.text, scene.digest, run_name}, list_expected(scene));
    watch_signals(*link);
    std::cout << "bound " << exchange::get_endpoint(*link) << std::endl;
    const auto sink = observe::make_run_sink(scene.record.frames > 0, solve::make_dds_options(scene, run_name),
                                             scene.exchange.startup_deadline);
    const coordinator::Outcome outcome = coordinator::run(
        scene, run_name, *link, *sink,
        [](const coordinator::Progress& p) {
          std::cout << "@progress " << coordinator::format_progress(p) << std::endl;
        },
        [](const std::string& line) { std::cout << line << std::endl; });
    if (!outcome.message.empty()) std::cerr << outcome.message << std::endl;
    std::istringstream summary(outcome.summary);
    for (std::string line; std::getline(summary, line);) std::cout << "@summary " << line << '\n';
    if (!outcome.digest.empty()) std::cout << "@digest " << outcome.digest << std::endl;
    return outcome.exit_code;
  } catch (const scene::SceneError& e) {
    std::cerr << e.what() << std::endl;
    return 2;
  } catch (const std::exception& e) {
    std::cerr << e.what() << std::endl;
    return 4;
  }
}
