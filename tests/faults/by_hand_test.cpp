/// The programs started one by one, as on several hosts: `interply run` does nothing that a person could not.
#include <gmock/gmock.h>

#include <memory>

#include "exchange/link.hpp"
#include "faults/programs.hpp"

namespace interply::faults {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class ByHand : public testing::Test {
 protected:
  /// Starts a coordinator on a free port and waits for its address.
  void start_coordinator(std::vector<std::string> more) {
    std::vector<std::string> words{"--bind", "tcp://127.0.0.1:*", "--scene", kScenes / "flat_stack.yaml", "--run",
                                   run_};
    words.insert(words.end(), more.begin(), more.end());
    coordinator_ = std::make_unique<Program>("interply-coordinator", words, folder_.path());
    ASSERT_TRUE(coordinator_->wait_for_words("listening at ")) << coordinator_->said();
    const auto& said = coordinator_->said();
    const auto begin = said.find("listening at ") + 13;
    address_ = said.substr(begin, said.find('\n', begin) - begin);
  }
  std::unique_ptr<Program> start_solver(const std::string& kind, const std::string& layer) {
    fs::create_directories(folder_.path() / layer);
    return std::make_unique<Program>("interply-solver-" + kind,
                                     std::vector<std::string>{"--connect", address_, "--layer", layer},
                                     folder_.path() / layer);
  }

