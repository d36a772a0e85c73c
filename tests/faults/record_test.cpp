/// The record is part of the run: whoever pauses, however slow the disk, every frame is kept, or the run says why not.
#include <gmock/gmock.h>

#include <sys/resource.h>

#include <cstdlib>
#include <thread>

#include "faults/programs.hpp"

namespace interply::faults {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Sets an environment variable for the programs that are started while it lives.
class Setting {
 public:
  Setting(const char* name, const std::string& value) : name_(name) { setenv(name, value.c_str(), 1); }
  ~Setting() { unsetenv(name_); }
  Setting(const Setting&) = delete;
  Setting& operator=(const Setting&) = delete;

 private:
  const char* name_;
};

class RecordOfARun : public testing::Test {
 protected:
  Program start(const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> words{"run", kScenes / "flat_stack.yaml", "--out", folder_.path() / out};
    for (const std::string& word : more) {
      if (!word.starts_with("--")) words.push_back("--set");
      words.push_back(word);
    }
    return Program("interply", words, folder_.path());
  }
  fs::path out() const { return folder_.path() / "out"; }

  /// The run that `program` is has kept everything, and is the same as one that nobody disturbed.
  void expect_whole(Program& program, int frames, const std::vector<std::string>& settings) {
    EXPECT_EQ(program.wait(), 0) << program.said();
    auto undisturbed = settings;
    undisturbed.push_back("--in-process");
    Program reference = start("reference", undisturbed);
    EXPECT_EQ(reference.wait(), 0) << reference.said();
    EXPECT_EQ(program.last_line(), reference.last_line());
    const record::RecordReader record(out() / "record.h5"), whole(folder_.path() / "reference/record.h5");
    EXPECT_EQ(record.read_text("status"), "done");
    EXPECT_EQ("digest " + record.read_text("digest"), reference.last_line());
    EXPECT_EQ(record.frames_complete(), frames);
    EXPECT_EQ(record.rows_complete(), whole.rows_complete());
    for (const int k : {0, frames / 2, frames - 1})
      EXPECT_TRUE((record.read_position("ply_2", k) == whole.read_position("ply_2", k)).all()) << "frame " << k;
  }

