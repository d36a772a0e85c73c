/// `interply run` with real processes: same bits as in one process, and what it leaves when a person stops it.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <regex>

#include "faults/programs.hpp"

namespace interply::faults {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class FederatedRun : public testing::Test {
 protected:
  std::vector<std::string> command(const std::string& out, std::vector<std::string> more = {}) {
    std::vector<std::string> words{"run", kScenes / "flat_stack.yaml", "--out", folder_.path() / out};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// Digest line of a short run that must succeed.
  std::string digest_of(const std::string& out, std::vector<std::string> more) {
    Program program("interply", command(out, std::move(more)), folder_.path());
    EXPECT_EQ(program.wait(), 0) << program.said();
    EXPECT_TRUE(std::regex_match(program.last_line(), std::regex("digest [0-9a-f]{16}"))) << program.said();
    return program.last_line();
  }
  TemporaryFolder folder_;
};

TEST_F(FederatedRun, AgreesBitForBitWithInProcessOnEveryCarrierAndForAnyNumberOfThreads) {
  const std::vector<std::string> moving{"--set", "motion.stroke=2", "--set", "motion.forming_time=0.4e-3"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), moving.begin(), moving.end());
    return more;
  };
  const std::vector<std::string> two_threads{"--set", "layers.ply_1.threads=2",      "--set", "layers.ply_2.threads=2",
                                             "--set", "layers.sheet_upper.threads=2"};
  const auto reference = digest_of("in_process", with({"--in-process"}));
  EXPECT_EQ(digest_of("shm", with({})), reference);
  EXPECT_EQ(digest_of("ipc", with({"--address", "ipc"})), reference);
  EXPECT_EQ(digest_of("tcp", with({"--address", "tcp://127.0.0.1:0"})), reference);
  EXPECT_EQ(digest_of("threads", with(two_threads)), reference);
  EXPECT_EQ(digest_of("no_record", with({"--no-record"})), reference);
  EXPECT_FALSE(fs::exists(folder_.path() / "no_record/record.h5"));
  EXPECT_TRUE(fs::exists(folder_.path() / "no_record/summary.json"));

  const record::RecordReader federated(folder_.path() / "shm/record.h5");
  const record::RecordReader in_process(folder_.path() / "in_process/record.h5");
  EXPECT_EQ(federated.read_text("status"), "done");
  EXPECT_EQ("digest " + federated.read_text("digest"), reference);
  EXPECT_EQ(federated.frames_complete(), 5);
  EXPECT_TRUE((federated.read_position("ply_2", 4) == in_process.read_position("ply_2", 4)).all());
  EXPECT_EQ(federated.rows_complete(), in_process.rows_complete());
}

TEST_F(FederatedRun, KeepsTheResolvedSceneAndOneLogPerProcess) {
  digest_of("out", {"--set", "motion.forming_time=0.05e-3"});
  const auto out = folder_.path() / "out";
  EXPECT_THAT(read_text(out / "scene.yaml"), HasSubstr("forming_time"));
  for (const auto* name : {"coordinator", "recorder", "sheet_lower", "ply_1", "ply_2", "ply_3", "sheet_upper"})
    EXPECT_TRUE(fs::exists(out / "logs" / (std::string(name) + ".log"))) << name;
  // the resolved scene is a scene: it runs again, to the same bits
  Program again("interply", {"run", out / "scene.yaml", "--out", folder_.path() / "again", "--quiet"}, folder_.path());
  ASSERT_EQ(again.wait(), 0) << again.said();
  EXPECT_EQ("digest " + record::RecordReader(out / "record.h5").read_text("digest") + "\n", again.said());
}

TEST_F(FederatedRun, ARefusedSceneStartsNothing) {
  Program program("interply", command("out", {"--set", "layers.ply_2.thickness=-1"}), folder_.path());
  EXPECT_EQ(program.wait(), 2);
  EXPECT_THAT(program.said(), HasSubstr("thickness"));
  EXPECT_FALSE(fs::exists(folder_.path() / "out"));
}

TEST_F(FederatedRun, ARecordIsNotOverwrittenUnlessToldTo) {
  const std::vector<std::string> quick{"--set", "motion.forming_time=0.05e-3"};
  digest_of("out", quick);
  const auto record = read_text(folder_.path() / "out/record.h5");
  Program refused("interply", command("out", quick), folder_.path());
  EXPECT_EQ(refused.wait(), 2);
  EXPECT_THAT(refused.said(), HasSubstr("--overwrite"));
  EXPECT_TRUE(read_text(folder_.path() / "out/record.h5") == record);
  digest_of("out", {"--set", "motion.forming_time=0.05e-3", "--overwrite"});
}

/// The same for the federation and for one process.
class Interrupt : public FederatedRun, public testing::WithParamInterface<std::vector<std::string>> {};

TEST_P(Interrupt, LeavesAValidRecordAndNoProcess) {
  std::vector<std::string> more{"--set", "motion.forming_time=1", "--set", "record.frames=1000"};
  more.insert(more.end(), GetParam().begin(), GetParam().end());
  Program program("interply", command("out", more), folder_.path());
  ASSERT_TRUE(program.wait_until([&] { return is_under_way(folder_.path() / "out"); })) << program.said();
  const auto participants = find_participants(program.pid());
  EXPECT_EQ(participants.size(), GetParam().empty() ? 7u : 0u);
  program.send_signal(SIGINT);
  EXPECT_EQ(program.wait(), 5) << program.said();
  for (const auto& [name, pid] : participants) EXPECT_TRUE(is_gone(pid)) << name;
  const record::RecordReader record(folder_.path() / "out/record.h5");
  EXPECT_EQ(record.read_text("status"), "cancelled");
  EXPECT_GE(record.frames_complete(), 2);
  const std::string message = record.read_text("message");
  EXPECT_THAT(message, testing::MatchesRegex("the run was cancelled at step [0-9]+, [0-9.]+ ms, stroke 0\\.0 mm "
                                             "\\(interrupted by SIGINT\\)"));
  EXPECT_THAT(program.said(), HasSubstr(fmt::format("interply: {}; the record holds {} of 1001 frames\n", message,
                                                    record.frames_complete())));
}

INSTANTIATE_TEST_SUITE_P(OfBoth, Interrupt,
                         testing::Values(std::vector<std::string>{}, std::vector<std::string>{"--in-process"}),
                         [](const auto& info) { return info.param.empty() ? "Federation" : "OneProcess"; });

TEST_F(FederatedRun, ADivergingRunSaysWhyAndKeepsAValidRecord) {
  // A limit that round-off alone passes: the run must end in order, whoever computes it.
  for (const bool in_process : {false, true}) {
    const std::string out = in_process ? "one" : "many";
    auto words = command(out, {"--set", "time.energy_limit=1e-12", "--set", "motion.forming_time=10e-3"});
    if (in_process) words.push_back("--in-process");
    Program program("interply", words, folder_.path());
    EXPECT_EQ(program.wait(), 3) << program.said();
    const record::RecordReader record(folder_.path() / out / "record.h5");
    EXPECT_EQ(record.read_text("status"), "diverged");
    const std::string message = record.read_text("message"), said = program.said();
    EXPECT_THAT(message, HasSubstr("energy residual"));
    EXPECT_EQ(said.find(message), said.rfind(message)) << "once: " << said;
    EXPECT_THAT(said, HasSubstr(fmt::format("interply: the mechanics diverged: {}; the record holds {} of 5 frames\n",
                                            message, record.frames_complete())));
  }
}

}  // namespace
}  // namespace interply::faults
