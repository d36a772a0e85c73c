/// The recorder as a process of its own, fed through DDS by this one.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "observe/dds.hpp"
#include "paths.hpp"
#include "record/reader.hpp"
#include "sample_run.hpp"

namespace interply::record {
namespace {

using observe::DdsOptions;
using observe::DdsSink;
using test::run_check;
using test::SampleRun;
using test::TemporaryFolder;

/// interply-recorder as a child process, killed at the end if it still runs.
class Recorder {
 public:
  Recorder(const TemporaryFolder& folder, const std::string& run, const std::vector<std::string>& more = {})
      : log_(folder / "recorder.log") {
    std::vector<std::string> words = {INTERPLY_BIN_DIR "/interply-recorder", "--run", run, "--out",
                                      folder.path().string()};
    words.insert(words.end(), more.begin(), more.end());
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 2, log_.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    if (posix_spawn(&pid_, arguments[0], &actions, nullptr, arguments.data(), environ) != 0) pid_ = -1;
    posix_spawn_file_actions_destroy(&actions);
  }
  ~Recorder() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      wait();
    }
  }
  void send(int signal) const { kill(pid_, signal); }
  /// Waits for its end. @return exit code, or minus the signal that killed it
  int wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  std::string log() const {
    std::ostringstream text;
    text << std::ifstream(log_).rdbuf();
    return text.str();
  }

 private:
  std::filesystem::path log_;
  pid_t pid_ = -1;
};

DdsOptions make_options(const std::string& name) {
  return {.network = "127.0.0.1", .multicast = false, .domain = 0, .run = name + "-" + std::to_string(getpid())};
}

/// Waits until the record at `file` has so many frames. @return whether it has
bool wait_for_frames(const std::filesystem::path& file, int frames) {
  for (int i = 0; i < 600; ++i) {
    if (std::filesystem::exists(file) && RecordReader(file).frames_complete() >= frames) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

TEST(Recorder, RecordsARunOfSeveralParticipantsToItsEnd) {
  const TemporaryFolder folder;
  const DdsOptions options = make_options("whole");
  Recorder recorder(folder, options.run);
  DdsSink coordinator(options), ply(options), sheet(options);
  for (DdsSink* sink : {&coordinator, &ply, &sheet}) ASSERT_TRUE(sink->wait_for_reader(30));
  const SampleRun run(3, 30);
  sheet.put(run.mesh(1));
  coordinator.put(run.header());
  ply.put(run.mesh(0));
  for (int k = 0; k < 4; ++k) {
    sheet.put(run.layer_frame(1, k));
    coordinator.put(run.tool_frame(k));
    for (int i = 0; i < 2; ++i) coordinator.put(run.interface_frame(i, k));
    ply.put(run.layer_frame(0, k));
    coordinator.put(run.history_row(k));
  }
  coordinator.put(run.end(4));
  for (DdsSink* sink : {&coordinator, &ply, &sheet}) EXPECT_TRUE(sink->flush(10));
  EXPECT_EQ(recorder.wait(), 0) << recorder.log();
  EXPECT_EQ(run_check("values " + (folder / "record.h5").string() + " 4 4 done"), 0);
  EXPECT_EQ(run_check("xdmf " + (folder / "record.xdmf").string() + " 4"), 0);
}

TEST(Recorder, FramesOfManyMegabytesArriveIntact) {
  const TemporaryFolder folder;
  const DdsOptions options = make_options("large");
  Recorder recorder(folder, options.run);
  DdsSink sink(options);
  ASSERT_TRUE(sink.wait_for_reader(30));
  const SampleRun run(3, 200);  // 40 000 nodes, 79 202 elements: 6.4 MB per frame and layer
  run.put_start(sink);
  for (int k = 0; k < 4; ++k) run.put_frame(sink, k);
  sink.put(run.end(4));
  EXPECT_TRUE(sink.flush(30));
  EXPECT_EQ(recorder.wait(), 0) << recorder.log();
  EXPECT_EQ(run_check("values " + (folder / "record.h5").string() + " 4 0 done"), 0);
}

TEST(Recorder, KilledInMidRunLeavesEveryCompletedFrame) {
  const TemporaryFolder folder;
  const DdsOptions options = make_options("killed");
  Recorder recorder(folder, options.run);
  DdsSink sink(options);
  ASSERT_TRUE(sink.wait_for_reader(30));
  const SampleRun run(20, 40, 40);
  run.put_start(sink);
  for (int k = 0; k < 5; ++k) {
    sink.put(run.history_row(k));
    run.put_frame(sink, k);
  }
  sink.put(run.layer_frame(0, 5));  // frame 5 stays incomplete
  ASSERT_TRUE(wait_for_frames(folder / "record.h5", 5)) << recorder.log();
  recorder.send(SIGKILL);
  EXPECT_EQ(recorder.wait(), -SIGKILL);
  // h5py opens it, finds frames 0 to 4 whole and the rest not complete.
  EXPECT_EQ(RecordReader(folder / "record.h5").frames_complete(), 5);
  EXPECT_EQ(RecordReader(folder / "record.h5").read_text("status"), "running");
  EXPECT_EQ(run_check("attributes " + (folder / "record.h5").string()), 0);
  EXPECT_EQ(run_check("prefix " + (folder / "record.h5").string() + " 5"), 0);
  EXPECT_EQ(run_check("xdmf " + (folder / "record.xdmf").string() + " 5"), 0);
}

TEST(Recorder, KilledAtAnyMomentLeavesAValidRecord) {
  for (int attempt = 0; attempt < 8; ++attempt) {
    const TemporaryFolder folder;
    const DdsOptions options = make_options("any" + std::to_string(attempt));
    Recorder recorder(folder, options.run);
    DdsSink sink(options);
    ASSERT_TRUE(sink.wait_for_reader(30));
    const SampleRun run(200, 30, 2000);
    run.put_start(sink);
    run.put_frame(sink, 0);
    ASSERT_TRUE(wait_for_frames(folder / "record.h5", 1));
    std::thread killer([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(3 + 7 * attempt));
      recorder.send(SIGKILL);
    });
    for (int k = 1; k <= 60; ++k) {
      run.put_frame(sink, k);
      sink.put(run.history_row(k - 1));
    }
    killer.join();
    EXPECT_EQ(recorder.wait(), -SIGKILL);
    const int frames = RecordReader(folder / "record.h5").frames_complete();
    EXPECT_GE(frames, 1);
    EXPECT_EQ(run_check("prefix " + (folder / "record.h5").string() + " " + std::to_string(frames)), 0);
  }
}

TEST(Recorder, InterruptClosesTheRecord) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const TemporaryFolder folder;
    const DdsOptions options = make_options("interrupt" + std::to_string(signal));
    Recorder recorder(folder, options.run);
    DdsSink sink(options);
    ASSERT_TRUE(sink.wait_for_reader(30));
    const SampleRun run;
    run.put_start(sink);
    run.put_frame(sink, 0);
    ASSERT_TRUE(wait_for_frames(folder / "record.h5", 1));
    recorder.send(signal);
    EXPECT_EQ(recorder.wait(), 5);
    EXPECT_EQ(run_check("values " + (folder / "record.h5").string() + " 1 0 interrupted"), 0);
  }
}