  TemporaryFolder folder_;
  const std::string run_ = "by_hand_" + std::to_string(getpid());
  std::string address_;
  std::unique_ptr<Program> coordinator_;
};

TEST_F(ByHand, ARunNeedsAddressAndLayerOnly) {
  start_coordinator({"--set", "motion.forming_time=0.2e-3"});
  Program recorder("interply-recorder", {"--connect", address_, "--out", folder_.path()}, folder_.path());
  std::vector<std::unique_ptr<Program>> solvers;
  for (const auto* ply : {"ply_3", "ply_1", "ply_2"}) solvers.push_back(start_solver("fabric", ply));
  for (const auto* sheet : {"sheet_upper", "sheet_lower"}) solvers.push_back(start_solver("metal", sheet));
  EXPECT_EQ(coordinator_->wait(), 0) << coordinator_->said();
  for (auto& solver : solvers) EXPECT_EQ(solver->wait(), 0) << solver->said();
  EXPECT_EQ(recorder.wait(), 0) << recorder.said();
  const record::RecordReader record(folder_.path() / "record.h5");
  EXPECT_EQ(record.read_text("status"), "done");
  EXPECT_EQ(coordinator_->last_line(), "digest " + record.read_text("digest"));
  EXPECT_THAT(coordinator_->said(), AllOf(HasSubstr("energy residual"), Not(HasSubstr("@")), Not(HasSubstr("{"))));
}

TEST_F(ByHand, AMissingParticipantIsNamedAtTheStartUpDeadline) {
  start_coordinator({"--set", "exchange.startup_deadline=3", "--set", "record.frames=0"});
  auto solver = start_solver("fabric", "ply_2");
  EXPECT_EQ(coordinator_->wait(), 4) << coordinator_->said();
  EXPECT_THAT(coordinator_->said(), AllOf(HasSubstr("joined ply_2; missing "),
                                          testing::ContainsRegex("missing .*sheet_lower.*ply_1.*ply_3.*sheet_upper")));
  EXPECT_EQ(solver->wait(), 4) << solver->said();
}

TEST_F(ByHand, ACancelledRunSaysWhenAndHowManyFramesAreKept) {
  start_coordinator({"--set", "motion.forming_time=1", "--set", "record.frames=1000"});
  Program recorder("interply-recorder", {"--connect", address_, "--out", folder_.path()}, folder_.path());
  std::vector<std::unique_ptr<Program>> solvers;
  for (const auto* ply : {"ply_3", "ply_1", "ply_2"}) solvers.push_back(start_solver("fabric", ply));
  for (const auto* sheet : {"sheet_upper", "sheet_lower"}) solvers.push_back(start_solver("metal", sheet));
  ASSERT_TRUE(coordinator_->wait_until([&] { return is_under_way(folder_.path()); })) << coordinator_->said();
  ASSERT_TRUE(coordinator_->wait_for_words("stroke ")) << coordinator_->said();
  coordinator_->send_signal(SIGTERM);
  EXPECT_EQ(coordinator_->wait(), 5) << coordinator_->said();
  EXPECT_THAT(coordinator_->last_line(),
              testing::MatchesRegex("the run was cancelled at step [0-9]+, [0-9.]+ ms, stroke 0\\.0 mm "
                                    "\\(interrupted by SIGTERM\\); the record holds [0-9]+ of 1001 frames"));
  for (auto& solver : solvers) EXPECT_EQ(solver->wait(), 5) << solver->said();
  EXPECT_EQ(recorder.wait(), 0) << recorder.said();
  const record::RecordReader record(folder_.path() / "record.h5");
  EXPECT_THAT(coordinator_->last_line(),
              HasSubstr("holds " + std::to_string(record.frames_complete()) + " of 1001 frames"));
}

TEST_F(ByHand, AWrongSolverAndADuplicateAreRefusedAndTheRunGoesOn) {
  start_coordinator({"--set", "motion.forming_time=0.1e-3", "--set", "record.frames=0"});
  auto ply_1 = start_solver("fabric", "ply_1");
  ASSERT_TRUE(coordinator_->wait_for_words("ply_1 joined")) << coordinator_->said();
  auto duplicate = start_solver("fabric", "ply_1");
  EXPECT_EQ(duplicate->wait(), 2) << duplicate->said();
  auto stranger = start_solver("fabric", "ply_9");
  EXPECT_EQ(stranger->wait(), 2) << stranger->said();
  auto of_another_kind = start_solver("metal", "ply_2");
  EXPECT_EQ(of_another_kind->wait(), 2) << of_another_kind->said();
  EXPECT_THAT(of_another_kind->said(), HasSubstr("start interply-solver-fabric for it"));
  std::vector<std::unique_ptr<Program>> others;
  for (const auto* ply : {"ply_2", "ply_3"}) others.push_back(start_solver("fabric", ply));
  for (const auto* sheet : {"sheet_lower", "sheet_upper"}) others.push_back(start_solver("metal", sheet));
  EXPECT_EQ(coordinator_->wait(), 0) << coordinator_->said();
  EXPECT_EQ(ply_1->wait(), 0) << ply_1->said();
}

/// The programs that `interply run` starts, told nonsense by a person.
TEST(Programs, WrongOptionsAreOneSentenceAndExitCodeTwo) {
  const TemporaryFolder folder;
  const auto run = [&](const std::string& name, const std::vector<std::string>& arguments) {
    Program program(name, arguments, folder.path());
    const int exit_code = program.wait();
    return std::pair(exit_code, program.said());
  };
  for (const std::string name :
       {"interply-coordinator", "interply-recorder", "interply-solver-metal", "interply-solver-fabric"}) {
    const auto [code, said] = run(name, {"--bogus=1"});
    EXPECT_EQ(code, 2);
    EXPECT_EQ(said, name + ": there is no option --bogus (see --help)\n");
    EXPECT_EQ(run(name, {}).first, 2);
    EXPECT_EQ(run(name, {"--version"}), std::pair(0, std::string(exchange::kVersion) + "\n"));
    EXPECT_EQ(run(name, {"--help"}).first, 0);
  }
  const auto [code, said] = run("interply-solver-metal",
                                {"--connect", "shm://x", "--layer", "a", "--silence", "1e" + std::string(5000, '9')});
  EXPECT_EQ(code, 2);
  EXPECT_LT(said.size(), 400u);
  for (const std::string never : {"-1", "0", "inf", "soon"})
    EXPECT_EQ(run("interply-recorder", {"--connect", "shm://x", "--out", "a", "--deadline", never}),
              std::pair(2, "interply-recorder: --deadline: " + never + " is not in (0, inf) s (see --help)\n"));
}

TEST(Programs, ASocketThatIsNotThereIsSaidAtOnce) {
  const TemporaryFolder folder;
  const std::string socket = folder.path() / "none.sock";
  Program solver("interply-solver-metal", {"--connect", "ipc://" + socket, "--layer", "a", "--deadline", "0.5"},
                 folder.path());
  EXPECT_NE(solver.wait(), 0);
  EXPECT_EQ(solver.said().substr(0, solver.said().find('\n')),
            "there is no socket " + socket + " yet; trying for 0.5 s");
}

}  // namespace
}  // namespace interply::faults
