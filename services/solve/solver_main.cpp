#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <iostream>
#include <new>

#include "exchange/address.hpp"
#include "exchange/zeromq.hpp"
#include "observe/run_sink.hpp"
#include "observe/tee_sink.hpp"
#include "process/arguments.hpp"
#include "process/exit_codes.hpp"
#include "process/signals.hpp"
#include "process/words.hpp"
#include "scene/read_scene.hpp"
#include "solve/link_sink.hpp"
#include "solve/session.hpp"
#include "solve/watch.hpp"

namespace interply::solve {

namespace {

int find_layer(const scene::Scene& scene, const std::string& name) {
  const auto found = std::find_if(scene.layers.begin(), scene.layers.end(), [&](auto& l) { return l.name == name; });
  return found == scene.layers.end() ? -1 : static_cast<int>(found - scene.layers.begin());
}

/// Does the work and says what ended it, if that was not its end. @return the exit code
template <typename Work>
int say_how_it_ends(const Work& work) try {
  return work();
} catch (const scene::SceneError& e) {
  std::cerr << e.what() << std::endl;
  return process::kRefused;
} catch (const exchange::BadAddress& e) {
  std::cerr << "--connect: " << e.what() << std::endl;
  return process::kRefused;
} catch (const exchange::Refused& e) {
  std::cerr << "refused: " << process::to_line(e.what()) << std::endl;
  return process::kRefused;
} catch (const mechanics::Divergence& e) {
  std::cerr << e.what() << std::endl;
  return process::kDiverged;
} catch (const exchange::Stopped& e) {
  std::cerr << "stopped by the coordinator: " << process::to_line(e.what()) << std::endl;
  return e.reason == exchange::StopReason::Diverged    ? process::kDiverged
         : e.reason == exchange::StopReason::Cancelled ? process::kCancelled
                                                       : process::kLost;
} catch (const std::bad_alloc&) {
  std::cerr << "there is not enough memory" << std::endl;
  return process::kFailed;
} catch (const std::exception& e) {
  std::cerr << e.what() << std::endl;
  return process::kLost;
}

/// From joining to Final. @return the exit code   @throws Refused, SceneError, CoordinatorLost while joining
int integrate_layer(const std::string& address, const std::string& layer_name, const std::string& scene_file,
                    double deadline, double silence, scene::Kind kind, LayerFactory make_layer) {
  exchange::Join join{
      .layer = layer_name, .pid = static_cast<int>(getpid()), .host = process::host_name(), .kind = to_word(kind)};
  if (!scene_file.empty()) join.scene_digest = scene::read_scene(scene_file).digest;
  if (const std::string missing = exchange::find_missing_socket(address); !missing.empty())
    std::cout << "there is no socket " << missing << " yet; trying for " << deadline << " s" << std::endl;
  const auto link = exchange::connect_zeromq(address, silence);
  const exchange::Welcome welcome = link->join(join, deadline);
  const scene::Scene scene = scene::parse_scene(welcome.scene_text, "scene of the coordinator");
  const int layer = find_layer(scene, layer_name);
  std::cout << "joined " << address << " as " << layer_name << " of run " << welcome.run << std::endl;
  check_network(scene);
  observe::TeeSink sink(std::make_unique<LinkSink<exchange::SolverLink>>(*link, layer_name),
                        observe::make_watch_sink(scene.record.frames > 0, make_dds_options(scene, welcome.run)));
  const int exit_code = say_how_it_ends([&] {
    run_session(scene, layer, make_layer, *link, sink);
    return process::kDone;
  });
  process::end_within(process::kGrace, exit_code);  // whatever closing the links waits for
  return exit_code;
}

}  // namespace

int solver_main(int argc, char** argv, scene::Kind kind, LayerFactory make_layer) {
  CLI::App app{std::string("Integrates one ") + to_word(kind) + " layer of a run.\nExample: interply-solver-" +
               to_word(kind) + " --connect tcp://10.0.0.2:7100 --layer ply_2"};
  std::string address, layer, scene_file;
  double deadline = 60, silence = 60;
  app.add_option("--connect", address, "address of the coordinator, shm://PATH, ipc://PATH or tcp://HOST:PORT")
      ->required();
  app.add_option("--layer", layer, "name of the layer in the scene")->required();
  app.add_option("--scene", scene_file,
                 "scene file that must equal the coordinator's (default: take the coordinator's)");
  app.add_option("--deadline", deadline, "seconds to wait for the coordinator at start-up")->check(process::positive_seconds());
  app.add_option("--silence", silence,
                 "over TCP: seconds without a sign of life of the coordinator after which to leave")
      ->check(process::positive_seconds())
      ->capture_default_str();
  if (const auto ended = process::read_arguments(app, exchange::kVersion, argc, argv)) return *ended;
  ::umask(0077);
  std::signal(SIGPIPE, SIG_IGN);
  process::end_by_signals();
  return say_how_it_ends(
      [&] { return integrate_layer(address, layer, scene_file, deadline, silence, kind, make_layer); });
}

}  // namespace interply::solve
