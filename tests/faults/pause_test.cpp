/// Ctrl-Z: all of a run stops, for however long, and goes on as if nothing had been.
#include <gmock/gmock.h>

#include "faults/programs.hpp"

namespace interply::faults {
namespace {

using testing::HasSubstr;

char read_state(pid_t pid) {
  const std::string stat = read_text(fs::path("/proc") / std::to_string(pid) / "stat");
  const auto end = stat.rfind(')');
  return end == std::string::npos ? '?' : stat[end + 2];
}
bool is_stopped(pid_t pid) { return read_state(pid) == 'T'; }

void sleep_for(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

class PauseOfALauncher : public testing::Test {
 protected:
  std::vector<std::string> command(const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> words{"run",   kScenes / "flat_stack.yaml", "--out", folder_.path() / out,
                                   "--set", "exchange.wait_deadline=2",  "--set", "exchange.startup_deadline=2"};
    for (const auto* setting : {"motion.forming_time=6e-3", "motion.stroke=3", "record.frames=100"})
      words.insert(words.end(), {"--set", setting});
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// Digest line of the same run that nobody disturbs.
  std::string find_reference() {
    Program program("interply", command("reference", {"--in-process", "--quiet"}), folder_.path());
    EXPECT_EQ(program.wait(), 0) << program.said();
    return program.last_line();
  }
  TemporaryFolder folder_;
};

class Pause : public PauseOfALauncher, public testing::WithParamInterface<std::vector<std::string>> {};

TEST_P(Pause, StopsAllAndChangesNothingThoughItIsLongerThanEveryDeadline) {
  Program program("interply", command("out", GetParam()), folder_.path());
  ASSERT_TRUE(program.wait_until([&] { return is_under_way(folder_.path() / "out"); })) << program.said();
  auto all = find_participants(program.pid());
  all["launcher"] = program.pid();
  program.send_signal(SIGTSTP);
  ASSERT_TRUE(program.wait_until([&] {
    return std::all_of(all.begin(), all.end(), [](const auto& p) { return is_stopped(p.second); });
  })) << program.said();
  sleep_for(5);
  for (const auto& [name, pid] : all) EXPECT_TRUE(is_stopped(pid)) << name;
  program.send_signal(SIGCONT);
  EXPECT_EQ(program.wait(), 0) << program.said();
  EXPECT_EQ(program.last_line(), find_reference());
  EXPECT_EQ(record::RecordReader(folder_.path() / "out/record.h5").frames_complete(), 101);
}

INSTANTIATE_TEST_SUITE_P(OfAll, Pause,
                         testing::Values(std::vector<std::string>{},
                                         std::vector<std::string>{"--address", "tcp://127.0.0.1:0"},
                                         std::vector<std::string>{"--in-process"}),
                         [](const auto& info) {
                           return info.param.empty()      ? "SharedMemory"
                                  : info.param.size() > 1 ? "Sockets"
                                                          : "OneProcess";
                         });

TEST_F(PauseOfALauncher, AloneIsNoticedByNobody) {
  Program program("interply", command("out", {}), folder_.path());
  ASSERT_TRUE(program.wait_until([&] { return is_under_way(folder_.path() / "out"); })) << program.said();
  const auto participants = find_participants(program.pid());
  program.send_signal(SIGSTOP);
  for (const auto& [name, pid] : participants)  // whoever is done with the run has only to be reaped
    ASSERT_TRUE(program.wait_until([&, pid = pid] { return is_gone(pid); })) << name;
  program.send_signal(SIGCONT);
  EXPECT_EQ(program.wait(), 0) << program.said();
  EXPECT_EQ(program.last_line(), find_reference());
}

TEST_F(PauseOfALauncher, ThatIsKilledThenLeavesNobody) {
  Program program("interply", command("out", {"--set", "motion.forming_time=1"}), folder_.path());
  ASSERT_TRUE(program.wait_until([&] { return is_under_way(folder_.path() / "out"); })) << program.said();
  const auto participants = find_participants(program.pid());
  program.send_signal(SIGTSTP);
  ASSERT_TRUE(program.wait_until([&] { return is_stopped(program.pid()); })) << program.said();
  program.send_signal(SIGKILL);
  program.wait();
  const auto start = std::chrono::steady_clock::now();
  const auto anyone = [&] {
    return std::any_of(participants.begin(), participants.end(), [](const auto& p) { return !is_gone(p.second); });
  };
  while (anyone() && std::chrono::steady_clock::now() - start < std::chrono::duration<double>(kPatience))
    sleep_for(0.02);
  EXPECT_FALSE(anyone());
}

TEST_F(PauseOfALauncher, IsEndedLikeAnyOther) {
  Program program("interply", command("out", {"--set", "motion.forming_time=1"}), folder_.path());
  ASSERT_TRUE(program.wait_until([&] { return is_under_way(folder_.path() / "out"); })) << program.said();
  program.send_signal(SIGTSTP);
  ASSERT_TRUE(program.wait_until([&] { return is_stopped(program.pid()); })) << program.said();
  program.send_signal(SIGTERM);  // as the shell ends a job
  program.send_signal(SIGCONT);
  EXPECT_EQ(program.wait(), 5) << program.said();
  EXPECT_THAT(program.said(), HasSubstr("the run was cancelled at step"));
}

}  // namespace
}  // namespace interply::faults
