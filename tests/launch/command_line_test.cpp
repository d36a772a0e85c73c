#include "launch/command_line.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

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
  for (const std::string command : {"run", "check", "init", "schema", "point", "bench"}) {
    const auto said = say({command, "--help"});
    EXPECT_EQ(said.exit_code, kDone);
    EXPECT_THAT(said.out, testing::ContainsRegex("examples?:\n  interply " + command));
  }
}

TEST(CommandLine, WithoutAWordShowsTheHelpAndIsRefused) {
  const auto said = say({});
  EXPECT_EQ(said.exit_code, kRefused);
  EXPECT_EQ(said.error, say({"--help"}).out);
}

/// A name that is near is proposed, and nothing that is not: then the names are listed.
TEST(CommandLine, UnknownWordsAreRefusedWithWhatWasMeant) {
  const std::string commands = "known: run, check, init, schema, point, bench";
  const std::vector<std::pair<std::vector<std::string>, std::string>> refusals{
      {{"chekc", "scene.yaml"}, "there is no command \"chekc\"; did you mean \"check\"?"},
      {{"rnu"}, "there is no command \"rnu\"; did you mean \"run\"?"},
      {{"scheme"}, "there is no command \"scheme\"; did you mean \"schema\"?"},
      {{"simulate"}, "there is no command \"simulate\"; " + commands},
      {{"hub"}, "there is no command \"hub\"; " + commands},
      {{"bench", "foo"}, "there is no command \"foo\"; known: exchange, stack"},
      {{"bench", "stak"}, "there is no command \"stak\"; did you mean \"stack\"?"},
      {{"bench", "hib"}, "there is no command \"hib\"; known: exchange, stack"},  // hub is none of a person's
      {{"bench", "--fast"}, "bench has no option --fast; known: --help"},
      {{"bench", "exchange", "--node", "7"}, "exchange has no option --node; did you mean --nodes?"},
      {{"--versoin"}, "there is no option --versoin; did you mean --version?"},
      {{"--bogus"}, "there is no option --bogus; known: --help, --version"},
      {{"--bogus=3", "run"}, "there is no option --bogus; known: --help, --version"},
      {{"-x"}, "there is no option -x; known: --help, --version"},
      {{"run", "scene.yaml", "--overwrit"}, "run has no option --overwrit; did you mean --overwrite?"},
      {{"run", "scene.yaml", "--over"}, "run has no option --over; did you mean --overwrite?"},
      {{"run", "scene.yaml", "--inprocess"}, "run has no option --inprocess; did you mean --in-process?"},
      {{"run", "scene.yaml", "-out", "x"}, "run has no option -out; did you mean --out?"},
      {{"run", "scene.yaml", "--adress=shm"}, "run has no option --adress; did you mean --address?"},
      {{"run", "--quite"}, "run has no option --quite; did you mean --quiet?"},  // before what is missing
      {{"run", "scene.yaml", "--threads", "3"},
       "run has no option --threads; known: --help, --with, --set, --out, --overwrite, --in-process, --address, "
       "--no-record, --quiet"},
      {{"check", "scene.yaml", "--sett", "a=1"}, "check has no option --sett; did you mean --set?"},
      {{"init", "cup", "--flm"}, "init has no option --flm; did you mean --fml?"},
      {{"schema", "--all"}, "schema has no option --all; known: --help"},
      {{"point", "law.yaml", "--pth", "a.csv"}, "point has no option --pth; did you mean --path?"},
  };
  for (const auto& [words, sentence] : refusals) {
    const auto said = say(words);
    EXPECT_EQ(said.exit_code, kRefused) << sentence;
    EXPECT_EQ(said.error, "interply: " + sentence + "\n");
  }
  EXPECT_THAT(say({"check", "scene.yaml", "--verbose"}).error,
              HasSubstr("check has no option --verbose; known: --help"));
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

/// Each scene that `init` writes is one that `check` finds nothing wrong with, and what is there stays.
TEST(CommandLine, InitWritesScenesThatRun) {
  std::string folder = testing::TempDir() + "init-XXXXXX";
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  int layers = 3;
  for (const std::string kind : {"--fml", "--plies", "--sheet"}) {
    const std::string scene = folder + "/cup" + kind;
    const auto wrote = say({"init", scene, kind});
    EXPECT_EQ(wrote.exit_code, kDone) << wrote.error;
    EXPECT_THAT(wrote.out, HasSubstr("wrote " + scene + ".yaml\n"));
    const auto checked = say({"check", scene + ".yaml"});
    EXPECT_EQ(checked.exit_code, kDone) << checked.error;
    EXPECT_THAT(checked.out, HasSubstr(fmt::format("cup{}: {} layer", kind, layers--)));
    EXPECT_THAT(checked.out, testing::Not(HasSubstr("warning")));
  }
  const auto again = say({"init", folder + "/cup--fml.yaml", "--sheet"});
  EXPECT_EQ(again.exit_code, kRefused);
  EXPECT_THAT(again.error, HasSubstr("cup--fml.yaml is there already and stays as it is"));
  EXPECT_EQ(say({"check", folder + "/cup--fml.yaml"}).exit_code, kDone);
  EXPECT_THAT(say({"init", folder + "/a b"}).error, HasSubstr("cannot name a scene"));
  EXPECT_EQ(say({"init", folder + "/two", "--fml", "--sheet"}).exit_code, kRefused);
  EXPECT_EQ(say({"init", folder + "/none/x"}).exit_code, kFailed);
  std::filesystem::remove_all(folder);
}

TEST(CommandLine, SchemaPrintsAPartOrRefusesIt) {
  EXPECT_THAT(say({"schema", "motion"}).out, HasSubstr("forming_time: 0.015"));
  const auto said = say({"schema", "motoin"});
  EXPECT_EQ(said.exit_code, kRefused);
  EXPECT_EQ(said.error, "motoin: unknown key; did you mean 'motion'?\n");
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
  for (const char* path : {"/bad.csv", "/good.csv"}) {
    const auto said = say({"point", law, "--path", folder + path, "-o", folder + "/out.csv"});
    EXPECT_EQ(said.exit_code, kRefused);
    EXPECT_EQ(said.error, "interply: " + folder +
                              "/out.csv is there already and stays as it is; give another -o, or say --overwrite\n");
    EXPECT_EQ(read(), result);
  }
  const std::vector<std::string> overwrite{"point", law, "-o", folder + "/out.csv", "--overwrite", "--path"};
  const auto with_path = [&](const char* name) {
    auto words = overwrite;
    words.push_back(folder + name);
    return words;
  };
  EXPECT_EQ(say(with_path("/bad.csv")).exit_code, kRefused);
  EXPECT_EQ(read(), result);
  std::ofstream(folder + "/good.csv") << "F11,F12,F21,F22\n1.02,0,0,1\n";
  EXPECT_EQ(say(with_path("/good.csv")).exit_code, kDone);
  EXPECT_THAT(read(), HasSubstr("\n1.02,0,0,1,1.0404,1,0,"));
  EXPECT_EQ(say({"point", law, "--path", folder + "/good.csv", "-o", "/dev/null"}).exit_code, kDone) << "no file";
  EXPECT_EQ(say({"point", law, "--path", folder + "/good.csv", "-o", folder + "/none/x.csv"}).exit_code, kFailed);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace interply::launch
