#include <sys/types.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <iostream>

#include "exchange/zeromq.hpp"
#include "observe/run_sink.hpp"
#include "scene/read_scene.hpp"
#include "solve/session.hpp"
#include "solve/watch.hpp"

namespace interply::solve {

namespace {

const char* name_of(scene::Kind kind) { return kind == scene::Kind::Fabric ? "fabric" : "metal"; }

int find_layer(const scene::Scene& scene, const std::string& name) {
  const auto found = std::find_if(scene.layers.begin(), scene.layers.end(), [&](auto& l) { return l.name == name; });
  return found == scene.layers.end() ? -1 : static_cast<int>(found - scene.layers.begin());
}

std::string host_name() {
  char name[256] = {};
  gethostname(name, sizeof name - 1);
  return name;
}

/// From joining to Final. @throws everything that run_session throws, Refused, SceneError
void integrate_layer(const std::string& address, const std::string& layer_name, const std::string& scene_file,
                     double deadline, scene::Kind kind, LayerFactory make_layer) {
  exchange::Join join{.layer = layer_name, .pid = static_cast<int>(getpid()), .host = host_name()};
  if (!scene_file.empty()) join.scene_digest = scene::read_scene(scene_file).digest;
  const auto link = exchange::connect_zeromq(address);
  const exchange::Welcome welcome = link->join(join, deadline);
  const scene::Scene scene = scene::parse_scene(welcome.scene_text, "scene of the coordinator");
  const int layer = find_layer(scene, layer_name);
  if (scene.layers.at(static_cast<std::size_t>(layer)).kind() != kind)
    throw exchange::Refused(
        layer_name + " is a " + name_of(kind == scene::Kind::Fabric ? scene::Kind::Metal : scene::Kind::Fabric) +
        " layer; start interply-solver-" +
        name_of(kind == scene::Kind::Fabric ? scene::Kind::Metal : scene::Kind::Fabric) + " for it");
  std::cout << "joined " << address << " as " << layer_name << " of run " << welcome.run << std::endl;
  check_network(scene);
  const auto sink = observe::make_run_sink(scene.record.frames > 0, make_dds_options(scene, welcome.run),
                                           scene.exchange.startup_deadline);
  run_session(scene, layer, make_layer, *link, *sink);
}

}  // namespace

int solver_main(int argc, char** argv, scene::Kind kind, LayerFactory make_layer) {
  CLI::App app{std::string("Integrates one ") + name_of(kind) + " layer of a run.\nExample: interply-solver-" +
               name_of(kind) + " --connect tcp://10.0.0.2:7100 --layer ply_2"};
  std::string address, layer, scene_file;
  double deadline = 60;
  app.add_option("--connect", address, "address of the coordinator, shm://PATH, ipc://PATH or tcp://HOST:PORT")
      ->required();
  app.add_option("--layer", layer, "name of the layer in the scene")->required();
  app.add_option("--scene", scene_file,
                 "scene file that must equal the coordinator's (default: take the coordinator's)");
  app.add_option("--deadline", deadline, "seconds to wait for the coordinator at start-up")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  std::signal(SIGINT, SIG_IGN);  // an interrupt is the coordinator's to handle: it stops every participant
  try {
    integrate_layer(address, layer, scene_file, deadline, kind, make_layer);
    return 0;
  } catch (const scene::SceneError& e) {
    std::cerr << e.what() << std::endl;
    return 2;
  } catch (const exchange::Refused& e) {
    std::cerr << "refused: " << e.what() << std::endl;
    return 2;
  } catch (const mechanics::Divergence& e) {
    std::cerr << e.what() << std::endl;
    return 3;
  } catch (const exchange::Stopped& e) {
    std::cerr << "stopped by the coordinator: " << e.what() << std::endl;
    return e.reason == exchange::StopReason::Diverged ? 3 : e.reason == exchange::StopReason::Cancelled ? 5 : 4;
  } catch (const std::exception& e) {
    std::cerr << e.what() << std::endl;
    return 4;
  }
}

}  // namespace interply::solve