TEST(Recorder, NamesTheParticipantWhoseFrameIsMissing) {
  const TemporaryFolder folder;
  const DdsOptions options = make_options("straggler");
  Recorder recorder(folder, options.run);
  DdsSink sink(options);
  ASSERT_TRUE(sink.wait_for_reader(30));
  const SampleRun run;
  run.put_start(sink);
  run.put_frame(sink, 0);
  sink.put(run.layer_frame(0, 1));
  for (int i = 0; i < 2; ++i) sink.put(run.interface_frame(i, 1));
  sink.put(run.tool_frame(1));
  sink.put(run.end(2));
  EXPECT_EQ(recorder.wait(), 1);
  EXPECT_THAT(recorder.log(), testing::HasSubstr("frame 1 of layer 'sheet' is missing"));
  EXPECT_EQ(RecordReader(folder / "record.h5").frames_complete(), 1);
  EXPECT_EQ(RecordReader(folder / "record.h5").read_text("status"), "done");
}

TEST(Recorder, RefusesToOverwriteUnlessTold) {
  const TemporaryFolder folder;
  std::ofstream(folder / "record.h5") << "precious";
  Recorder refused(folder, "refused");
  EXPECT_EQ(refused.wait(), 1);
  EXPECT_THAT(refused.log(), testing::HasSubstr("record.h5 exists already"));
  EXPECT_EQ(std::filesystem::file_size(folder / "record.h5"), 8u);
  Recorder told(folder, "told-" + std::to_string(getpid()), {"--overwrite", "--wait", "0.5"});
  EXPECT_EQ(told.wait(), 1);
  EXPECT_THAT(told.log(), testing::HasSubstr("has published no header within 0.5 s"));
}

TEST(Recorder, ThatHangsDoesNotStopTheRun) {
  const TemporaryFolder folder;
  const DdsOptions options = make_options("hanging");
  Recorder recorder(folder, options.run);
  DdsSink sink(options);
  ASSERT_TRUE(sink.wait_for_reader(30));
  recorder.send(SIGSTOP);
  const SampleRun run(30, 200);
  const observe::LayerFrame frame = run.layer_frame(0, 0);  // 6.4 MB
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 20; ++i) sink.put(frame);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
  EXPECT_FALSE(sink.flush(0.1));
}

}  // namespace
}  // namespace interply::record
