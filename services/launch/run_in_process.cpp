#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "coordinator/coordinator.hpp"
#include "exchange/in_process.hpp"
#include "launch/layer_factories.hpp"
#include "launch/run.hpp"
#include "observe/run_sink.hpp"
#include "process/signals.hpp"
#include "record/writer.hpp"

namespace interply::launch {
namespace {

/// Turns the first SIGINT, SIGTERM or SIGHUP into a cancelled run, the second into the end of the process. Threads that
/// are started later do not receive these signals.
class SignalWatch {
 public:
  explicit SignalWatch(std::function<void(int signal)> cancel) : cancel_(std::move(cancel)) {
    handled_ = process::list_end_signals();
    pthread_sigmask(SIG_BLOCK, &handled_, &old_mask_);
    thread_ = std::thread([this] { wait(); });
  }
  ~SignalWatch() {
    done_ = true;
    pthread_kill(thread_.native_handle(), SIGTERM);
    thread_.join();
    pthread_sigmask(SIG_SETMASK, &old_mask_, nullptr);
  }
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

 private:
  void wait() {
    for (int count = 0;; ++count) {
      int signal = 0;
      sigwait(&handled_, &signal);
      if (done_) return;
      if (count > 0) std::_Exit(kCancelled);
      cancel_(signal);
    }
  }
  std::function<void(int signal)> cancel_;
  sigset_t handled_{}, old_mask_{};
  std::atomic<bool> done_ = false;
  std::thread thread_;
};

/// The record, whose failure ends the run in order instead of one of its threads.
class Record : public observe::Sink {
 public:
  explicit Record(const std::filesystem::path& file) : writer_(file) {}
  void put(const observe::RunHeader& a) override { keep(a); }
  void put(const observe::LayerMesh& a) override { keep(a); }
  void put(const observe::LayerFrame& a) override { keep(a); }
  void put(const observe::InterfaceFrame& a) override { keep(a); }
  void put(const observe::ToolFrame& a) override { keep(a); }
  void put(const observe::HistoryRow& a) override { keep(a); }
  void put(const observe::RunEnd& a) override {
    writer_.put(a);
    guard([&] { writer_.close(); });
  }
  bool flush(double) override { return true; }
  std::string failure() const override {
    const std::lock_guard lock(mutex_);
    return failure_;
  }

 private:
  template <typename T>
  void keep(const T& a) {
    if (failure().empty()) guard([&] { writer_.put(a); });
  }
  template <typename Action>
  void guard(Action&& action) try {
    action();
  } catch (const std::exception& e) {
    const std::lock_guard lock(mutex_);
    if (failure_.empty()) failure_ = e.what();
  }
  record::RecordWriter writer_;
  mutable std::mutex mutex_;
  std::string failure_;
};

std::vector<exchange::Expected> list_expected(const scene::Scene& scene) {
  std::vector<exchange::Expected> expected;
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    const scene::Layer& layer = scene.layers[i];
    expected.push_back({.layer = layer.name,
                        .n_nodes = solve::make_layer_mesh(scene, static_cast<int>(i)).n_nodes(),
                        .kind = solve::to_word(layer.kind())});
  }
  return expected;
}

/// A solver process as a thread. What it throws, the coordinator has been told or finds out by the closed link.
void run_layer(const scene::Scene& scene, int index, exchange::InProcessHub& hub, observe::Sink& sink,
               const std::function<void(const std::string&)>& log) {
  const auto& layer = scene.layers[static_cast<std::size_t>(index)];
  try {
    const auto link = hub.connect();
    link->join(
        {.scene_digest = scene.digest, .layer = layer.name, .host = "in-process", .kind = solve::to_word(layer.kind())},
        scene.exchange.startup_deadline);
    solve::run_session(scene, index, find_layer_factory(layer.kind()), *link, sink);
  } catch (const exchange::Stopped&) {  // the coordinator says why
  } catch (const mechanics::Divergence&) {
  } catch (const std::exception& e) {
    log(layer.name + ": " + e.what());
  }
}

constexpr double kLayersAfterCoordinator = 5;  ///< s, as the solvers of a federation are given

/// A law of the user's own that never returns keeps its thread: then only the end of the process ends it.
void leave_if_stuck(const std::atomic<int>& running, const coordinator::Outcome& outcome, Terminal& terminal) {
  const auto start = std::chrono::steady_clock::now();
  while (running > 0) {
    if (std::chrono::steady_clock::now() - start > std::chrono::duration<double>(kLayersAfterCoordinator)) {
      terminal.end_progress();
      std::fprintf(stderr, "interply: %s; its thread does not return\n", outcome.message.c_str());
      std::fflush(nullptr);
      std::_Exit(outcome.exit_code);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace

RunResult run_in_process(const scene::Scene& scene, const RunFolder& folder, const std::string& run_name,
                         Terminal& terminal) {
  std::unique_ptr<observe::Sink> sink = std::make_unique<observe::NullSink>();
  if (scene.record.frames > 0) sink = std::make_unique<Record>(folder.record());
  std::mutex terminal_mutex;
  const auto log = [&](const std::string& line) {
    const std::lock_guard lock(terminal_mutex);
    terminal.note(line);
  };
  const auto report = [&](const coordinator::Progress& progress) {
    const std::lock_guard lock(terminal_mutex);
    terminal.show_progress(coordinator::format_progress(progress));
  };

  exchange::InProcessHub hub(scene.digest, list_expected(scene));
  const SignalWatch watch([&](int signal) { hub.coordinator().cancel(process::describe_request(signal)); });
  coordinator::Outcome outcome;
  {
    std::vector<std::jthread> layers;
    std::atomic<int> running = static_cast<int>(scene.layers.size());
    for (int i = 0; i < static_cast<int>(scene.layers.size()); ++i) {
      layers.emplace_back([&, i] {
        run_layer(scene, i, hub, *sink, log);
        --running;
      });
    }
    outcome = coordinator::run(scene, run_name, hub.coordinator(), *sink, report, log);
    hub.close();
    if (outcome.exit_code != kDone) leave_if_stuck(running, outcome, terminal);
  }
  if (outcome.exit_code == kDone && !sink->failure().empty()) {  // at the last moment
    outcome.exit_code = kFailed;
    outcome.message = sink->failure();
  }
  const bool done = outcome.exit_code == kDone;
  return {outcome.exit_code, done ? "" : describe_early_end(outcome.exit_code, outcome.message), outcome.summary,
          outcome.digest, outcome.summary_json};
}

}  // namespace interply::launch
