#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <iterator>
#include <optional>
#include <thread>

#include "launch/run.hpp"

namespace interply::launch {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class RunFolderTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string path = testing::TempDir() + "folder-XXXXXX";
    out_ = mkdtemp(path.data());
    scene_.name = "sample";
    scene_.text = "name: sample\n";
  }
  void TearDown() override { fs::remove_all(out_); }
  static std::string read(const fs::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  fs::path out_;
  scene::Scene scene_;
};

TEST_F(RunFolderTest, HoldsTheResolvedSceneWhichIsASceneStill) {
  const auto folder = prepare_folder(scene_, out_ / "a" / "b", false);
  EXPECT_THAT(read(folder.scene()), testing::EndsWith("\nname: sample\n"));
  EXPECT_EQ(read(folder.scene())[0], '#') << "what marks it as a run's is a comment";
  EXPECT_TRUE(record::was_written_by_a_run(folder.scene()));
  EXPECT_TRUE(fs::is_directory(folder.logs()));
}

TEST_F(RunFolderTest, IsTakenByOneRunAtATimeWhoIsNamed) {
  std::optional<RunFolder> first(prepare_folder(scene_, out_, false));
  for (const bool overwrite : {false, true}) {
    try {
      prepare_folder(scene_, out_, overwrite);
      FAIL() << "two runs have one folder";
    } catch (const record::FolderRefused& e) {
      EXPECT_THAT(e.what(), HasSubstr("scene sample, process " + std::to_string(getpid())));
    }
  }
  first.reset();
  EXPECT_NO_THROW(prepare_folder(scene_, out_, true)) << "it is free again";
}

TEST_F(RunFolderTest, ThatCannotBeMadeIsNamed) {
  EXPECT_THAT([&] { prepare_folder(scene_, "/proc/no/folder", false); },
              testing::ThrowsMessage<std::runtime_error>(testing::AllOf(
                  HasSubstr("cannot make the folder /proc/no/folder: "), HasSubstr("choose another --out"))));
}

TEST_F(RunFolderTest, OfSeveralWhoComeAtOnceOneGetsIt) {
  for (int round = 0; round < 20; ++round) {
    std::atomic<int> winners = 0, arrived = 0;
    std::vector<std::jthread> runs;
    for (int i = 0; i < 4; ++i)
      runs.emplace_back([&] {
        try {
          const RunFolder mine = prepare_folder(scene_, out_, true);
          ++winners;
          ++arrived;
          while (arrived < 4) std::this_thread::yield();
        } catch (const record::FolderRefused&) {
          ++arrived;
        }
      });
    runs.clear();
    EXPECT_EQ(winners, 1);
  }
}

TEST_F(RunFolderTest, IsFreeAgainWhenItsOwnerIsKilled) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t owner = fork();
  if (owner == 0) {
    const RunFolder mine = prepare_folder(scene_, out_, false);
    [[maybe_unused]] const auto written = write(ready[1], "x", 1);
    pause();
  }
  char byte;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_THROW(prepare_folder(scene_, out_, true), record::FolderRefused);
  kill(owner, SIGKILL);
  waitpid(owner, nullptr, 0);
  EXPECT_NO_THROW(prepare_folder(scene_, out_, true));
}

TEST_F(RunFolderTest, WhatARunWroteIsReplacedOnlyWhenAskedFor) {
  { const auto folder = prepare_folder(scene_, out_, false); }
  record::begin_log(out_ / "logs/ply_7.log", "ply_7");
  EXPECT_THROW(prepare_folder(scene_, out_, false), record::FolderRefused);
  const auto folder = prepare_folder(scene_, out_, true);
  EXPECT_FALSE(fs::exists(out_ / "logs/ply_7.log")) << "a log of an earlier run with other layers";
}

TEST_F(RunFolderTest, NothingOfAPersonsOwnIsTouchedWhateverItsName) {
  fs::create_directories(out_ / "logs");
  for (const char* name : {"scene.yaml", "record.h5", "record.xdmf", "record.h5.partial", "summary.json",
                           "logs/coordinator.log", "logs/ply_1.log"}) {
    scene_.layers.resize(1);
    scene_.layers[0].name = "ply_1";
    std::ofstream(out_ / name) << "a person's own";
    try {
      prepare_folder(scene_, out_, true);
      FAIL() << name;
    } catch (const record::FolderRefused& e) {
      EXPECT_THAT(e.what(), HasSubstr(name));
    }
    EXPECT_EQ(read(out_ / name), "a person's own");
    fs::remove(out_ / name);
  }
  for (const char* name : {"notes.txt", "logs/diary.log", ".interply-lock.old"})
    std::ofstream(out_ / name) << "a person's own";
  prepare_folder(scene_, out_, true);
  for (const char* name : {"notes.txt", "logs/diary.log", ".interply-lock.old"})
    EXPECT_EQ(read(out_ / name), "a person's own") << name;
}

TEST_F(RunFolderTest, AResolvedSceneThatSomebodyChangedIsTheirs) {
  { const auto folder = prepare_folder(scene_, out_, false); }
  std::ofstream(out_ / "scene.yaml", std::ios::app) << "motion: {stroke: 7}\n";
  EXPECT_THROW(prepare_folder(scene_, out_, true), record::FolderRefused);
  EXPECT_THAT(read(out_ / "scene.yaml"), HasSubstr("stroke: 7"));
}

TEST_F(RunFolderTest, ALinkIsNotFollowed) {
  std::ofstream(out_ / "thesis.tex") << "a person's own";
  for (const char* name : {"scene.yaml", "record.h5", "record.h5.partial", ".interply-lock"}) {
    fs::create_symlink(out_ / "thesis.tex", out_ / name);
    EXPECT_ANY_THROW(prepare_folder(scene_, out_, true)) << name;
    EXPECT_EQ(read(out_ / "thesis.tex"), "a person's own") << name;
    fs::remove(out_ / name);
  }
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
