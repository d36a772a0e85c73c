/// Who watches, who pretends to publish and who sends junk: none of them costs a run or a watcher anything.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <thread>

#include "child.hpp"
#include "collector.hpp"
#include "observe/run_sink.hpp"
#include "record/sample_run.hpp"

namespace interply::observe {
namespace {

using test::Child;
using test::SampleRun;
using testing::HasSubstr;

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Everything logged while it lives.
class Log {
 public:
  Log() {
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_)));
  }
  ~Log() { spdlog::set_default_logger(previous_); }
  std::string text() const { return text_.str(); }
  long lines() const {
    const std::string all = text();
    return std::count(all.begin(), all.end(), '\n');
  }

 private:
  std::ostringstream text_;
  std::shared_ptr<spdlog::logger> previous_ = spdlog::default_logger();
};

/// Says the number of each frame of layer ply_1 that it sees.
struct FrameCaller : Collector {
  explicit FrameCaller(const Child::Voice& voice) : voice_(voice) {}
  void put(const LayerFrame& a) override {
    if (a.layer == "ply_1") voice_.say(std::to_string(a.frame));
  }
  Child::Voice voice_;
};

TEST(Watcher, ThatStandsStillCostsNothingAndThenSeesTheNewestFrames) {
  const DdsOptions options = make_options("still");
  Child monitor([&](const Child::Voice& voice) {
    DdsSubscriber subscriber(options);
    FrameCaller caller(voice);
    while (true) subscriber.receive(caller, 1.0);
  });
  DdsSink sink(options);
  const SampleRun run(2000, 60);  // 0.6 MB per frame
  run.put_start(sink);
  int frame = 0;
  double slowest = 0;
  const auto put_frame = [&] {
    const LayerFrame next = run.layer_frame(0, frame++);
    const auto start = Clock::now();
    sink.put(next);
    slowest = std::max(slowest, seconds_since(start));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  };
  std::string seen;
  for (const auto start = Clock::now(); seen.empty() && seconds_since(start) < 20; seen = monitor.hear(0)) put_frame();
  ASSERT_NE(seen, "");
  monitor.send(SIGSTOP);
  slowest = 0;
  for (const auto start = Clock::now(); seconds_since(start) < 12;) put_frame();  // longer than the 10 s lease of DDS
  EXPECT_LT(slowest, 0.5) << "s for the longest put()";
  while (!monitor.hear(0).empty()) {
  }
  const int stopped_until = frame;
  monitor.send(SIGCONT);
  int newest = -1;
  for (const auto start = Clock::now(); newest < stopped_until && seconds_since(start) < 20;) {
    put_frame();
    for (std::string line; !(line = monitor.hear(0)).empty();) newest = std::stoi(line);
  }
  EXPECT_GE(newest, stopped_until);
}

