/// Supervision of processes, with shell scripts in the place of coordinator, solvers and recorder.
#include "launch/federation.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <sstream>

namespace interply::launch {
namespace {

using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

constexpr std::chrono::seconds kBusy{2};  ///< for a machine that has other work

Participant shell(const std::string& name, const std::string& script) { return {name, {"/bin/sh", "-c", script}}; }

/// A federation of scripts, its folder and what it showed.
class FederationOfScripts : public testing::Test {
 protected:
  void SetUp() override {
    std::string path = testing::TempDir() + "federation-XXXXXX";
    folder_ = mkdtemp(path.data());
  }
  void TearDown() override { fs::remove_all(folder_); }

  RunResult supervise(const std::string& coordinator, std::vector<Participant> others) {
    const auto shown = folder_ / "shown";
    std::FILE* file = std::fopen(shown.c_str(), "w");
    Terminal terminal(file, false);
    FederationPlan plan{shell("coordinator", coordinator), [others](const std::string&) { return others; }, folder_,
                        30};
    const auto result = Federation(std::move(plan), terminal).supervise();
    std::fclose(file);
    shown_ = read(shown);
    return result;
  }

  /// True if the process that wrote its number into `file` is gone.
  bool is_gone(const std::string& file) const {
    std::istringstream text(read(folder_ / file));
    pid_t pid = 0;
    return (text >> pid) && kill(pid, 0) != 0 && errno == ESRCH;
  }
  /// Script that keeps its number in `file`.
  std::string remember(const std::string& file) const { return "echo $$ > " + (folder_ / file).string() + "; "; }

  static std::string read(const fs::path& path) {
    std::ifstream file(path);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
  }

