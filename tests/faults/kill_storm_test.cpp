/// Every role gets every deadly signal at any moment, over every carrier: nothing stays behind, and what is said fits.
///
///     INTERPLY_KILLS=200 build/test/bin/faults_tests --gtest_filter='KillStorm.*'     # 12 by default
///     INTERPLY_SEED=7 ...                                                             # other moments
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <random>

#include "faults/programs.hpp"

namespace interply::faults {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

/// From the signal until everyone is gone, s: two, and some more for a machine that has other work.
constexpr double kEnd = 2, kBusy = 6;

const std::string kScene = R"(name: storm
blank: {length: 200, width: 200, symmetry: half, mesh_size: 20}
layers:
  - {name: ply_1, thickness: 1.2, density: 6.19e-10, law: {woven: {variant: full}}}
  - {name: sheet_1, thickness: 1.0, density: 7.85e-9, law: {j2: {}}}
tools:
  die: {edge: 60, offset: 22, shoulder: 10}
  blank_holder: {edge: 60, offset: 22, shoulder: 10, pressure: 1, ramp: 1e-3}
motion: {stroke: 0, forming_time: 1}
record: {frames: 100, history: 1000}
)";

struct Kill {
  std::string role, carrier;
  int signal = 0;
  double delay = 0;  ///< s from the start of that process
};

int read_number(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::atoi(text) : otherwise;
}

std::vector<Kill> draw_kills() {
  const std::array roles{"launcher", "coordinator", "recorder", "ply_1", "sheet_1"};
  const std::array carriers{"shm", "ipc", "tcp://127.0.0.1:0"};
  const std::array signals{SIGKILL, SIGINT, SIGTERM, SIGHUP};
  std::mt19937 random(static_cast<unsigned>(read_number("INTERPLY_SEED", 1)));
  std::exponential_distribution<double> delay(2);  // start-up is short and delicate
  std::vector<Kill> kills(static_cast<std::size_t>(read_number("INTERPLY_KILLS", 12)));
  for (std::size_t i = 0; i < kills.size(); ++i)
    kills[i] = {roles[i % 5], carriers[i % 3], signals[i % 4], delay(random)};
  return kills;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// One of these processes, or one that has this word in its command.
bool is_anyone_there(const std::map<std::string, pid_t>& participants, const std::string& word) {
  bool found = std::any_of(participants.begin(), participants.end(), [](const auto& p) { return !is_gone(p.second); });
  for_each_process([&](pid_t, const std::string& command) { found |= command.find(word) != std::string::npos; });
  return found;
}

void expect_fitting_words(const Kill& kill, int exit_code, const std::string& said, const fs::path& out) {
  const bool is_told = kill.role == "launcher" || kill.role == "coordinator";
  // who has not come to main() yet is killed by any signal: a launcher that has started nothing, a coordinator that is
  // named for it
  if (kill.role == "launcher" && exit_code == 128 + kill.signal && !fs::exists(out)) return;
  const bool is_killed = kill.signal == SIGKILL || (kill.role == "coordinator" && exit_code == 4);
  const bool is_cancelled = is_told && !is_killed;
  if (kill.role == "launcher" && kill.signal == SIGKILL)
    EXPECT_EQ(exit_code, 128 + SIGKILL);
  else
    EXPECT_EQ(exit_code, is_cancelled ? 5 : 4) << said;
  if (kill.role != "launcher" && !is_cancelled)
    EXPECT_THAT(said, testing::ContainsRegex("interply: (a participant was lost: )?(lost )?" + kill.role)) << said;
  if (!fs::exists(out / "record.h5")) return;
  const record::RecordReader record(out / "record.h5");
  if (kill.role == "launcher" && kill.signal == SIGKILL) {
    EXPECT_THAT(record.read_text("status"), AnyOf("cancelled", "lost", "interrupted"));
    EXPECT_THAT(record.read_text("message"), Not(AnyOf(HasSubstr("ply_1"), HasSubstr("sheet_1"))));
  } else {
    EXPECT_EQ(record.read_text("status"), is_cancelled ? "cancelled" : "lost") << record.read_text("message");
  }
}

TEST(KillStorm, LeavesNothingBehindAndSaysWhatHappened) {
  for (const int signal : {SIGHUP, SIGINT}) std::signal(signal, SIG_DFL);  // nohup and a script's `&` ignore them
  double slowest = 0;
  for (const Kill& kill : draw_kills()) {
    const TemporaryFolder folder;
    const fs::path out = folder.path() / "out";
    std::ofstream(folder.path() / "scene.yaml") << kScene;
    SCOPED_TRACE(testing::Message() << kill.role << " over " << kill.carrier << ", signal " << kill.signal << " after "
                                    << kill.delay << " s");
    Program program("interply", {"run", folder.path() / "scene.yaml", "--out", out, "--address", kill.carrier},
                    folder.path());
    pid_t victim = program.pid();
    ASSERT_TRUE(program.wait_until([&] {
      if (kill.role == "launcher") return true;
      const auto participants = find_participants(program.pid());
      if (participants.contains(kill.role)) victim = participants.at(kill.role);
      return participants.contains(kill.role);
    })) << program.said();
    const auto start = std::chrono::steady_clock::now();
    program.wait_until([&] { return seconds_since(start) > kill.delay; });
    const auto participants = find_participants(program.pid());
    const auto killed = std::chrono::steady_clock::now();
    ::kill(victim, kill.signal);
    const int exit_code = program.wait();
    for (bool late = false; is_anyone_there(participants, out.string()) && seconds_since(killed) < kPatience;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      if (late || seconds_since(killed) < kEnd + kBusy) continue;
      late = true;
      for (const auto& [role, pid] : participants)
        if (!is_gone(pid)) std::printf("%s is still there: %s\n", role.c_str(), describe_process(pid).c_str());
    }
    const double seconds = seconds_since(killed);
    if (seconds > slowest)
      std::printf("%s over %s, signal %d after %.3f s: all had ended after %.2f s\n", kill.role.c_str(),
                  kill.carrier.c_str(), kill.signal, kill.delay, seconds);
    slowest = std::max(slowest, seconds);
    EXPECT_LT(seconds, kEnd + kBusy);
    EXPECT_FALSE(is_anyone_there(participants, out.string()));
    EXPECT_FALSE(fs::exists(out / "record.h5.partial"));
    EXPECT_FALSE(fs::exists(out / "record.xdmf.partial"));
    expect_fitting_words(kill, exit_code, program.said(), out);
  }
}

}  // namespace
}  // namespace interply::faults
