#include "process/nearest.hpp"

#include <gtest/gtest.h>

namespace interply::process {
namespace {

TEST(Nearest, IsTheNameWithTheFewestEdits) {
  EXPECT_EQ(find_nearest("rnu", {"check", "run", "point"}), "run");
  EXPECT_EQ(find_nearest("ply_4", {"sheet_lower", "ply_1", "ply_3"}), "ply_1") << "the first of equals";
  EXPECT_EQ(find_nearest("--otu", {"--set", "--out"}), "--out");
  EXPECT_EQ(find_nearest("-out", {"--set", "--out"}), "--out") << "hyphens in front do not count";
}

TEST(Nearest, IsNoneWhereMoreThanAThirdOfTheLettersIsWrong) {
  EXPECT_EQ(find_nearest("--json", {"--help", "--with", "--set"}), "");
  EXPECT_EQ(find_nearest("foo", {"exchange", "stack", "hub", "peer"}), "");
  EXPECT_EQ(find_nearest("cat", {"set"}), "");
  EXPECT_EQ(find_nearest("x", {"y"}), "") << "nothing of it is right";
  EXPECT_EQ(find_nearest("thikness", {"thickness"}), "thickness");
  EXPECT_EQ(find_nearest("tickens", {"thickness"}), "thickness") << "three of nine";
  EXPECT_EQ(find_nearest("tckens", {"thickness"}), "") << "four of nine";
}

TEST(Nearest, IsTheOnlyNameThatBeginsLikeIt) {
  EXPECT_EQ(find_nearest("over", {"--out", "--overwrite"}), "--overwrite");
  EXPECT_EQ(find_nearest("zero", {"zeromq-ipc", "zeromq-tcp"}), "");
  EXPECT_EQ(find_nearest("ov", {"--out-of-place", "--overwrite"}), "") << "too short";
}

TEST(Nearest, IsNoneForANameItselfOrWithoutNames) {
  EXPECT_EQ(find_nearest("run", {"run", "rum"}), "");
  EXPECT_EQ(find_nearest("x", {}), "");
  EXPECT_EQ(find_nearest(std::string(1000, 'x'), {std::string(1001, 'x')}), "");
}

}  // namespace
}  // namespace interply::process
