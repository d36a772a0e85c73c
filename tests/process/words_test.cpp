#include "process/words.hpp"

#include <gtest/gtest.h>

namespace interply::process {
namespace {

TEST(ToLine, LeavesPrintableTextAlone) {
  for (const char* text : {"", "ply_2 at step 7", "Lagenkürzel ß, 層, 𝛾 = 12°", "a\\b \"c\""}) EXPECT_EQ(to_line(text), text);
}

TEST(ToLine, WritesControlCharactersOut) {
  EXPECT_EQ(to_line("a\n@digest 0\r\t\x1b[2J\x7f"), "a\\x0a@digest 0\\x0d\\x09\\x1b[2J\\x7f");
  EXPECT_EQ(to_line(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(to_line("\xc2\x9b" "2J"), "\\xc2\\x9b2J") << "the escape sequence of Latin-1";
}

TEST(ToLine, WritesBytesOutThatAreNoText) {
  EXPECT_EQ(to_line("\xff"), "\\xff");
  EXPECT_EQ(to_line("\xc3"), "\\xc3") << "half a character";
  EXPECT_EQ(to_line("\x9b" "2J"), "\\x9b2J");
  EXPECT_EQ(to_line("\xc0\x8a"), "\\xc0\\x8a") << "a newline in disguise";
}

TEST(ToLine, IsCutToALength) {
  EXPECT_EQ(to_line("abcdef", 3), "abc...");
  EXPECT_EQ(to_line("abc", 3), "abc");
}

TEST(CountEdits, IsTheFewestInsertionsDeletionsSubstitutionsAndExchanges) {
  EXPECT_EQ(count_edits("", "ply"), 3u);
  EXPECT_EQ(count_edits("ply_1", "ply_1"), 0u);
  EXPECT_EQ(count_edits("ply1", "ply_1"), 1u);
  EXPECT_EQ(count_edits("kitten", "sitting"), 3u);
  EXPECT_EQ(count_edits("sitting", "kitten"), 3u);
  EXPECT_EQ(count_edits("rnu", "run"), 1u);
  EXPECT_EQ(count_edits("hcekc", "check"), 2u);
}

}  // namespace
}  // namespace interply::process
