#include "launch/command_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "launch/run.hpp"
#include "paths.hpp"

namespace interply::launch {
namespace {

using testing::HasSubstr;

struct Said {
  int exit_code;
  std::string out, error;
};

Said say(std::vector<std::string> words) {
  words.insert(words.begin(), "interply");
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int exit_code = run_command_line(static_cast<int>(arguments.size()), arguments.data());
  const std::string out = testing::internal::GetCapturedStdout();
  return {exit_code, out, testing::internal::GetCapturedStderr()};
}

TEST(CommandLine, HelpTellsTheExitCodes) {
  const auto said = say({"--help"});
  EXPECT_EQ(said.exit_code, kDone);
  for (const auto* words :
       {"run", "check", "point", "bench", "3  the mechanics diverged", "4  a process was lost", "5  cancelled"})
    EXPECT_THAT(said.out, HasSubstr(words));
}

TEST(CommandLine, HelpOfEachCommandShowsAnExample) {
  for (const std::string command : {"run", "check", "point", "bench"}) {
    const auto said = say({command, "--help"});
    EXPECT_EQ(said.exit_code, kDone);
    EXPECT_THAT(said.out, HasSubstr("example:\n  interply " + command));
  }
}

TEST(CommandLine, UnknownCommandNamesTheNearestOne) {
  const auto said = say({"chekc", "scene.yaml"});
  EXPECT_EQ(said.exit_code, kRefused);
  EXPECT_EQ(said.error, "interply: there is no command \"chekc\"; did you mean \"check\"?\n");
}

TEST(CommandLine, UnknownOptionNamesTheNearestOne) {
  const auto said = say({"run", "scene.yaml", "--overwrit"});
  EXPECT_EQ(said.exit_code, kRefused);
  EXPECT_EQ(said.error, "interply: run has no option --overwrit; did you mean --overwrite?\n");
}

TEST(CommandLine, SurplusAndMissingArgumentsAreRefused) {
  EXPECT_EQ(say({"run", "a.yaml", "b.yaml"}).error, "interply: run takes no further argument \"b.yaml\"\n");
  EXPECT_EQ(say({"run"}).exit_code, kRefused);
  EXPECT_EQ(say({"point", "law.yaml"}).exit_code, kRefused);
  EXPECT_EQ(say({}).exit_code, kRefused);
}

TEST(CommandLine, ASceneThatDoesNotExistIsRefused) {
  const auto said = say({"check", "/no/such/scene.yaml"});
  EXPECT_EQ(said.exit_code, kRefused);
  EXPECT_THAT(said.error, HasSubstr("/no/such/scene.yaml"));
}

TEST(CommandLine, ARefusedPathLeavesAnEarlierResultOfPointAlone) {
  std::string folder = testing::TempDir() + "point-XXXXXX";
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  const std::string law = INTERPLY_SOURCE_DIR "/deploy/scenes/laws/woven_soft.yaml";
  std::ofstream(folder + "/good.csv") << "F11,F12,F21,F22\n1.01,0,0,1\n";
  std::ofstream(folder + "/bad.csv") << "F11,F12,F21,F22\n1.01,0,x,1\n";
  const auto read = [&] {
    std::ifstream file(folder + "/out.csv");
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  EXPECT_EQ(say({"point", law, "--path", folder + "/good.csv", "-o", folder + "/out.csv"}).exit_code, kDone);
  const std::string result = read();
  EXPECT_THAT(result, HasSubstr("\n1.01,0,0,1,1.0201,1,0,"));
  EXPECT_EQ(say({"point", law, "--path", folder + "/bad.csv", "-o", folder + "/out.csv"}).exit_code, kRefused);
  EXPECT_EQ(read(), result);
  std::filesystem::remove_all(folder);
}

TEST(NearestName, TakesTheFewestEdits) {
  EXPECT_EQ(find_nearest_name("rnu", {"check", "run", "point"}), "run");
  EXPECT_EQ(find_nearest_name("x", {}), "");
}

}  // namespace
}  // namespace interply::launch
