/// The scripts of deploy/examples, with hosts that are all this one.
#include <gmock/gmock.h>

#include "faults/programs.hpp"

namespace interply::faults {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Hosts : public testing::Test {
 protected:
  /// Puts a command of this name, written in shell, before all others.
  void pretend(const std::string& name, const std::string& script) {
    std::ofstream(folder_.path() / name) << "#!/bin/sh\n" << script << '\n';
    fs::permissions(folder_.path() / name, fs::perms::owner_all);
  }
  /// Runs a shell's line in the source's folder, and keeps what it says. @return its exit code
  int run(const std::string& line) {
    const fs::path said = folder_.path() / "said";
    const int status = std::system(
        ("cd " INTERPLY_SOURCE_DIR "; export INTERPLY_ADDRESS=tcp://127.0.0.1:0 PATH=" + folder_.path().string() + ":" +
         kPrograms.string() + ":$PATH; " + line + " >" + said.string() + " 2>&1 </dev/null")
            .c_str());
    said_ = read_text(said);
    return WEXITSTATUS(status);
  }
  void expect_same_bits() {
    Program reference("interply", {"run", scene(), "--out", folder_.path() / "reference", "--in-process", "--quiet"},
                      folder_.path());
    EXPECT_EQ(reference.wait(), 0) << reference.said();
    EXPECT_THAT(said_, HasSubstr("\n" + reference.last_line() + "\n"));
    const record::RecordReader record(out() / "record.h5");
    EXPECT_EQ("digest " + record.read_text("digest"), reference.last_line());
    EXPECT_EQ(record.frames_complete(), 3);
  }
  /// The small stack, short enough.
  fs::path scene() {
    const fs::path file = folder_.path() / "scene.yaml";
    if (!fs::exists(file)) {
      std::string text = read_text(kScenes / "flat_stack.yaml");
      const auto replace = [&](const std::string& from, const std::string& to) {
        text.replace(text.find(from), from.size(), to);
      };
      replace("forming_time: 0.8e-3", "forming_time: 0.3e-3");
      replace("frames: 4", "frames: 2");
      std::ofstream(file) << text;
    }
    return file;
  }
  fs::path out() const { return folder_.path() / "out"; }

  TemporaryFolder folder_;
  std::string said_;
};

TEST_F(Hosts, SshFormsTheSameBits) {
  pretend("ssh", "while [ \"${1#-}\" != \"$1\" ]; do [ $1 != -o ] || shift; shift; done; shift; exec \"$@\"");
  ASSERT_EQ(run("deploy/examples/hosts.sh " + scene().string() + " " + out().string() + " a b c"), 0) << said_;
  EXPECT_THAT(said_, AllOf(HasSubstr("sheet_lower on a\n"), HasSubstr("ply_1 on b\n"), HasSubstr("ply_3 on a\n")));
  expect_same_bits();
}

TEST_F(Hosts, AJobOfSlurmFormsTheSameBits) {
  pretend("scontrol", "echo n1; echo n2");
  pretend("srun", "cat >/dev/null; while [ \"${1#-}\" != \"$1\" ]; do l=$1; shift; done; [ $l = --nodelist ] && shift; exec \"$@\"");
  ASSERT_EQ(run("SLURM_JOB_NODELIST='n[1-2]' SLURM_SUBMIT_DIR=$PWD deploy/examples/slurm_job.sh " + scene().string() +
                " " + out().string()),
            0)
      << said_;
  EXPECT_THAT(said_, AllOf(HasSubstr("sheet_lower on n1\n"), HasSubstr("ply_1 on n2\n")));
  expect_same_bits();
}

TEST_F(Hosts, ARefusedSceneEndsTheScriptWithItsSentence) {
  std::ofstream(folder_.path() / "scene.yaml") << "name: nothing\n";
  EXPECT_EQ(run("deploy/examples/hosts.sh " + scene().string() + " " + out().string() + " a"), 2) << said_;
  EXPECT_THAT(said_, HasSubstr("scene.yaml"));
}

TEST_F(Hosts, AHostThatCannotBeReachedIsALayerThatIsMissing) {
  pretend("ssh", "exit 255");
  std::string text = read_text(scene());
  std::ofstream(scene()) << text << "exchange: {startup_deadline: 1}\n";
  EXPECT_EQ(run("deploy/examples/hosts.sh " + scene().string() + " " + out().string() + " a"), 4) << said_;
  EXPECT_THAT(said_, HasSubstr("missing sheet_lower, ply_1, ply_2, ply_3, sheet_upper"));
}

}  // namespace
}  // namespace interply::faults
