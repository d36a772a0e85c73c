/// interply-recorder: keeps one run on disk.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>

#include "observe/dds.hpp"
#include "record/writer.hpp"

namespace {

using interply::observe::DdsOptions;
using interply::observe::DdsSubscriber;
using interply::observe::Role;
using interply::record::RecordWriter;

constexpr int kDone = 0, kFailed = 1, kCancelled = 5;
constexpr double kPoll = 0.2;         ///< s
constexpr double kStragglers = 10.0;  ///< s after the end of the run
constexpr double kSilence = 15.0;     ///< s without any publisher before the run counts as lost

volatile std::sig_atomic_t interrupted = 0;
void interrupt(int) { interrupted = 1; }

/// Seconds since a condition has become true.
class Stopwatch {
 public:
  double read(bool condition) {
    const Clock::time_point now = Clock::now();
    if (!condition) since_ = now;
    return std::chrono::duration<double>(now - since_).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point since_ = Clock::now();
};

/// Records until the run has ended. @return exit code
int record(DdsSubscriber& subscriber, RecordWriter& writer, const std::string& run, double patience) {
  Stopwatch waiting, ended, deserted;
  while (!interrupted) {
    const int received = subscriber.receive(writer, kPoll);
    if (writer.is_complete() && received == 0) {
      spdlog::info("run {} is recorded: {} frames", run, writer.frames_complete());
      return kDone;
    }
    if (ended.read(writer.has_end()) > kStragglers) {
      spdlog::error("run {} has ended, but {} after {} s; {} complete frames are kept", run, writer.describe_missing(),
                    kStragglers, writer.frames_complete());
      return kFailed;
    }
    if (waiting.read(!writer.has_header()) > patience) {
      spdlog::error(
          "run {} has published no header within {} s: has its coordinator started, on this network and domain?", run,
          patience);
      return kFailed;
    }
    if (deserted.read(writer.has_header() && !writer.has_end() && !subscriber.has_publishers()) > kSilence) {
      spdlog::error(
          "everyone who published run {} has gone for {} s without saying how it ended; {} complete frames are kept",
          run, kSilence, writer.frames_complete());
      return kFailed;
    }
  }
  spdlog::warn("interrupted: the record of run {} is closed with {} complete frames", run, writer.frames_complete());
  return kCancelled;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Keeps a run on disk: DIR/record.h5 and DIR/record.xdmf, valid after every frame.\n"
      "Example: interply-recorder --run tetrahedron-1 --out results"};
  DdsOptions options;
  std::string out;
  bool overwrite = false;
  double patience = 120;
  app.add_option("--run", options.run, "unique name of the run, as the coordinator publishes it")->required();
  app.add_option("--out", out, "folder of the record")->required();
  app.add_option("--network", options.network, "address of the network interface")->capture_default_str();
  app.add_option("--domain", options.domain, "DDS domain")->capture_default_str();
  app.add_flag("--multicast", options.multicast, "find participants by multicast");
  app.add_flag("--overwrite", overwrite, "replace an existing record");
  app.add_option("--wait", patience, "longest wait for the run to begin, s")->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  spdlog::set_default_logger(spdlog::stderr_color_mt("recorder"));
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  try {
    RecordWriter writer(std::filesystem::path(out) / "record.h5", overwrite);
    DdsSubscriber subscriber(options, Role::Recorder);
    const int code = record(subscriber, writer, options.run, patience);
    writer.close();
    return code;
  } catch (const std::exception& e) {
    spdlog::error("{}", e.what());
    return kFailed;
  }
}
