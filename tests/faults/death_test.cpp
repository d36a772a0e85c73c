/// Every role dies, at start-up and in mid-run: it is named, the others end, the record stays readable.
#include <gmock/gmock.h>

#include "faults/programs.hpp"

namespace interply::faults {
namespace {

using testing::HasSubstr;

enum class Moment { StartUp, MidRun };
struct Death {
  std::string role;
  Moment moment;
};

void PrintTo(const Death& death, std::ostream* out) {
  *out << death.role << (death.moment == Moment::StartUp ? " at start-up" : " in mid-run");
}

class Deaths : public testing::TestWithParam<Death> {
 protected:
  TemporaryFolder folder_;
};

TEST_P(Deaths, AreNamedAndNothingIsLeft) {
  const auto out = folder_.path() / "out";
  Program program("interply",
                  {"run", kScenes / "flat_stack.yaml", "--out", out, "--set", "motion.forming_time=1", "--set",
                   "record.frames=1000"},
                  folder_.path());
  std::map<std::string, pid_t> participants;
  const auto is_there = [&] {
    participants = find_participants(program.pid());
    return participants.contains(GetParam().role);
  };
  if (GetParam().moment == Moment::MidRun) {
    ASSERT_TRUE(program.wait_until([&] { return is_under_way(out); })) << program.said();
  }
  ASSERT_TRUE(program.wait_until(is_there)) << program.said();
  kill(participants[GetParam().role], SIGKILL);

  EXPECT_EQ(program.wait(), 4) << program.said();
  EXPECT_THAT(program.said(), HasSubstr("interply: " + GetParam().role + " (process "));
  EXPECT_THAT(program.said(), HasSubstr("signal 9"));
  for (const auto& [name, pid] : participants) EXPECT_TRUE(is_gone(pid)) << name;
  for_each_process([&](pid_t, const std::string& command) {
    EXPECT_EQ(command.find(out.string()), std::string::npos) << "still running: " << command;
  });
  if (GetParam().moment == Moment::MidRun) {
    const record::RecordReader record(out / "record.h5");
    ASSERT_GE(record.frames_complete(), 2);
    EXPECT_TRUE(record.read_position("ply_2", record.frames_complete() - 1).allFinite());
    if (GetParam().role != "recorder" && GetParam().role != "coordinator") {
      EXPECT_EQ(record.read_text("status"), "lost");
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfEveryRole, Deaths,
                         testing::Values(Death{"coordinator", Moment::StartUp}, Death{"coordinator", Moment::MidRun},
                                         Death{"recorder", Moment::StartUp}, Death{"recorder", Moment::MidRun},
                                         Death{"sheet_upper", Moment::StartUp}, Death{"sheet_upper", Moment::MidRun},
                                         Death{"ply_2", Moment::StartUp}, Death{"ply_2", Moment::MidRun}),
                         [](const auto& info) {
                           return info.param.role +
                                  (info.param.moment == Moment::StartUp ? "_at_start_up" : "_in_mid_run");
                         });

TEST(DeathOfTheLauncher, TakesEveryoneAlong) {
  TemporaryFolder folder;
  const auto out = folder.path() / "out";
  Program program("interply",
                  {"run", kScenes / "flat_stack.yaml", "--out", out, "--set", "motion.forming_time=1", "--set",
                   "record.frames=1000"},
                  folder.path());
  ASSERT_TRUE(program.wait_until([&] { return is_under_way(out); })) << program.said();
  const auto participants = find_participants(program.pid());
  ASSERT_EQ(participants.size(), 7u);
  program.send_signal(SIGKILL);
  EXPECT_EQ(program.wait(), 128 + SIGKILL);
  const auto socket = program.said().find("shm://") + 6;  // the one thing that a killed launcher cannot remove
  fs::remove_all(fs::path(program.said().substr(socket, program.said().find('\n', socket) - socket)).parent_path());
  const auto start = std::chrono::steady_clock::now();
  const auto anyone = [&] {
    return std::any_of(participants.begin(), participants.end(), [](const auto& p) { return !is_gone(p.second); });
  };
  while (anyone() && std::chrono::steady_clock::now() - start < std::chrono::duration<double>(kPatience))
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(anyone());
  EXPECT_GE(record::RecordReader(out / "record.h5").frames_complete(), 2);
}

TEST(SilentSolver, IsNamedByTheWaitLadderAndThenByTheDeadline) {
  TemporaryFolder folder;
  Program program("interply",
                  {"run", kScenes / "flat_stack.yaml", "--out", folder.path() / "out", "--set", "motion.forming_time=1",
                   "--set", "exchange.wait_deadline=8"},
                  folder.path());
  ASSERT_TRUE(program.wait_for_words("stroke ")) << program.said();
  auto participants = find_participants(program.pid());
  ASSERT_TRUE(participants.contains("ply_3"));
  kill(participants["ply_3"], SIGSTOP);
  EXPECT_TRUE(program.wait_for_words("waiting for ply_3 at step ")) << program.said();
  EXPECT_EQ(program.wait(), 4) << program.said();
  EXPECT_THAT(program.said(), testing::ContainsRegex("interply: .*ply_3"));
  for (const auto& [name, pid] : participants) EXPECT_TRUE(is_gone(pid)) << name;
}

}  // namespace
}  // namespace interply::faults
