/// interply-recorder: keeps one run on disk. It takes part in the run over the exchange as a solver does, so nothing is
/// lost on the way, and the run waits for it.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <optional>
#include <string>

#include "exchange/address.hpp"
#include "exchange/zeromq.hpp"
#include "observe/sample.hpp"
#include "process/arguments.hpp"
#include "process/exit_codes.hpp"
#include "process/signals.hpp"
#include "process/words.hpp"
#include "record/file.hpp"
#include "record/run_folder.hpp"
#include "record/writer.hpp"

namespace {

using namespace interply;
using exchange::StopReason;
using record::Misfit;
using record::RecordWriter;

using enum process::ExitCode;
constexpr double kPoll = 0.2;  ///< s

std::atomic<bool> interrupted = false;

/// Lets through what the participant may say: a solver speaks for its own layer, everything else is the coordinator's.
class Gate : public observe::Sink {
 public:
  Gate(RecordWriter& writer, const std::string& layer) : writer_(writer), layer_(layer) {}
  void put(const observe::RunHeader& a) override { pass(a, ""); }
  void put(const observe::LayerMesh& a) override { pass(a, a.layer); }
  void put(const observe::LayerFrame& a) override { pass(a, a.layer); }
  void put(const observe::InterfaceFrame& a) override { pass(a, ""); }
  void put(const observe::ToolFrame& a) override { pass(a, ""); }
  void put(const observe::HistoryRow& a) override { pass(a, ""); }
  void put(const observe::RunEnd& a) override { pass(a, ""); }
  bool flush(double) override { return true; }

 private:
  template <typename T>
  void pass(const T& a, const std::string& owner) {
    if (owner != layer_) throw Misfit("is not its own");
    writer_.put(a);
  }
  RecordWriter& writer_;
  const std::string& layer_;
};

/// @throws Misfit naming the participant; std::runtime_error if the disk fails
void keep(const exchange::Sample& sample, RecordWriter& writer) {
  Gate gate(writer, sample.layer);
  const auto refuse = [&](const char* why) {
    throw Misfit(
        fmt::format("a sample of {} cannot be kept: {}", sample.layer.empty() ? "the coordinator" : sample.layer, why));
  };
  try {
    observe::decode_sample(sample.payload, gate);
  } catch (const Misfit& misfit) {
    refuse(misfit.what());
  } catch (const std::invalid_argument& unreadable) {
    refuse(unreadable.what());
  }
}

/// Records until the run has ended. @return exit code
int record_run(exchange::RecorderLink& link, RecordWriter& writer) {
  exchange::Recorded told;
  const auto tell = [&] {
    writer.flush(0);
    const exchange::Recorded now{writer.frames_complete(), writer.rows_settled(), false};
    if (now.frames == told.frames && now.rows == told.rows) return;
    link.send(now);
    told = now;
  };
  while (!interrupted) {
    std::optional<exchange::Sample> sample = link.receive(0);
    if (!sample) {  // a moment to write the history rows that have come together
      tell();
      sample = link.receive(kPoll);
    }
    if (!sample) continue;
    keep(*sample, writer);
    if (writer.has_end()) {
      writer.close();
      link.send(exchange::Recorded{writer.frames_complete(), writer.rows_settled(), true});
      spdlog::info("the record is closed with {} frames", writer.frames_complete());
      return kDone;
    }
    if (writer.frames_complete() > told.frames) tell();
  }
  writer.close();
  spdlog::warn("interrupted: the record is closed with {} complete frames", writer.frames_complete());
  return kCancelled;
}

/// Closes the record of a run that cannot be recorded any further. @return exit code
int break_off(RecordWriter& writer, const std::string& status, const std::string& message, int code) {
  spdlog::error("{}", message);
  writer.put(observe::RunEnd{.status = status, .message = message, .digest = "", .frames_complete = 0, .summary = ""});
  writer.close();
  return code;
}

int take_part(exchange::RecorderLink& link, RecordWriter& writer) {
  try {
    return record_run(link, writer);
  } catch (const exchange::CoordinatorLost& lost) {
    return break_off(writer, "lost", lost.what(), kLost);
  } catch (const Misfit& misfit) {
    link.send_failure(StopReason::Lost, misfit.what());
    return break_off(writer, "lost", misfit.what(), kLost);
  } catch (const std::exception& failure) {
    link.send_failure(StopReason::Failed, failure.what());
    return break_off(writer, "failed", failure.what(), kFailed);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Keeps a run on disk: DIR/record.h5 and DIR/record.xdmf, valid after every frame.\n"
      "Example: interply-recorder --connect tcp://10.0.0.2:7100 --out results"};
  std::string address, out;
  bool overwrite = false, folder_is_taken = false;
  double deadline = 60, silence = 60;
  app.add_option("--connect", address, "address of the coordinator, shm://PATH, ipc://PATH or tcp://HOST:PORT")
      ->required();
  app.add_option("--out", out, "folder of the record")->required();
  app.add_flag("--overwrite", overwrite, "replace an existing record");
  app.add_flag("--folder-taken", folder_is_taken, "whoever started this process has the folder for it");
  app.add_option("--deadline", deadline, "seconds to wait for the coordinator at start-up")->check(process::positive_seconds());
  app.add_option("--silence", silence, "seconds without a sign of life of the coordinator after which to leave")
      ->check(process::positive_seconds())
      ->capture_default_str();
  if (const auto ended = process::read_arguments(app, exchange::kVersion, argc, argv)) return *ended;

  ::umask(0077);
  spdlog::set_default_logger(spdlog::stderr_color_mt("recorder"));
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);  // a write that fails says so
  process::EndRequests requests(kCancelled);
  const auto listening = requests.tell([](const std::string&) { interrupted = true; });
  try {
    std::optional<record::FolderLock> lock;
    if (!folder_is_taken) lock.emplace(out, "recorder of " + process::to_line(address));
    RecordWriter writer(std::filesystem::path(out) / "record.h5", overwrite);
    if (const std::string missing = exchange::find_missing_socket(address); !missing.empty())
      spdlog::info("there is no socket {} yet; trying for {} s", missing, deadline);
    const auto link = exchange::connect_recorder(address, silence);
    const exchange::Welcome welcome = link->join(
        {.layer = exchange::kRecorder,
         .pid = static_cast<int>(getpid()),
         .host = process::host_name(),
         .kind = exchange::kRecorder},
        deadline);
    spdlog::info("joined {} as the recorder of run {}", address, welcome.run);
    const int exit_code = take_part(*link, writer);
    process::end_within(process::kGrace, exit_code);  // whatever closing the link waits for
    return exit_code;
  } catch (const record::FolderRefused& e) {
    spdlog::error("{}", e.what());
    return kRefused;
  } catch (const exchange::BadAddress& e) {
    spdlog::error("--connect: {}", e.what());
    return kRefused;
  } catch (const exchange::Refused& e) {
    spdlog::error("refused: {}", process::to_line(e.what()));
    return kRefused;
  } catch (const exchange::Stopped& e) {
    spdlog::error("stopped by the coordinator: {}", process::to_line(e.what()));
    return e.reason == StopReason::Cancelled ? kCancelled : kLost;
  } catch (const exchange::CoordinatorLost& e) {
    spdlog::error("{}", e.what());
    return kLost;
  } catch (const std::exception& e) {
    spdlog::error("{}", e.what());
    return kFailed;
  }
}
