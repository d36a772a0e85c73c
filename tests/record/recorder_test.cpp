/// The recorder as a process of its own, in a run whose coordinator and layers are in this one.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "exchange/zeromq.hpp"
#include "paths.hpp"
#include "record/reader.hpp"
#include "record/writer.hpp"
#include "sample_run.hpp"
#include "solve/link_sink.hpp"

namespace interply::record {
namespace {

using exchange::Event;
using exchange::StopReason;
using test::run_check;
using test::SampleRun;
using test::TemporaryFolder;
using testing::HasSubstr;

constexpr double kPatience = 60;  ///< s; nothing in a test that passes waits this long

/// interply-recorder as a child process, killed at the end if it still runs.
class Recorder {
 public:
  Recorder(const TemporaryFolder& folder, const std::string& address, const std::vector<std::string>& more = {},
           const std::vector<std::string>& environment = {})
      : log_(folder / "recorder.log") {
    std::vector<std::string> words = {INTERPLY_BIN_DIR "/interply-recorder", "--connect", address, "--out",
                                      (folder / "out").string()};
    words.insert(words.end(), more.begin(), more.end());
    std::vector<std::string> settings = environment;
    for (char** e = environ; *e; ++e) settings.emplace_back(*e);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 2, log_.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    if (posix_spawn(&pid_, words[0].c_str(), &actions, nullptr, list(words).data(), list(settings).data()) != 0)
      pid_ = -1;
    posix_spawn_file_actions_destroy(&actions);
  }
  ~Recorder() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      wait();
    }
  }
  void send(int signal) const { kill(pid_, signal); }
  pid_t pid() const { return pid_; }
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
  static std::vector<char*> list(std::vector<std::string>& words) {
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    return pointers;
  }
  std::filesystem::path log_;
  pid_t pid_ = -1;
};

/// A SampleRun over the exchange: its coordinator, the two layers that send their own samples, and the recorder.
class RecordedRun {
 public:
  explicit RecordedRun(SampleRun run = SampleRun(), const std::vector<std::string>& arguments = {},
                       const std::vector<std::string>& environment = {})
      : run_(std::move(run)) {
    std::vector<exchange::Expected> layers;
    for (int i = 0; i < 2; ++i)
      layers.push_back(
          {.layer = run_.mesh(i).layer, .n_nodes = run_.mesh(i).reference.cols(), .largest_sample = 64 << 20});
    address_ = "ipc://" + (folder_ / "link").string();
    link_ = exchange::bind_zeromq(address_, {"name: sample\n", 1, "sample"}, layers, exchange::ArraysBy::Messages, true);
    recorder_.emplace(folder_, address_, arguments, environment);
    if (const Event event = wait_for(Event::Kind::Joined); event.who != 2) ADD_FAILURE() << recorder_->log();
    for (int i = 0; i < 2; ++i) {
      solvers_.push_back(exchange::connect_zeromq(address_));
      std::thread joining([&] { solvers_.back()->join({.layer = run_.mesh(i).layer}, kPatience); });
      wait_for(Event::Kind::Joined);
      joining.join();
    }
  }

  /// Header and meshes.
  void start() {
    coordinator().put(run_.header());
    for (int i = 0; i < 2; ++i) layer(i).put(run_.mesh(i));
  }
  void put_frame(int k) {
    layer(1).put(run_.layer_frame(1, k));
    coordinator().put(run_.tool_frame(k));
    for (int i = 0; i < 2; ++i) coordinator().put(run_.interface_frame(i, k));
    layer(0).put(run_.layer_frame(0, k));
  }
  /// Hands on what the layers have sent until the recorder has confirmed so many frames.
  bool wait_for_frames(int frames) {
    return wait_until([&] { return told_.frames >= frames; });
  }
  bool wait_until_closed() {
    return wait_until([&] { return told_.closed; });
  }
  bool wait_until(const std::function<bool()>& done) {
    const auto start = std::chrono::steady_clock::now();
    while (!done()) {
      if (std::chrono::steady_clock::now() - start > std::chrono::duration<double>(kPatience)) return false;
      if (const Event event = pump(0.2); event.kind == Event::Kind::Suspect || event.kind == Event::Kind::Failed)
        return false;
    }
    return true;
  }
  /// The next event of this kind.
  Event wait_for(Event::Kind kind) {
    for (int i = 0; i < 5 * kPatience; ++i)
      if (const Event event = pump(0.2); event.kind == kind) return event;
    ADD_FAILURE() << "no such event";
    return {};
  }
  Event pump(double seconds) {
    Event event = link_->receive(seconds);
    if (event.kind == Event::Kind::Recorded) told_ = event.recorded;
    return event;
  }

