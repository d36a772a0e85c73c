/// What a terminal of some width is told, over a pseudo-terminal.
#include "launch/terminal.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <thread>

namespace interply::launch {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kLine =
    "left    42 s  waiting for ply_2  stroke  12.3 mm  punch 1.50 kN  energy residual -0.040 %  step    1234  "
    "dt 4.04e-07 s  t 2.500/16.000 ms";

TEST(FitItems, ShowsTheFirstItemsThatFitAsAWhole) {
  EXPECT_EQ(fit_items(kLine, 200), kLine);
  EXPECT_EQ(fit_items(kLine, 79), "left    42 s  waiting for ply_2  stroke  12.3 mm  punch 1.50 kN");
  EXPECT_EQ(fit_items(kLine, 39), "left    42 s  waiting for ply_2");
  EXPECT_EQ(fit_items(kLine, 12), "left    42 s");
  EXPECT_EQ(fit_items(kLine, 5), "left ") << "nothing else to show";
  for (std::size_t columns = 12; columns < 150; ++columns) {
    const std::string shown = fit_items(kLine, columns);
    EXPECT_LE(shown.size(), columns);
    EXPECT_TRUE(kLine.starts_with(shown));
    EXPECT_TRUE(shown == kLine || kLine.substr(shown.size(), 2) == "  ") << shown;
  }
}

class PseudoTerminal : public testing::Test {
 protected:
  void SetUp() override {
    master_ = posix_openpt(O_RDWR | O_NOCTTY);
    ASSERT_GE(master_, 0);
    ASSERT_TRUE(grantpt(master_) == 0 && unlockpt(master_) == 0);
    out_ = std::fopen(ptsname(master_), "w");
    ASSERT_NE(out_, nullptr);
    fcntl(master_, F_SETFL, O_NONBLOCK);
  }
  void TearDown() override {
    std::fclose(out_);
    close(master_);
  }
  void set_width(unsigned short columns) {
    const winsize size{24, columns, 0, 0};
    ASSERT_EQ(ioctl(master_, TIOCSWINSZ, &size), 0);
  }
  std::string read_all() {
    std::string text(4096, '\0');
    const auto n = read(master_, text.data(), text.size());
    text.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    return text;
  }
  /// As a run does, at its rate.
  std::string show(Terminal& terminal, const std::string& text) {
    std::this_thread::sleep_for(std::chrono::milliseconds(410));
    terminal.show_progress(text);
    return read_all();
  }
  int master_ = -1;
  std::FILE* out_ = nullptr;
};

/// Progress is written from the first column, the cursor goes back there, and each one erases all below: after a
/// terminal has become narrower and has broken the old line into rows, none of them stays.
TEST_F(PseudoTerminal, ProgressIsOneRowOfWholeItemsWhateverTheWidthBecomes) {
  Terminal terminal(out_, false);
  for (const unsigned short columns : {80, 40, 120}) {
    set_width(columns);
    EXPECT_EQ(show(terminal, kLine), "\r\x1b[J" + fit_items(kLine, columns - 1u) + "\r") << columns;
  }
  set_width(80);
  terminal.note("7 processes");
  EXPECT_EQ(read_all(), "\r\x1b[J7 processes\r\n");
}

TEST_F(PseudoTerminal, WhoeverTakesTheTerminalInAPauseFindsAnEmptyRow) {
  Terminal terminal(out_, false);
  set_width(80);
  show(terminal, kLine);
  terminal.pause();
  EXPECT_EQ(read_all(), "\r\x1b[J");
  terminal.show_progress(kLine);
  EXPECT_THAT(read_all(), HasSubstr("left    42 s")) << "at once";
}

}  // namespace
}  // namespace interply::launch
