#include <fmt/format.h>
#include <sys/stat.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <new>
#include <random>

#include "coordinator/coordinator.hpp"
#include "coordinator/tool_check.hpp"
#include "coordinator/voice.hpp"
#include "exchange/address.hpp"
#include "exchange/zeromq.hpp"
#include "mechanics/digest.hpp"
#include "observe/run_sink.hpp"
#include "observe/tee_sink.hpp"
#include "process/arguments.hpp"
#include "process/exit_codes.hpp"
#include "process/signals.hpp"
#include "scene/read_scene.hpp"
#include "solve/layer_mechanics.hpp"
#include "solve/link_sink.hpp"
#include "solve/session.hpp"
#include "solve/watch.hpp"

namespace {

using namespace interply;

/// Bytes of a frame that no solver exceeds: positions, fields, names.
std::int64_t limit_sample(const scene::Layer& layer, const mechanics::TriangleMesh& mesh) {
  constexpr std::int64_t kFieldComponents = 64, kNames = 1 << 16;
  const auto* vumat = std::get_if<scene::VumatLaw>(&layer.law);
  const std::int64_t components = kFieldComponents + (vumat ? vumat->state_variables : 0);
  return 8 * components * std::max(mesh.n_nodes(), mesh.n_elements()) + 256 * components + kNames;
}

std::vector<exchange::Expected> list_expected(const scene::Scene& scene) {
  std::vector<exchange::Expected> expected;
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    const mechanics::TriangleMesh mesh = solve::make_layer_mesh(scene, static_cast<int>(i));
    expected.push_back({.layer = scene.layers[i].name,
                        .n_nodes = mesh.n_nodes(),
                        .largest_sample = limit_sample(scene.layers[i], mesh),
                        .kind = solve::to_word(scene.layers[i].kind())});
  }
  return expected;
}

/// A name that no other run has, so that nothing of it is ever taken for another's.
std::string make_identity(const std::string& name) {
  std::random_device random;
  return fmt::format("{}-{:08x}{:08x}", name, random(), random());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Hosts contact, tools and time of one run and waits for its solvers and its recorder.\n"
      "Example: interply-coordinator --bind tcp://127.0.0.1:7100 --scene scene.yaml --run test"};
  std::string address, scene_file, digest, run_name = "run";
  std::vector<std::string> overrides;
  bool no_record = false, for_launcher = false;
  app.add_option(
         "--bind", address,
         "address to listen on: shm://PATH (one host, the fastest), ipc://PATH or tcp://HOST:PORT (port * chooses one)")
      ->required();
  app.add_option("--scene", scene_file, "scene file")->required();
  app.add_option("--set", overrides, "path=value that overrides a key of the scene");
  app.add_option("--scene-digest", digest, "digest that the resolved scene must have, 16 hexadecimal digits");
  app.add_option("--run", run_name, "name of this run; monitors use it");
  app.add_flag("--no-record", no_record, "do not wait for a recorder (nor without frames: record.frames=0)");
  app.add_flag("--for-launcher", for_launcher, "say lines that a launcher reads instead of sentences");
  if (const auto ended = process::read_arguments(app, exchange::kVersion, argc, argv)) return *ended;
  ::umask(0077);
  std::signal(SIGPIPE, SIG_IGN);  // whoever reads us may leave; the run goes on
  process::EndRequests requests(process::kCancelled);
  const auto voice = coordinator::make_voice(for_launcher);
  try {
    const scene::Scene scene = scene::read_scene(scene_file, overrides);
    if (!digest.empty() && digest != mechanics::to_hex(scene.digest))
      throw scene::SceneError(
          fmt::format("{}: is not the scene that this run was started with (digest {} instead of {}): "
                      "somebody has changed it meanwhile; start the run again",
                      scene_file, mechanics::to_hex(scene.digest), digest));
    coordinator::check_tools(scene);
    solve::check_network(scene);
    const bool keeps_record = scene.record.frames > 0 && !no_record;
    const std::string run = make_identity(run_name);
    const auto link = exchange::bind_zeromq(address, {scene.text, scene.digest, run}, list_expected(scene),
                                            exchange::ArraysBy::Mailbox, keeps_record, scene.exchange.wait_deadline);
    const auto listening = requests.tell([&](const std::string& why) { link->cancel(why); });
    voice->say_address(exchange::get_endpoint(*link), scene, keeps_record);
    voice->note("run " + run);
    observe::TeeSink sink(std::make_unique<solve::LinkSink<exchange::CoordinatorLink>>(*link),
                          observe::make_watch_sink(scene.record.frames > 0, solve::make_dds_options(scene, run)));
    const coordinator::Outcome outcome = coordinator::run(
        scene, run, *link, sink, [&](const coordinator::Progress& progress) { voice->show_progress(progress); },
        [&](const std::string& line) { voice->note(line); });
    voice->say_end(outcome, scene.record.frames + 1);
    process::end_within(process::kGrace, outcome.exit_code);  // whatever closing the links waits for
    return outcome.exit_code;
  } catch (const scene::SceneError& e) {
    voice->say_reason(e.what());
    return process::kRefused;
  } catch (const exchange::BadAddress& e) {
    voice->say_reason(std::string("--bind: ") + e.what());
    return process::kRefused;
  } catch (const std::bad_alloc&) {
    voice->say_reason("there is not enough memory");
    return process::kFailed;
  } catch (const std::exception& e) {
    voice->say_reason(e.what());
    return process::kFailed;
  }
}