  solve::LinkSink<exchange::CoordinatorLink> coordinator() {
    return solve::LinkSink<exchange::CoordinatorLink>(*link_);
  }
  solve::LinkSink<exchange::SolverLink> layer(int i) {
    return solve::LinkSink<exchange::SolverLink>(*solvers_[static_cast<std::size_t>(i)], run_.mesh(i).layer);
  }
  exchange::SolverLink& solver(int i) { return *solvers_[static_cast<std::size_t>(i)]; }
  void end_coordinator() { link_.reset(); }

  const SampleRun& run() const { return run_; }
  Recorder& recorder() { return *recorder_; }
  const std::string& address() const { return address_; }
  const exchange::Recorded& told() const { return told_; }
  std::filesystem::path file(const std::string& name) const { return folder_.path() / "out" / name; }
  std::string record() const { return file("record.h5").string(); }
  const TemporaryFolder& folder() const { return folder_; }

 private:
  SampleRun run_;
  TemporaryFolder folder_;
  std::string address_;
  std::unique_ptr<exchange::CoordinatorLink> link_;
  std::optional<Recorder> recorder_;
  std::vector<std::unique_ptr<exchange::SolverLink>> solvers_;
  exchange::Recorded told_;
};

std::string read_file(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(Recorder, RecordsARunOfSeveralParticipantsToItsEnd) {
  RecordedRun run(SampleRun(3, 30));
  run.start();
  for (int k = 0; k < 4; ++k) {
    run.put_frame(k);
    run.coordinator().put(run.run().history_row(k));
  }
  EXPECT_TRUE(run.wait_for_frames(4)) << run.recorder().log();
  EXPECT_EQ(RecordReader(run.record()).read_text("status"), "running");
  observe::RunEnd end = run.run().end(4);
  end.summary = "{\"a\": 1}";
  run.coordinator().put(end);
  EXPECT_TRUE(run.wait_until_closed());
  EXPECT_EQ(run.told().rows, 4);
  EXPECT_EQ(run.recorder().wait(), 0) << run.recorder().log();
  EXPECT_EQ(run_check("values " + run.record() + " 4 4 done"), 0);
  EXPECT_EQ(run_check("xdmf " + run.file("record.xdmf").string() + " 4"), 0);
  EXPECT_THAT(read_file(run.file("scene.yaml")), testing::EndsWith(run.run().header().scene_text));
  EXPECT_EQ(read_file(run.file("summary.json")), "{\"a\": 1}");
}

TEST(Recorder, FramesOfManyMegabytesArriveIntact) {
  RecordedRun run(SampleRun(3, 200));  // 40 000 nodes, 79 202 elements: 6.4 MB per frame and layer
  run.start();
  for (int k = 0; k < 4; ++k) {
    run.put_frame(k);
    EXPECT_TRUE(run.wait_for_frames(k + 1));
  }
  run.coordinator().put(run.run().end(4));
  EXPECT_TRUE(run.wait_until_closed());
  EXPECT_EQ(run.recorder().wait(), 0) << run.recorder().log();
  EXPECT_EQ(run_check("values " + run.record() + " 4 0 done"), 0);
}

TEST(Recorder, WhatItConfirmsIsInTheFile) {
  RecordedRun run(SampleRun(40, 10, 40));
  run.start();
  run.put_frame(0);
  EXPECT_TRUE(run.wait_for_frames(1));
  run.recorder().send(SIGSTOP);
  for (int k = 1; k <= 20; ++k) {
    run.put_frame(k);
    run.coordinator().put(run.run().history_row(k - 1));
  }
  for (int i = 0; i < 5; ++i) run.pump(0.1);
  EXPECT_EQ(run.told().frames, 1);
  EXPECT_EQ(run.told().rows, 0);
  run.recorder().send(SIGCONT);
  EXPECT_TRUE(run.wait_until([&] { return run.told().frames == 21 && run.told().rows == 20; }));
  run.recorder().send(SIGKILL);
  EXPECT_EQ(run.recorder().wait(), -SIGKILL);
  EXPECT_EQ(run_check("values " + run.record() + " 21 20 running"), 0);
}

TEST(Recorder, KilledInMidRunLeavesEveryCompletedFrame) {
  RecordedRun run(SampleRun(20, 40, 40));
  run.start();
  for (int k = 0; k < 5; ++k) {
    run.coordinator().put(run.run().history_row(k));
    run.put_frame(k);
  }
  run.layer(0).put(run.run().layer_frame(0, 5));  // frame 5 stays incomplete
  ASSERT_TRUE(run.wait_for_frames(5));
  run.recorder().send(SIGKILL);
  EXPECT_EQ(run.recorder().wait(), -SIGKILL);
  EXPECT_EQ(run.wait_for(Event::Kind::Suspect).who, 2);
  // h5py opens it, finds frames 0 to 4 whole and the rest not complete.
  EXPECT_EQ(RecordReader(run.record()).frames_complete(), 5);
  EXPECT_EQ(RecordReader(run.record()).read_text("status"), "running");
  EXPECT_EQ(run_check("attributes " + run.record()), 0);
  EXPECT_EQ(run_check("prefix " + run.record() + " 5"), 0);
  EXPECT_EQ(run_check("xdmf " + run.file("record.xdmf").string() + " 5"), 0);
}

TEST(Recorder, KilledAtAnyMomentLeavesAValidRecord) {
  for (int attempt = 0; attempt < 8; ++attempt) {
    RecordedRun run(SampleRun(200, 30, 2000));
    run.start();
    run.put_frame(0);
    ASSERT_TRUE(run.wait_for_frames(1));
    std::thread killer([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(3 + 7 * attempt));
      run.recorder().send(SIGKILL);
    });
    for (int k = 1; k <= 60; ++k) {
      run.put_frame(k);
      run.coordinator().put(run.run().history_row(k - 1));
      run.pump(0);
    }
    killer.join();
    EXPECT_EQ(run.recorder().wait(), -SIGKILL);
    const int frames = RecordReader(run.record()).frames_complete();
    EXPECT_GE(frames, 1);
    EXPECT_EQ(run_check("prefix " + run.record() + " " + std::to_string(frames)), 0);
    EXPECT_EQ(run_check("well_formed " + run.file("record.xdmf").string()), 0);
  }
}