  TemporaryFolder folder_;
};

void sleep_for(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

TEST_F(RecordOfARun, IsWholeThoughEveryRoleStopsInTurnForTwoSeconds) {
  const std::vector<std::string> settings{"record.frames=300"};
  Program program = start("out", settings);
  ASSERT_TRUE(program.wait_until([&] { return is_under_way(out()); })) << program.said();
  auto participants = find_participants(program.pid());
  for (const char* role : {"recorder", "ply_2", "coordinator", "sheet_upper"}) {
    ASSERT_EQ(kill(participants[role], SIGSTOP), 0) << role;
    sleep_for(2);
    kill(participants[role], SIGCONT);
    sleep_for(0.05);
  }
  expect_whole(program, 301, settings);
}

TEST_F(RecordOfARun, IsWholeThoughRecorderAndLayerStopForLongerThanALeaseOfDds) {
  const std::vector<std::string> settings{"record.frames=300"};
  Program program = start("out", settings);
  ASSERT_TRUE(program.wait_until([&] { return is_under_way(out()); })) << program.said();
  auto participants = find_participants(program.pid());
  for (const char* role : {"recorder", "ply_1"}) kill(participants[role], SIGSTOP);
  sleep_for(12);
  kill(participants["ply_1"], SIGCONT);
  EXPECT_TRUE(program.wait_for_words("waiting for recorder at step ")) << program.said();
  kill(participants["recorder"], SIGCONT);
  expect_whole(program, 301, settings);
}

TEST_F(RecordOfARun, EndsByTheDeadlineOfTheSceneAndNamesARecorderThatStaysSilent) {
  Program program = start("out", {"record.frames=300", "exchange.wait_deadline=3"});
  ASSERT_TRUE(program.wait_until([&] { return is_under_way(out()); })) << program.said();
  auto participants = find_participants(program.pid());
  kill(participants["recorder"], SIGSTOP);
  EXPECT_EQ(program.wait(), 4) << program.said();
  EXPECT_THAT(program.said(), AllOf(testing::ContainsRegex("(no word from|lost) recorder at step "), Not(HasSubstr("no word from ply"))));
  for (const auto& [name, pid] : participants) EXPECT_TRUE(is_gone(pid)) << name;
  EXPECT_NE(record::RecordReader(out() / "record.h5").read_text("status"), "done");
}

TEST_F(RecordOfARun, LostAfterTheMechanicsWereDoneLeavesSummaryAndDigest) {
  Program program = start("out", {"record.frames=4", "exchange.wait_deadline=20", "motion.forming_time=3e-3"});
  std::map<std::string, pid_t> participants;
  ASSERT_TRUE(program.wait_until([&] {
    return fs::exists(out() / "record.h5") && record::RecordReader(out() / "record.h5").frames_complete() >= 1;
  })) << program.said();
  participants = find_participants(program.pid());
  kill(participants["recorder"], SIGSTOP);  // with three frames to come it is not waited for before the end
  EXPECT_EQ(program.wait(), 4) << program.said();
  EXPECT_THAT(program.said(), AllOf(testing::ContainsRegex("(no word from|lost) recorder"), HasSubstr("energy residual"),
                                    testing::ContainsRegex("digest [0-9a-f]{16}")));
  EXPECT_NE(record::RecordReader(out() / "record.h5").read_text("status"), "done");
}

TEST_F(RecordOfARun, OfManyFramesIsWhole) {
  const std::vector<std::string> settings{"record.frames=600"};
  Program program = start("out", settings);
  expect_whole(program, 601, settings);
}

TEST_F(RecordOfARun, IsWholeThoughItsRecorderHasATenthOfACore) {
  const std::vector<std::string> settings{"record.frames=100"};
  Program program = start("out", settings);
  std::map<std::string, pid_t> participants;
  ASSERT_TRUE(program.wait_until([&] {
    participants = find_participants(program.pid());
    return participants.contains("recorder");
  }));
  const pid_t recorder = participants["recorder"];
  bool runs = true;
  auto change = std::chrono::steady_clock::now();
  program.wait_until([&] {  // 2 ms of every 20
    if (std::chrono::steady_clock::now() < change) return false;
    runs = !runs;
    kill(recorder, runs ? SIGCONT : SIGSTOP);
    change = std::chrono::steady_clock::now() + std::chrono::milliseconds(runs ? 2 : 18);
    return is_gone(recorder);
  });
  kill(recorder, SIGCONT);
  expect_whole(program, 101, settings);
}

TEST_F(RecordOfARun, IsWholeOnASlowDisk) {
  const Setting preload("LD_PRELOAD", INTERPLY_SLOW_DISK), slow("SLOW_DISK_MICROSECONDS", "5000");
  const std::vector<std::string> settings{"record.frames=4"};
  Program program = start("out", settings);
  expect_whole(program, 5, settings);
}

TEST_F(RecordOfARun, OnAFullDiskEndsTheRunAndSaysSo) {
  for (const bool in_process : {false, true}) {
    const std::string name = in_process ? "one" : "many";
    std::vector<std::string> settings{"record.frames=300", "motion.forming_time=1"};
    if (in_process) settings.push_back("--in-process");
    const Setting preload("LD_PRELOAD", INTERPLY_SLOW_DISK), room("SLOW_DISK_WRITES", "3000");
    Program program = start(name, settings);
    EXPECT_EQ(program.wait(), 1) << program.said();
    EXPECT_THAT(program.said(),
                AllOf(HasSubstr("cannot write " + (folder_.path() / name / "record.h5").string() + ": No space left"),
                      testing::ContainsRegex("the record takes [0-9.]+ MiB in all and [0-9.]+ MiB are free there"),
                      HasSubstr("record.frames"), HasSubstr("--out")));
    EXPECT_GE(record::RecordReader(folder_.path() / name / "record.h5").frames_complete(), 2);
  }
}

/// The record does not fit: nothing is formed, and nothing of it stays.
TEST_F(RecordOfARun, BeyondALimitOnFileSizesEndsTheRunBeforeItsFirstStep) {
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  for (const bool in_process : {false, true}) {
    const std::string name = in_process ? "one" : "many";
    std::vector<std::string> settings{"record.frames=300"};
    if (in_process) settings.push_back("--in-process");
    const rlimit limit{1 << 20, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
    Program program = start(name, settings);
    const int exit_code = program.wait();
    setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_EQ(exit_code, 1) << program.said();
    EXPECT_THAT(program.said(), AllOf(HasSubstr("File too large; the record takes"), HasSubstr("record.frames")));
    for (const char* file : {"record.h5", "record.h5.partial", "record.xdmf", "record.xdmf.partial"})
      EXPECT_FALSE(fs::exists(folder_.path() / name / file)) << file;
  }
}

}  // namespace
}  // namespace interply::faults
