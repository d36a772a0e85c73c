/// What belongs to whom: folders, files, addresses and the scene of a run.
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <regex>

#include "faults/programs.hpp"

namespace interply::faults {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string kScene = R"(name: small
blank: {length: 200, width: 200, symmetry: half, mesh_size: 20}
layers:
  - {name: ply_1, thickness: 1.2, density: 6.19e-10, law: {woven: {variant: full}}}
tools:
  die: {edge: 60, offset: 22, shoulder: 10}
  blank_holder: {edge: 60, offset: 22, shoulder: 10, pressure: 1, ramp: 1e-4}
motion: {stroke: 0, forming_time: 1e-5}
record: {frames: 2, history: 10}
)";

class Ownership : public testing::Test {
 protected:
  void SetUp() override { std::ofstream(scene()) << kScene; }
  fs::path scene() const { return folder_.path() / "small.yaml"; }
  std::vector<std::string> run(const std::string& out, std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"run", scene(), "--out", folder_.path() / out};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// In a shell; what it says is in `said_`. @return exit code
  int shell(const std::string& command) {
    const fs::path said = folder_.path() / "shell-said";
    const int status = std::system(("cd " + folder_.path().string() + "; (" + command + ") > " + said.string() + " 2>&1").c_str());
    said_ = read_text(said);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  TemporaryFolder folder_;
  std::string said_;
};

TEST_F(Ownership, CheckAndRunRefuseTheSameAddressesBeforeAnythingIsStarted) {
  std::ofstream(folder_.path() / "file") << "a thesis";
  for (const std::string& address : std::vector<std::string>
       {"tcp://127.0.0.1:99999", "tcp://127.0.0.1:-1", "tcp://127.0.0.1:abc", "tcp://127.0.0.1", "tcp://192.0.2.1:7100",
        "tcp://no.such.host.invalid:7100", "ipc:///no/such/folder/x", "ipc://" + (folder_.path() / "file").string()}) {
    Program check("interply", {"check", scene(), "--set", "exchange.address=\"" + address + "\""}, folder_.path());
    EXPECT_EQ(check.wait(), 2) << address << "\n" << check.said();
    EXPECT_THAT(check.said(), HasSubstr("exchange.address: "));
    Program program("interply", run("out", {"--address", address}), folder_.path());
    EXPECT_EQ(program.wait(), 2) << address << "\n" << program.said();
    EXPECT_THAT(program.said(), HasSubstr("--address: "));
    Program coordinator("interply-coordinator", {"--bind", address, "--scene", scene()}, folder_.path());
    EXPECT_EQ(coordinator.wait(), 2) << address << "\n" << coordinator.said();
  }
  for (const char* address : {"tcp://127.0.0.1:70000", "tcp://[::1:7100", "udp://127.0.0.1:7100", "ipc://"}) {
    Program solver("interply-solver-fabric", {"--connect", address, "--layer", "ply_1"}, folder_.path());
    EXPECT_EQ(solver.wait(), 2) << address << "\n" << solver.said();
  }
  for (const char* command : {"check", "run"}) {
    Program program("interply", {command, scene(), "--set", "observe.network=no_such_net"}, folder_.path());
    EXPECT_EQ(program.wait(), 2) << program.said();
    EXPECT_THAT(program.said(), HasSubstr("observe.network"));
  }
  EXPECT_FALSE(fs::exists(folder_.path() / "out"));
  EXPECT_EQ(read_text(folder_.path() / "file"), "a thesis");
}

TEST_F(Ownership, ARunOverANameIsThatOverItsNumber) {
  std::string digests[2];
  for (const int i : {0, 1}) {
    const std::string out = "out" + std::to_string(i);
    Program program("interply", run(out, {"--address", i == 0 ? "tcp://127.0.0.1:0" : "tcp://localhost:0"}), folder_.path());
    EXPECT_EQ(program.wait(), 0) << program.said();
    digests[i] = program.last_line();
  }
  EXPECT_EQ(digests[0], digests[1]);
}

TEST_F(Ownership, APortThatIsTakenIsAFailureOfOursAndNothingIsReplaced) {
  const int taken = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof(name);
  ASSERT_EQ(::bind(taken, reinterpret_cast<sockaddr*>(&name), length), 0);
  ASSERT_EQ(::listen(taken, 1), 0);
  ASSERT_EQ(::getsockname(taken, reinterpret_cast<sockaddr*>(&name), &length), 0);
  Program first("interply", run("out"), folder_.path());
  EXPECT_EQ(first.wait(), 0) << first.said();
  const std::string record = read_text(folder_.path() / "out/record.h5");
  const std::string address = "tcp://127.0.0.1:" + std::to_string(ntohs(name.sin_port));
  Program second("interply", run("out", {"--overwrite", "--address", address}), folder_.path());
  EXPECT_EQ(second.wait(), 1) << second.said();
  EXPECT_THAT(second.said(), HasSubstr("somebody else"));
  EXPECT_TRUE(read_text(folder_.path() / "out/record.h5") == record);
  ::close(taken);
}

TEST_F(Ownership, ASecondRunIsToldWhoHasTheFolderAndTheFirstGoesOn) {
  Program first("interply", run("out", {"--set", "motion.forming_time=10", "--set", "record.frames=1000"}), folder_.path());
  ASSERT_TRUE(first.wait_until([&] { return is_under_way(folder_.path() / "out"); })) << first.said();
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--overwrite"}, {"--overwrite", "--in-process"}}) {
    fs::create_directories(folder_.path() / "second");
    Program second("interply", run("out", more), folder_.path() / "second");
    EXPECT_EQ(second.wait(), 2) << second.said();
    EXPECT_THAT(second.said(), AllOf(HasSubstr("is taken by another run"), HasSubstr("process " + std::to_string(first.pid()))));
  }
  first.send_signal(SIGINT);
  EXPECT_EQ(first.wait(), 5) << first.said();
  EXPECT_EQ(record::RecordReader(folder_.path() / "out/record.h5").read_text("status"), "cancelled");
}

