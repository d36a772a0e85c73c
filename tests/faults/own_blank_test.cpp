/// Users' own blanks through the real programs: the same bits as in one process, and what a changed file leads to.
#include <gmock/gmock.h>

#include <regex>

#include "faults/programs.hpp"
#include "paths.hpp"

namespace interply::faults {
namespace {

using testing::HasSubstr;

/// The shipped scene of own blanks beside copies of its meshes, shortened.
class OwnBlank : public testing::Test {
 protected:
  OwnBlank() {
    const fs::path scenes = fs::path(INTERPLY_SOURCE_DIR) / "deploy/scenes";
    fs::copy(scenes / "own_blank.yaml", folder_.path());
    fs::copy(scenes / "meshes", folder_.path() / "meshes");
  }
  std::vector<std::string> run(const fs::path& scene, const std::string& out, std::vector<std::string> more = {}) {
    std::vector<std::string> words{"run", scene, "--out", folder_.path() / out};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  std::string digest_of(const fs::path& scene, const std::string& out, std::vector<std::string> more = {}) {
    for (const char* o : {"motion.stroke=1", "motion.forming_time=0.3e-3", "tools.blank_holder.ramp=0.1e-3"})
      more.insert(more.end(), {"--set", o});
    Program program("interply", run(scene, out, more), folder_.path());
    EXPECT_EQ(program.wait(), 0) << program.said();
    EXPECT_TRUE(std::regex_match(program.last_line(), std::regex("digest [0-9a-f]{16}"))) << program.said();
    return program.last_line();
  }
  void change_ply_mesh() { std::ofstream(folder_.path() / "meshes/octagon_ply.inp", std::ios::app) << "** changed\n"; }

  TemporaryFolder folder_;
};

TEST_F(OwnBlank, FederatedAndInOneProcessAreTheSameBits) {
  const fs::path scene = folder_.path() / "own_blank.yaml";
  const auto reference = digest_of(scene, "in_process", {"--in-process"});
  EXPECT_EQ(digest_of(scene, "shm"), reference);
  EXPECT_EQ(digest_of(scene, "tcp", {"--address", "tcp://127.0.0.1:0", "--set", "layers.ply_1.threads=2"}), reference);
  // the resolved scene names its files by absolute path and digest, and runs again
  const auto resolved = read_text(folder_.path() / "shm/scene.yaml");
  EXPECT_THAT(resolved, HasSubstr((folder_.path() / "meshes/octagon_ply.inp").string()));
  EXPECT_EQ(digest_of(folder_.path() / "shm/scene.yaml", "again"), reference);
}

TEST_F(OwnBlank, AResolvedSceneDoesNotRunOnAChangedFile) {
  digest_of(folder_.path() / "own_blank.yaml", "first", {"--in-process"});
  change_ply_mesh();
  Program program("interply", run(folder_.path() / "first/scene.yaml", "second"), folder_.path());
  EXPECT_EQ(program.wait(), 2) << program.said();
  EXPECT_THAT(program.said(), HasSubstr("blank.mesh.file: "));
  EXPECT_THAT(program.said(), HasSubstr("has changed since the scene was resolved"));
  EXPECT_FALSE(fs::exists(folder_.path() / "second"));
}

TEST_F(OwnBlank, ASolverThatReadsAnotherFileLeavesTheRunWithItsReason) {
  Program coordinator("interply-coordinator",
                      {"--bind", "tcp://127.0.0.1:*", "--scene", folder_.path() / "own_blank.yaml", "--run",
                       "own_blank_" + std::to_string(getpid()), "--set", "record.frames=0"},
                      folder_.path());
  ASSERT_TRUE(coordinator.wait_for_words("listening at ")) << coordinator.said();
  const auto begin = coordinator.said().find("listening at ") + 13;
  const std::string address = coordinator.said().substr(begin, coordinator.said().find('\n', begin) - begin);
  Program first("interply-solver-metal", {"--connect", address, "--layer", "sheet_lower"}, folder_.path());
  ASSERT_TRUE(coordinator.wait_for_words("sheet_lower joined")) << coordinator.said();  // it has read its files
  change_ply_mesh();
  Program solver("interply-solver-fabric", {"--connect", address, "--layer", "ply_1"}, folder_.path());
  EXPECT_EQ(solver.wait(), 2) << solver.said();
  EXPECT_THAT(solver.said(), HasSubstr("blank.mesh.file: "));
  EXPECT_THAT(solver.said(), HasSubstr("has changed since the scene was resolved"));
  EXPECT_EQ(coordinator.wait(), 4) << coordinator.said();
  EXPECT_THAT(coordinator.said(), HasSubstr("lost ply_1"));
  EXPECT_EQ(first.wait(), 4) << first.said();
}

TEST_F(OwnBlank, AnUnusableFileStartsNothing) {
  for (const char* command : {"check", "run"}) {
    Program program("interply", {command, folder_.path() / "own_blank.yaml", "--set", "blank.mesh.set=pli"},
                    folder_.path());
    EXPECT_EQ(program.wait(), 2) << program.said();
    EXPECT_THAT(program.said(), HasSubstr("has no element set 'pli'; did you mean 'ply'?"));
  }
}

}  // namespace
}  // namespace interply::faults