/// MB that this process keeps in memory.
double resident_megabytes() {
  std::ifstream file("/proc/self/statm");
  double size = 0, resident = 0;
  file >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

TEST(Watcher, ThatNeverReadsCostsAFewFrames) {
  const DdsOptions options = make_options("deaf");
  DdsSubscriber subscriber(options);
  DdsSink sink(options);
  const SampleRun run(100, 200);  // 6.4 MB per frame
  run.put_start(sink);
  Collector got;
  receive_until(subscriber, got, [&] { return got.meshes.size() == 2; });
  const double before = resident_megabytes();
  for (int k = 0; k <= 60; ++k) sink.put(run.layer_frame(0, k));
  EXPECT_LT(resident_megabytes() - before, 200) << "MB for 390 MB of frames";
  receive_until(subscriber, got, [&] { return !got.layer_frames.empty() && got.layer_frames.back().frame == 60; });
  ASSERT_FALSE(got.layer_frames.empty());
  EXPECT_LE(got.layer_frames.size(), 9u);
  EXPECT_EQ(got.layer_frames.back().frame, 60);
}

TEST(Watcher, DropsWhatAnotherPublisherPutsIntoTheRun) {
  const DdsOptions options = make_options("forged");
  const SampleRun run, other(3, 9);
  DdsSubscriber subscriber(options);
  DdsSink sink(options);
  run.put_start(sink);
  Collector got;
  receive_until(subscriber, got, [&] { return got.meshes.size() == 2; });
  ASSERT_EQ(got.meshes.size(), 2u);
  const Log log;
  DdsSink stranger(options);
  RunHeader terabyte = run.header();
  terabyte.frames = terabyte.history_capacity = 2'000'000'000;
  for (int i = 0; i < 200; ++i) {
    stranger.put(terabyte);
    stranger.put(other.mesh(0));
    stranger.put(other.layer_frame(0, 1));
    stranger.put(run.layer_frame(1, 1));
    stranger.put(run.end(1));
  }
  for (int k = 0; k < 4; ++k) {
    run.put_frame(sink, k);
    receive_until(subscriber, got, [&] { return got.layer_frames.size() == 2u * static_cast<std::size_t>(k + 1); });
  }
  sink.put(run.end(4));
  receive_until(subscriber, got, [&] { return !got.ends.empty(); });
  EXPECT_EQ(got.headers.size(), 1u);
  EXPECT_EQ(got.headers.at(0).frames, 3);
  EXPECT_EQ(got.meshes.size(), 2u);
  ASSERT_EQ(got.layer_frames.size(), 8u);
  for (const LayerFrame& f : got.layer_frames) EXPECT_EQ(f.time, 0.5 * f.frame);
  ASSERT_EQ(got.ends.size(), 1u);
  EXPECT_EQ(got.ends[0].frames_complete, 4);
  EXPECT_GT(subscriber.dropped(), 0u);
  EXPECT_LE(log.lines(), 10) << log.text();
}

TEST(Watcher, ThatCannotBeServedIsWarnedOfOnceAndTheRunGoesOn) {
  DdsOptions options = make_options("full");
  options.domain = 229;
  std::vector<int> taken;  // the ports of every participant that a host can have in the domain
  for (int participant = 0; participant <= 120; ++participant) {
    const sockaddr_in address{.sin_family = AF_INET,
                              .sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * 229 + 10 + 2 * participant)),
                              .sin_addr = {htonl(INADDR_LOOPBACK)},
                              .sin_zero = {}};
    taken.push_back(socket(AF_INET, SOCK_DGRAM, 0));
    bind(taken.back(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
  }
  const Log log;
  const auto sink = make_watch_sink(true, options);
  for (const int file : taken) close(file);
  const SampleRun run;
  run.put_start(*sink);
  run.put_frame(*sink, 0);
  EXPECT_TRUE(sink->flush(1));
  EXPECT_THAT(log.text(), HasSubstr("nobody can watch this process: DDS cannot open domain 229 on 127.0.0.1"));
  EXPECT_LE(log.lines(), 2) << log.text();
}

/// Local addresses of this process's UDP sockets, "127.0.0.1:7410".
std::set<std::string> list_udp_sockets() {
  std::set<std::string> inodes, sockets;
  for (const auto& file : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    const std::string target = std::filesystem::read_symlink(file.path(), gone).string();
    if (target.starts_with("socket:[")) inodes.insert(target.substr(8, target.size() - 9));
  }
  std::ifstream table("/proc/net/udp");
  std::string line;
  std::getline(table, line);
  while (std::getline(table, line)) {
    std::istringstream words(line);
    std::vector<std::string> columns(std::istream_iterator<std::string>{words}, {});
    if (columns.size() < 10 || !inodes.contains(columns[9])) continue;
    const in_addr address{static_cast<in_addr_t>(std::stoul(columns[1].substr(0, 8), nullptr, 16))};
    const int port = std::stoi(columns[1].substr(9), nullptr, 16);
    sockets.insert(std::string(inet_ntoa(address)) + ":" + std::to_string(port));
  }
  return sockets;
}

TEST(Watcher, AndPublisherOnLoopbackListenOnLoopbackAlone) {
  const DdsOptions options = make_options("loopback");
  const DdsSink sink(options);
  const DdsSubscriber subscriber(options);
  const auto sockets = list_udp_sockets();
  EXPECT_GE(sockets.size(), 2u);
  EXPECT_THAT(sockets, testing::Each(testing::StartsWith("127.0.0.1:")));
}

TEST(Watcher, OfJunkPacketsLogsOneLineASecond) {
  const DdsOptions options = make_options("junk");
  const Log log;
  const auto start = Clock::now();
  {
    DdsSink sink(options);
    DdsSubscriber subscriber(options);
    const auto sockets = list_udp_sockets();
    const int junk = socket(AF_INET, SOCK_DGRAM, 0);
    // An RTPS header and a submessage that is longer than the packet, with control characters.
    const std::string packet("RTPS\x02\x01\x42\x42\033[2J\nabcdefgh\x15\x01\xff\x00\033\n\033\n", 32);
    while (seconds_since(start) < 1.5) {
      for (const std::string& to : sockets) {
        sockaddr_in address{.sin_family = AF_INET,
                            .sin_port = htons(static_cast<std::uint16_t>(std::stoi(to.substr(to.find(':') + 1)))),
                            .sin_addr = {htonl(INADDR_LOOPBACK)},
                            .sin_zero = {}};
        sendto(junk, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof address);
      }
    }
    close(junk);
    const SampleRun run;
    run.put_start(sink);
    Collector got;
    receive_until(subscriber, got, [&] { return got.meshes.size() == 2; });
    EXPECT_EQ(got.meshes.size(), 2u);
  }
  EXPECT_LE(static_cast<double>(log.lines()), seconds_since(start) + 1) << log.text();
  EXPECT_THAT(log.text(), HasSubstr("malformed packet"));
  EXPECT_THAT(log.text(), testing::Not(HasSubstr("\033")));
}

}  // namespace
}  // namespace interply::observe