TEST_F(Ownership, APersonsOwnFilesInTheFolderStay) {
  std::ofstream(folder_.path() / "scene.yaml") << kScene;
  EXPECT_EQ(shell((kPrograms / "interply").string() + " run scene.yaml --out . --overwrite"), 2) << said_;
  EXPECT_THAT(said_, HasSubstr("scene.yaml is in the way"));
  EXPECT_EQ(read_text(folder_.path() / "scene.yaml"), kScene);
}

TEST_F(Ownership, AFileIsNoFolder) {
  std::ofstream(folder_.path() / "scene.yaml") << kScene;
  for (const std::string out : {"scene.yaml", "scene.yaml/run"}) {
    EXPECT_EQ(shell((kPrograms / "interply").string() + " run scene.yaml --overwrite --out " + out), 2) << said_;
    EXPECT_THAT(said_, HasSubstr("scene.yaml is a file, not a folder, and stays: choose another --out"));
  }
  EXPECT_EQ(read_text(folder_.path() / "scene.yaml"), kScene);
}

TEST_F(Ownership, ACoordinatorComputesTheSceneThatItsLauncherMeant) {
  Program coordinator("interply-coordinator",
                      {"--bind", "ipc://" + (folder_.path() / "link").string(), "--scene", scene(), "--scene-digest",
                       "0123456789abcdef"},
                      folder_.path());
  EXPECT_EQ(coordinator.wait(), 2) << coordinator.said();
  EXPECT_THAT(coordinator.said(), AllOf(HasSubstr("is not the scene"), Not(HasSubstr("listening"))));
}

TEST_F(Ownership, WhatARunWritesIsTheUsersAlone) {
  EXPECT_EQ(shell("umask 0; " + (kPrograms / "interply").string() + " run small.yaml --out deep/out"), 0) << said_;
  std::vector<fs::path> written{folder_.path() / "deep", folder_.path() / "deep/out"};
  for (const auto& entry : fs::recursive_directory_iterator(folder_.path() / "deep")) written.push_back(entry.path());
  EXPECT_GE(written.size(), 8u);
  for (const fs::path& path : written)
    EXPECT_EQ(fs::status(path).permissions() & (fs::perms::group_all | fs::perms::others_all), fs::perms::none) << path;
}

TEST_F(Ownership, TooFewDescriptorsAreSaidInASentence) {
  for (const int n : {8, 16, 24}) {
    EXPECT_EQ(shell("ulimit -n " + std::to_string(n) + "; exec " + (kPrograms / "interply").string() +
                    " run small.yaml --out limited"),
              1)
        << said_;
    EXPECT_THAT(said_, AllOf(HasSubstr("ulimit -n"), Not(HasSubstr("ssert")))) << n;
    EXPECT_EQ(std::count(said_.begin(), said_.end(), '\n'), 1) << said_;
  }
  EXPECT_FALSE(fs::exists(folder_.path() / "limited"));
}

TEST_F(Ownership, TooLittleAddressSpaceIsSaidInASentence) {
  EXPECT_EQ(shell("ulimit -v 300000; exec " + (kPrograms / "interply").string() + " run small.yaml --out limited"), 1)
      << said_;
  EXPECT_THAT(said_, HasSubstr("ulimit -v"));
}

class Lone : public Ownership, public testing::WithParamInterface<int> {};

TEST_P(Lone, ASolverWithoutACoordinatorObeys) {
  Program solver("interply-solver-fabric",
                 {"--connect", "ipc://" + (folder_.path() / "nobody").string(), "--layer", "ply_1"}, folder_.path());
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  const auto start = std::chrono::steady_clock::now();
  solver.send_signal(GetParam());
  EXPECT_EQ(solver.wait(), 128 + GetParam());
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
}

TEST_P(Lone, ACoordinatorWithoutAnyoneObeysAndLeavesNoSocket) {
  const fs::path link = folder_.path() / "link";
  Program coordinator("interply-coordinator", {"--bind", "shm://" + link.string(), "--scene", scene()}, folder_.path());
  ASSERT_TRUE(coordinator.wait_for_words("listening at ")) << coordinator.said();
  const auto start = std::chrono::steady_clock::now();
  coordinator.send_signal(GetParam());
  EXPECT_EQ(coordinator.wait(), 5) << coordinator.said();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(3));
  EXPECT_FALSE(fs::exists(link));
}

INSTANTIATE_TEST_SUITE_P(OfEach, Lone, testing::Values(SIGINT, SIGTERM, SIGHUP),
                         [](const auto& info) { return std::string(sigabbrev_np(info.param)); });

}  // namespace
}  // namespace interply::faults
