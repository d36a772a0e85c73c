#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "launch/run.hpp"

namespace interply::launch {
namespace {

namespace fs = std::filesystem;

class RunFolderTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string path = testing::TempDir() + "folder-XXXXXX";
    out_ = mkdtemp(path.data());
    scene_.name = "sample";
    scene_.text = "name: sample\n";
  }
  void TearDown() override { fs::remove_all(out_); }
  fs::path out_;
  scene::Scene scene_;
};

TEST_F(RunFolderTest, HoldsTheResolvedScene) {
  const auto folder = prepare_folder(scene_, out_ / "a" / "b", false);
  std::string line;
  ASSERT_TRUE(std::getline(std::ifstream(folder.scene()), line));
  EXPECT_EQ(line, "name: sample");
  EXPECT_TRUE(fs::is_directory(folder.logs()));
}

TEST_F(RunFolderTest, ARecordIsReplacedOnlyWhenAskedFor) {
  std::ofstream(out_ / "record.h5") << "old";
  std::ofstream(out_ / "notes.txt") << "a person's own";
  EXPECT_THROW(prepare_folder(scene_, out_, false), OutputExists);
  EXPECT_TRUE(fs::exists(out_ / "record.h5"));
  prepare_folder(scene_, out_, true);
  EXPECT_FALSE(fs::exists(out_ / "record.h5"));
  EXPECT_TRUE(fs::exists(out_ / "notes.txt"));
}

TEST(RunName, HoldsNoCharacterWithAMeaningInPartitionsOrPaths) {
  EXPECT_THAT(make_run_name("a*b/c d?"), testing::MatchesRegex("a_b_c_d_-[0-9a-f]+-[0-9]+"));
}

TEST(TerminalTest, ShowsPlainLinesInALog) {
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* file = open_memstream(&text, &size);
  {
    Terminal terminal(file, false);
    terminal.show_progress("step 1");
    terminal.show_progress("step 2");  // too early for another line
    terminal.note("waiting for ply_2");
    terminal.show_progress("step 3");
    terminal.end_progress();
  }
  std::fclose(file);
  EXPECT_STREQ(text, "step 1\nwaiting for ply_2\nstep 3\n");
  std::free(text);
}

}  // namespace
}  // namespace interply::launch