TEST(Recorder, InterruptClosesTheRecord) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    RecordedRun run;
    run.start();
    run.put_frame(0);
    ASSERT_TRUE(run.wait_for_frames(1));
    run.recorder().send(signal);
    EXPECT_EQ(run.recorder().wait(), 5);
    EXPECT_EQ(run_check("values " + run.record() + " 1 0 interrupted"), 0);
    EXPECT_EQ(run.wait_for(Event::Kind::Suspect).who, 2);
  }
}

TEST(Recorder, SaysThatTheRunIsLostWhenItsCoordinatorVanishes) {
  RecordedRun run;
  run.start();
  run.put_frame(0);
  ASSERT_TRUE(run.wait_for_frames(1));
  run.end_coordinator();
  EXPECT_EQ(run.recorder().wait(), 4) << run.recorder().log();
  const RecordReader record(run.record());
  EXPECT_EQ(record.read_text("status"), "lost");
  EXPECT_THAT(record.read_text("message"), HasSubstr("closed the connection before the end of the run"));
  EXPECT_EQ(record.frames_complete(), 1);
}

TEST(Recorder, SaysSoWithoutAReaderOfItsWords) {
  RecordedRun run(SampleRun(), {}, {});
  // the same with a pipe for stderr whose reader has gone
  int pipe_ends[2];
  ASSERT_EQ(pipe(pipe_ends), 0);
  const TemporaryFolder folder;
  const std::string address = "ipc://" + (folder / "link").string();
  auto link = exchange::bind_zeromq(address, {"", 1, "sample"}, {}, exchange::ArraysBy::Messages, true);
  const std::string out = (folder / "out").string();
  const pid_t pid = fork();
  if (pid == 0) {
    dup2(pipe_ends[1], 2);
    close(pipe_ends[0]);
    close(pipe_ends[1]);
    execl(INTERPLY_BIN_DIR "/interply-recorder", "interply-recorder", "--connect", address.c_str(), "--out",
          out.c_str(), nullptr);
    _exit(127);
  }
  close(pipe_ends[0]);
  close(pipe_ends[1]);
  EXPECT_EQ(link->receive(kPatience).kind, Event::Kind::Joined);
  observe::RunHeader header;
  header.run = "sample";
  solve::LinkSink<exchange::CoordinatorLink>(*link).put(header);
  for (int i = 0; i < 300 && !std::filesystem::exists(folder / "out"); ++i) link->receive(0.1);
  link.reset();
  int status = 0;
  waitpid(pid, &status, 0);
  EXPECT_TRUE(WIFEXITED(status)) << "killed by signal " << WTERMSIG(status);
  EXPECT_EQ(RecordReader(folder / "out/record.h5").read_text("status"), "lost");
}

