/// `interply bench` with tiny sizes: what it prints is complete, what arrived is right, nothing stays behind. No times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <thread>

#include "bench/carriers.hpp"
#include "launch/bench_tools.hpp"
#include "launch/command_line.hpp"
#include "launch/run.hpp"
#include "paths.hpp"

namespace interply::launch {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// The real program as a child whose temporary files lie in a folder of its own.
class Bench {
 public:
  explicit Bench(std::vector<std::string> words) {
    words.insert(words.begin(), {INTERPLY_BIN_DIR "/interply", "bench"});
    std::vector<char*> arguments;
    for (auto& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    fs::create_directories(temporary());
    pid_ = ::fork();
    if (pid_ != 0) return;
    ::setenv("TMPDIR", temporary().c_str(), 1);
    [[maybe_unused]] const auto* out = ::freopen(output().c_str(), "w", stdout);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }
  ~Bench() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
  }
  pid_t pid() const { return pid_; }
  int wait() {
    int status = 0;
    ::waitpid(std::exchange(pid_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  fs::path temporary() const { return folder_.make("tmp"); }
  fs::path output() const { return folder_.make("") / "out"; }
  std::string text() const {
    std::ifstream file(output());
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  struct Folder {
    Folder() {
      std::string path = testing::TempDir() + "bench-XXXXXX";
      path_ = ::mkdtemp(path.data());
    }
    ~Folder() { fs::remove_all(path_); }
    fs::path make(const std::string& name) const { return path_ / name; }
    fs::path path_;
  } folder_;
  pid_t pid_ = -1;
};

/// Processes of the real program with this word on their command line and this environment.
std::set<int> find_processes(const std::string& word, const fs::path& temporary) {
  std::set<int> found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const auto read = [&](const char* name) {
      std::ifstream file(entry.path() / name);
      return std::string(std::istreambuf_iterator<char>(file), {});
    };
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (read("cmdline").find(std::string("\0bench\0", 7) + word) != std::string::npos &&
        read("environ").find("TMPDIR=" + temporary.string()) != std::string::npos)
      found.insert(std::stoi(name));
  }
  return found;
}

/// Waits until this many such processes run. @return whether that came true within 20 s
std::set<int> wait_for_processes(const std::string& word, const fs::path& temporary, std::size_t n) {
  std::set<int> found;
  for (int i = 0; i < 400 && (found = find_processes(word, temporary)).size() != n; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  return found;
}

TEST(Bench, ExchangeHasARowPerCarrierAndSizeAndTheSameDigestForAll) {
  Bench bench({"exchange", "--peers", "1,3", "--nodes", "50", "--seconds", "0.01", "--rounds", "1"});
  EXPECT_EQ(bench.wait(), kDone) << bench.text();
  std::map<std::string, std::set<std::string>> carriers, digests;
  std::istringstream lines(bench.text());
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string peers, nodes, carrier, word, last;
    if (!(words >> peers >> nodes >> carrier) || peers.find_first_not_of("0123456789") != std::string::npos) continue;
    while (words >> word) last = word;
    EXPECT_TRUE(carriers[peers + " " + nodes].insert(carrier).second) << line;
    if (line.find("not measured") == std::string::npos) digests[peers + " " + nodes].insert(last);
  }
  for (const std::string size : {"1 50", "3 50"}) {
    EXPECT_EQ(carriers[size].size(), bench::list_carriers().size()) << size << "\n" << bench.text();
    EXPECT_EQ(digests[size].size(), 1u) << "all carriers deliver the same\n" << bench.text();
  }
  EXPECT_TRUE(fs::is_empty(bench.temporary()));
}

TEST(Bench, StackEndsInTheSameDigestBothWays) {
  Bench bench({"stack", INTERPLY_SOURCE_DIR "/tests/scenes/flat_stack.yaml", "--rounds", "1"});
  EXPECT_EQ(bench.wait(), kDone) << bench.text();
  EXPECT_THAT(bench.text(), HasSubstr("\nfederated "));
  EXPECT_THAT(bench.text(), HasSubstr("\nin-process "));
  EXPECT_THAT(bench.text(), HasSubstr("federated / in-process: "));
  EXPECT_TRUE(fs::is_empty(bench.temporary()));
}

TEST(Bench, CtrlCLeavesNothingBehind) {
  Bench bench({"exchange", "--peers", "2", "--nodes", "100", "--seconds", "300", "--carriers", "zeromq-ipc"});
  ASSERT_EQ(wait_for_processes("peer", bench.temporary(), 2).size(), 2u);
  ::kill(bench.pid(), SIGINT);
  EXPECT_EQ(bench.wait(), kCancelled);
  EXPECT_TRUE(wait_for_processes("peer", bench.temporary(), 0).empty());
  EXPECT_TRUE(find_processes("hub", bench.temporary()).empty());
  EXPECT_TRUE(fs::is_empty(bench.temporary()));
}

TEST(Bench, ADeadPeerIsNamed) {
  for (const std::string carrier : {"raw-unix", "raw-memory", "tcp", "zeromq-tcp", "dds-udp"}) {
    Bench bench({"exchange", "--peers", "1", "--nodes", "100", "--seconds", "300", "--carriers", carrier});
    const auto peers = wait_for_processes("peer", bench.temporary(), 1);
    ASSERT_EQ(peers.size(), 1u);
    ::kill(*peers.begin(), SIGKILL);
    EXPECT_EQ(bench.wait(), kFailed);
    EXPECT_THAT(bench.text(), HasSubstr("not measured: peer 0 was killed by signal 9")) << carrier;
    EXPECT_TRUE(fs::is_empty(bench.temporary())) << carrier;
  }
}

std::string refuse(std::vector<std::string> words) {
  words.insert(words.begin(), {"interply", "bench"});
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  testing::internal::CaptureStderr();
  EXPECT_EQ(run_command_line(static_cast<int>(arguments.size()), arguments.data()), kRefused);
  return testing::internal::GetCapturedStderr();
}

TEST(Bench, ArgumentsThatCannotBeAreRefusedWithASentence) {
  EXPECT_EQ(refuse({"exchang"}), "interply: there is no command \"exchang\"; did you mean \"exchange\"?\n");
  EXPECT_EQ(refuse({"exchange", "--carriers", "zeromqipc"}),
            "interply: --carriers: there is no carrier \"zeromqipc\"; did you mean \"zeromq-ipc\"?\n");
  EXPECT_EQ(refuse({"exchange", "--node", "7"}), "interply: exchange has no option --node; did you mean --nodes?\n");
  EXPECT_THAT(refuse({"exchange", "--peers", "0"}), HasSubstr("--peers: Value 0 not in range"));
  EXPECT_THAT(refuse({"exchange", "--seconds", "soon"}), HasSubstr("--seconds"));
  EXPECT_THAT(refuse({"stack", "/no/such/scene.yaml"}), HasSubstr("/no/such/scene.yaml"));
  EXPECT_EQ(refuse({"stack", "a.yaml", "b.yaml"}), "interply: stack takes no further argument \"b.yaml\"\n");
}

TEST(Median, OfEvenAndOddNumbersAndOfRatios) {
  EXPECT_EQ(find_median({3, 1, 2}), 2);
  EXPECT_EQ(find_median({4, 1, 2, 3}), 2.5);
  EXPECT_EQ(find_ratio({2, 30, 8}, {1, 10, 2}), 3) << "pair by pair, not the ratio of the medians";
}

}  // namespace
}  // namespace interply::launch