  fs::path folder_;
  std::string shown_;
};

TEST_F(FederationOfScripts, PassesOnSummaryDigestAndNotes) {
  const auto result = supervise(
      "echo @bound somewhere; echo a note; echo '@progress stroke 1 mm'; echo '@summary first'; echo '@summary'; "
      "echo '@summary   third'; echo '@json {'; echo '@json }'; echo '@digest 0123456789abcdef'",
      {shell("ply_1", "exit 0"), shell("recorder", "exit 0")});
  EXPECT_EQ(result.exit_code, kDone);
  EXPECT_EQ(result.message, "");
  EXPECT_EQ(result.summary, "first\n\n  third");
  EXPECT_EQ(result.summary_json, "{\n}\n");
  EXPECT_EQ(result.digest, "0123456789abcdef");
  EXPECT_THAT(shown_, HasSubstr("a note\n"));
  EXPECT_THAT(shown_, HasSubstr("stroke 1 mm\n"));
  EXPECT_THAT(read(folder_ / "coordinator.log"), HasSubstr("a note\n"));
  EXPECT_THAT(read(folder_ / "coordinator.log"), Not(HasSubstr("@progress")));
}

TEST_F(FederationOfScripts, StartsOthersOnlyWhenTheCoordinatorListens) {
  const auto result = supervise("echo 'cannot bind to x'; exit 2", {shell("ply_1", remember("ply_1") + "exit 0")});
  EXPECT_EQ(result.exit_code, kRefused);
  EXPECT_THAT(result.message, HasSubstr("cannot bind to x"));
  EXPECT_FALSE(fs::exists(folder_ / "ply_1"));
}

TEST_F(FederationOfScripts, ACoordinatorThatIsKilledBeforeItListensIsLost) {
  const auto result = supervise("kill -9 $$", {});
  EXPECT_EQ(result.exit_code, kLost);
  EXPECT_THAT(result.message, HasSubstr("coordinator (process "));
}

TEST_F(FederationOfScripts, NamesAKilledProcessWithItsLastLines) {
  const auto result = supervise(remember("coordinator") + "echo @bound x; exec sleep 600",
                                {shell("ply_1", remember("ply_1") + "exec sleep 600"),
                                 shell("ply_2", "for i in 1 2 3 4 5 6 7; do echo line $i; done; kill -9 $$"),
                                 shell("recorder", remember("recorder") + "exec sleep 600")});
  EXPECT_EQ(result.exit_code, kLost);
  EXPECT_THAT(result.message, HasSubstr("ply_2"));
  EXPECT_THAT(result.message, HasSubstr("signal 9"));
  EXPECT_THAT(result.message, HasSubstr("line 3\n    line 4\n    line 5\n    line 6\n    line 7"));
  EXPECT_THAT(result.message, Not(HasSubstr("line 2")));
  for (const auto* name : {"coordinator", "ply_1", "recorder"}) EXPECT_TRUE(is_gone(name)) << name;
}

TEST_F(FederationOfScripts, NamesTheCrashAndNotWhoLeftInOrderBecauseOfIt) {
  const auto result = supervise("echo @bound x; sleep 0.5; echo 'ply_1 is lost'; exit 4",
                                {shell("ply_1", "kill -SEGV $$"), shell("ply_2", "sleep 0.6; exit 4")});
  EXPECT_EQ(result.exit_code, kLost);
  EXPECT_THAT(result.message, testing::StartsWith("ply_1 "));
}

/// Its connection is closed before its end is seen, and others that leave because of it may come first: whom the
/// coordinator names is described, whenever it is reaped.
TEST_F(FederationOfScripts, WhoIsNamedAsLostIsDescribedHoweverLateItsEndIsSeen) {
  const auto result =
      supervise("echo @bound x; sleep 0.3; echo 'lost ply_1 at step 3: the connection was lost'; exit 4",
                {shell("ply", "sleep 0.1; exit 4"), shell("ply_10", "sleep 0.35; exit 4"),
                 shell("ply_1", "echo no convergence; sleep 0.6; exit 0")});
  EXPECT_EQ(result.exit_code, kLost);
  EXPECT_THAT(result.message, testing::AllOf(HasSubstr("\nply_1 (process "), HasSubstr("left with exit code 0"),
                                             HasSubstr("no convergence"), Not(HasSubstr("ply_10 (process")),
                                             Not(HasSubstr("ply (process"))));
}

TEST_F(FederationOfScripts, ASolverThatGivesUpAtStartIsNamedEvenIfTheCoordinatorDoesNotNotice) {
  const auto result = supervise(remember("coordinator") + "echo @bound x; exec sleep 600",
                                {shell("ply_1", "echo no recorder; exit 4")});
  EXPECT_EQ(result.exit_code, kLost);
  EXPECT_THAT(result.message, HasSubstr("ply_1"));
  EXPECT_THAT(result.message, HasSubstr("no recorder"));
  EXPECT_TRUE(is_gone("coordinator"));
}

TEST_F(FederationOfScripts, ALostCoordinatorIsNamed) {
  const auto result = supervise("echo @bound x; sleep 0.3; kill -9 $$",
                                {shell("ply_1", remember("ply_1") + "exec sleep 600"), shell("recorder", "exit 0")});
  EXPECT_EQ(result.exit_code, kLost);
  EXPECT_THAT(result.message, testing::StartsWith("coordinator "));
  EXPECT_TRUE(is_gone("ply_1"));
}

TEST_F(FederationOfScripts, ARecorderThatFailsIsNamedWithItsReasonEvenIfTheCoordinatorSaysNothing) {
  const auto result =
      supervise("trap 'echo stopping; exit 5' TERM; echo @bound x; while :; do sleep 0.1; done",
                {shell("ply_1", remember("ply_1") + "exec sleep 600"), shell("recorder", "echo disk full; exit 1")});
  EXPECT_EQ(result.exit_code, kFailed);
  EXPECT_THAT(result.message, HasSubstr("recorder"));
  EXPECT_THAT(result.message, HasSubstr("disk full"));
  EXPECT_THAT(read(folder_ / "coordinator.log"), HasSubstr("stopping"));
  EXPECT_TRUE(is_gone("ply_1"));
}

TEST_F(FederationOfScripts, TheCoordinatorsReasonIsKeptAndAStoppedProcessDoesNotStay) {
  const auto result = supervise("echo @bound x; sleep 0.3; echo 'ply_1 was silent for 60 s'; exit 4",
                                {shell("ply_1", remember("ply_1") + "kill -STOP $$")});
  EXPECT_EQ(result.exit_code, kLost);
  EXPECT_THAT(result.message, HasSubstr("ply_1 was silent for 60 s"));
  EXPECT_TRUE(is_gone("ply_1"));
}

TEST_F(FederationOfScripts, DivergenceIsTheCoordinatorsWord) {
  const auto result = supervise("echo @bound x; sleep 0.2; echo 'ply_1: element 3 is inverted'; exit 3",
                                {shell("ply_1", "exit 3"), shell("recorder", "sleep 0.4")});
  EXPECT_EQ(result.exit_code, kDiverged);
  EXPECT_THAT(result.message, HasSubstr("ply_1: element 3 is inverted"));
}

TEST_F(FederationOfScripts, WhatEndedTheRunIsSaidOnce) {
  const auto count = [&](const std::string& text, const std::string& words) {
    int n = 0;
    for (std::size_t at = 0; (at = text.find(words, at)) != text.npos; at += words.size()) ++n;
    return n;
  };
  for (const int code : {1, 3, 4, 5}) {
    const auto result = supervise(fmt::format("echo @bound x; sleep 0.2; echo '@reason it was so'; exit {}", code),
                                  {shell("ply_1", "sleep 0.3; exit 4")});
    EXPECT_EQ(result.exit_code, code);
    EXPECT_EQ(count(result.message, "it was so"), 1) << result.message;
    EXPECT_EQ(count(result.message, "\n"), 0) << "no log is quoted: " << result.message;
    EXPECT_EQ(count(shown_, "it was so"), 0) << shown_;
    EXPECT_THAT(read(folder_ / "coordinator.log"), HasSubstr("\nreason it was so\n"));
  }
  const auto result = supervise("echo '@reason cannot listen at x'; exit 2", {});
  EXPECT_EQ(count(result.message + shown_, "cannot listen at x"), 1) << result.message << shown_;
}

TEST_F(FederationOfScripts, ACancelledRunsReasonIsTheCoordinators) {
  const auto result = supervise(
      "trap \"echo '@reason the run was cancelled at step 3'; exit 5\" TERM; echo @bound x; kill -TERM $PPID; "
      "while :; do sleep 0.05; done",
      {});
  EXPECT_EQ(result.exit_code, kCancelled);
  EXPECT_EQ(result.message, "the run was cancelled at step 3");
}

/// A group whose members' parents are all in it or in another session cannot be stopped: so this has one of its own.
TEST_F(FederationOfScripts, ASuspensionStopsAllAndCountsForNoDeadline) {
  const pid_t child = fork();
  if (child != 0) {
    int status = -1;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
    return;
  }
  setpgid(0, 0);
  const std::string launcher = std::to_string(getpid());
  const fs::path states = folder_ / "states";
  // The last one is in no process group or session of ours: it sees all stopped, and continues us.
  const std::string observer = "setsid sh -c 'until grep -q \"^State:.T\" /proc/" + launcher +
                               "/status; do sleep 0.02; done; sleep 1.2; for p in " + launcher + " $(cat " +
                               (folder_ / "coordinator").string() + " " + (folder_ / "ply_1").string() +
                               "); do grep ^State /proc/$p/status; done > " + states.string() + "; kill -CONT " +
                               launcher + "' &";
  const auto result =
      supervise(observer + remember("coordinator") + "echo @bound x; while [ ! -s " + (folder_ / "ply_1").string() +
                    " ]; do sleep 0.02; done; kill -TSTP $PPID; sleep 0.2; exit 0",
                {shell("ply_1", remember("ply_1") + "sleep 0.5; exit 0")});
  EXPECT_EQ(result.exit_code, kDone) << result.message;
  EXPECT_THAT(read(states), testing::MatchesRegex("(State:.T[^\n]*\n){3}"));
  std::fflush(nullptr);
  _exit(HasFailure() ? 1 : 0);
}

TEST_F(FederationOfScripts, AnInterruptLetsTheCoordinatorStopEveryone) {
  const auto result =
      supervise("trap 'kill -TERM $(cat " + (folder_ / "ply_1").string() +
                    "); echo stopped; exit 5' INT; echo @bound x; "
                    "while [ ! -s " +
                    (folder_ / "ply_1").string() +
                    " ]; do sleep 0.05; done; kill -INT $PPID; "
                    "while :; do sleep 0.05; done",
                {shell("ply_1", "trap 'exit 5' TERM; " + remember("ply_1") + "while :; do sleep 0.05; done")});
  EXPECT_EQ(result.exit_code, kCancelled);
  EXPECT_THAT(read(folder_ / "coordinator.log"), HasSubstr("stopped"));
  EXPECT_TRUE(is_gone("ply_1"));
}

TEST_F(FederationOfScripts, ASecondInterruptKills) {
  const auto result = supervise(remember("coordinator") +
                                    "trap '' INT TERM; echo @bound x; kill -INT $PPID; sleep 0.3; "
                                    "kill -INT $PPID; while :; do sleep 1; done",
                                {shell("ply_1", "trap '' TERM; " + remember("ply_1") + "while :; do sleep 1; done")});
  EXPECT_EQ(result.exit_code, kCancelled);
  EXPECT_TRUE(is_gone("coordinator"));
}

TEST_F(FederationOfScripts, AChildHasNoDescriptorOfOursButTheOneThatItIsGiven) {
  const int foreign = open("/dev/null", O_RDONLY), given = open("/dev/null", O_RDONLY);  // not closed on exec
  Participant recorder = shell("recorder", "exec > " + (folder_ / "recorder_fd").string() + "; ls /proc/$$/fd; :");
  recorder.inherited = given;
  const auto result =
      supervise("echo @bound x; sleep 0.2",
                {shell("ply_1", "exec > " + (folder_ / "ply_1_fd").string() + "; ls /proc/$$/fd; :"), recorder});
  close(foreign);
  close(given);
  EXPECT_EQ(result.exit_code, kDone) << result.message;
  EXPECT_EQ(read(folder_ / "ply_1_fd"), "0\n1\n2\n");
  EXPECT_EQ(read(folder_ / "recorder_fd"), "0\n1\n2\n" + std::to_string(given) + "\n");
}

TEST_F(FederationOfScripts, WhatAChildSaysReachesNoTerminalUnescaped) {
  const auto result =
      supervise("echo @bound x; printf 'a note\\033[2J\\n@progress \\033]0;title\\007\\n'; sleep 0.2",
                {shell("ply_1", "printf '@digest 0000000000000000\\n@summary a lie\\nboom\\033[31m\\n'; kill -9 $$")});
  EXPECT_EQ(result.digest, "") << "the coordinator alone says digests";
  EXPECT_EQ(result.summary, "");
  EXPECT_THAT(result.message, HasSubstr("boom\\x1b[31m"));
  EXPECT_EQ(shown_.find('\x1b'), std::string::npos) << shown_;
}

TEST_F(FederationOfScripts, AllHaveEndedTwoSecondsAfterASignalHoweverDeafTheyAre) {
  const fs::path signalled = folder_ / "signalled";
  const auto deaf = [&](const std::string& name) {
    return shell(name, "trap '' INT TERM HUP; " + remember(name) + "while :; do sleep 0.05; done");
  };
  const auto result = supervise("trap '' INT TERM HUP; echo @bound x; while [ ! -s " + (folder_ / "ply_1").string() +
                                    " ]; do sleep 0.02; done; : > " + signalled.string() +
                                    "; kill -HUP $PPID; while :; do sleep 0.05; done",
                                {deaf("ply_1"), deaf("recorder")});
  const auto end = fs::file_time_type::clock::now();
  EXPECT_EQ(result.exit_code, kCancelled);
  EXPECT_TRUE(is_gone("ply_1") && is_gone("recorder"));
  EXPECT_LT(end - fs::last_write_time(signalled), std::chrono::seconds(2) + kBusy);
}

TEST_F(FederationOfScripts, AMissingProgramIsNamed) {
  EXPECT_THROW(
      {
        try {
          supervise("echo @bound x; exec sleep 600", {{"ply_1", {"/no/such/program"}}});
        } catch (const std::system_error& e) {
          EXPECT_THAT(e.what(), HasSubstr("/no/such/program"));
          throw;
        }
      },
      std::system_error);
}

}  // namespace
}  // namespace interply::launch