/// What a layer that has joined may send and nobody could record.
struct Wrong {
  std::string name, sentence;
  std::function<void(RecordedRun&)> send;
};
void PrintTo(const Wrong& wrong, std::ostream* out) { *out << wrong.name; }

class WrongSamples : public testing::TestWithParam<Wrong> {};

TEST_P(WrongSamples, EndTheRunAndNameWhoSentThem) {
  RecordedRun run;
  run.coordinator().put([&] {
    observe::RunHeader header = run.run().header();
    for (int i = 0; i < 2; ++i) {
      header.nodes.push_back(run.run().mesh(i).reference.cols());
      header.elements.push_back(run.run().mesh(i).triangles.cols());
    }
    return header;
  }());
  run.layer(1).put(run.run().mesh(1));
  GetParam().send(run);
  const Event event = run.wait_for(Event::Kind::Failed);
  EXPECT_EQ(event.who, 2);
  EXPECT_EQ(event.reason, StopReason::Lost);
  EXPECT_THAT(event.message, HasSubstr(GetParam().sentence));
  EXPECT_EQ(run.recorder().wait(), 4) << run.recorder().log();
  EXPECT_EQ(RecordReader(run.record()).read_text("status"), "lost");
}

const std::vector<Wrong> kWrong = {
    {"MeshOfAnotherSize", "the mesh of layer 'ply_1' has 7 nodes and 32 elements, the scene gives it 25 and 32",
     [](RecordedRun& run) {
       observe::LayerMesh mesh = run.run().mesh(0);
       mesh.reference.conservativeResize(3, 7);
       run.layer(0).put(mesh);
     }},
    {"CornersThatAreNoNodes", "has corners that are none of its 25 nodes",
     [](RecordedRun& run) {
       observe::LayerMesh mesh = run.run().mesh(0);
       mesh.triangles(2, 5) = 25;
       run.layer(0).put(mesh);
     }},
    {"AnotherLayersFrame", "ply_1 cannot be kept: is not its own",
     [](RecordedRun& run) { run.layer(0).put(run.run().layer_frame(1, 0)); }},
    {"TheCoordinatorsEnd", "ply_1 cannot be kept: is not its own",
     [](RecordedRun& run) { run.layer(0).put(run.run().end(1)); }},
    {"AFrameWithoutAMesh", "ply_1 cannot be kept: layer 'ply_1' has sent no mesh",
     [](RecordedRun& run) { run.layer(0).put(run.run().layer_frame(0, 0)); }},
    {"AFrameBeyondTheLast", "frame 4 of layer 'ply_1' does not fit: not in [0, 3]",
     [](RecordedRun& run) {
       run.layer(0).put(run.run().mesh(0));
       run.layer(0).put(run.run().layer_frame(0, 4));
     }},
    {"FieldsOfAnotherSize", "field 'stress' of 'ply_1' has 7 values for 32 elements",
     [](RecordedRun& run) {
       run.layer(0).put(run.run().mesh(0));
       observe::LayerFrame frame = run.run().layer_frame(0, 0);
       frame.fields[0].values.resize(3 * 7);
       run.layer(0).put(frame);
       run.layer(1).put(run.run().layer_frame(1, 0));
       run.coordinator().put(run.run().tool_frame(0));
       for (int i = 0; i < 2; ++i) run.coordinator().put(run.run().interface_frame(i, 0));
     }},
    {"Garbage", "ply_1 cannot be kept: is unreadable", [](RecordedRun& run) {
       const std::string garbage(1000, '\xff');
       run.solver(0).send(
           exchange::Sample{.layer = "ply_1", .frame = -1, .payload = std::as_bytes(std::span(garbage))});
     }}};

INSTANTIATE_TEST_SUITE_P(OfALayer, WrongSamples, testing::ValuesIn(kWrong),
                         [](const auto& info) { return info.param.name; });

TEST(Recorder, ReplacesNothingThatNoRunWroteAndNothingBeforeThereIsARun) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "out");
  const std::string nowhere = "ipc://" + (folder / "link").string();
  {
    RecordWriter writer(folder / "out/record.h5");
    writer.put(SampleRun().header());
  }
  Recorder refused(folder, nowhere);
  EXPECT_EQ(refused.wait(), 2);
  EXPECT_THAT(refused.log(), HasSubstr("record.h5 is there from an earlier run"));
  Recorder told(folder, nowhere, {"--overwrite", "--deadline", "0.5"});
  EXPECT_EQ(told.wait(), 4);
  EXPECT_THAT(told.log(), HasSubstr("for 0.5 s while joining"));
  EXPECT_EQ(RecordReader(folder / "out/record.h5").read_text("status"), "interrupted") << "the old one is still there";
  std::ofstream(folder / "out/record.h5") << "precious";
  Recorder still_refused(folder, nowhere, {"--overwrite"});
  EXPECT_EQ(still_refused.wait(), 2);
  EXPECT_EQ(std::filesystem::file_size(folder / "out/record.h5"), 8u);
}

TEST(Recorder, TheSecondOneIsRefused) {
  RecordedRun run;
  const TemporaryFolder other;  // the first one has its own folder for itself
  Recorder second(other, run.address());
  std::thread pumping([&] {
    for (int i = 0; i < 20; ++i) run.pump(0.1);
  });
  EXPECT_EQ(second.wait(), 2);
  pumping.join();
  EXPECT_THAT(second.log(), HasSubstr("the recorder may not join: it has joined before as recorder (process "));
  run.start();
  run.put_frame(0);
  EXPECT_TRUE(run.wait_for_frames(1)) << "the first one goes on";
}

/// Number of write calls of a process so far.
long count_writes(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/io");
  for (std::string key; file >> key;)
    if (key == "syscw:") {
      long n = 0;
      file >> n;
      return n;
    }
  return -1;
}

TEST(Recorder, TheThousandthFrameCostsAsMuchAsTheTenth) {
  RecordedRun run(SampleRun(1000, 3));
  run.start();
  const auto record_until = [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      run.put_frame(k);
      ASSERT_TRUE(run.wait_for_frames(k + 1));
    }
  };
  record_until(0, 10);
  const long at_10 = count_writes(run.recorder().pid());
  record_until(10, 110);
  const long early = count_writes(run.recorder().pid()) - at_10;
  record_until(110, 901);
  const long at_901 = count_writes(run.recorder().pid());
  record_until(901, 1001);
  const long late = count_writes(run.recorder().pid()) - at_901;
  ASSERT_GT(early, 0);
  EXPECT_LT(std::abs(late - early), early / 4) << "bells of the sockets beside the same number of writes to files";
  run.coordinator().put(run.run().end(1001));
  EXPECT_TRUE(run.wait_until_closed());
  EXPECT_EQ(run_check("values " + run.record() + " 1001 0 done"), 0);
  EXPECT_EQ(run_check("xdmf " + run.file("record.xdmf").string() + " 1001"), 0);
}

TEST(Recorder, HistoryRowsThatComeTogetherAreWrittenTogether) {
  RecordedRun run(SampleRun(3, 3, 1000));
  run.start();
  run.put_frame(0);
  ASSERT_TRUE(run.wait_for_frames(1));
  const long before = count_writes(run.recorder().pid());
  run.recorder().send(SIGSTOP);
  for (int i = 0; i < 300; ++i) run.coordinator().put(run.run().history_row(i));
  run.pump(0.2);
  run.recorder().send(SIGCONT);
  ASSERT_TRUE(run.wait_until([&] { return run.told().rows == 300; }));
  EXPECT_LT(count_writes(run.recorder().pid()) - before, 300) << "30 columns";
}

}  // namespace
}  // namespace interply::record
