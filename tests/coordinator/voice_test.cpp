/// What the coordinator's process says to whoever started it.
#include "coordinator/voice.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace interply::coordinator {
namespace {

using testing::HasSubstr;
using testing::Not;

/// The standard output of this process for as long as it lives, which nobody reads before the end.
class UnreadOutput {
 public:
  UnreadOutput() : before_(dup(STDOUT_FILENO)) {
    if (pipe(pipe_) != 0) throw std::runtime_error("pipe");
    dup2(pipe_[1], STDOUT_FILENO);
    close(pipe_[1]);
  }
  ~UnreadOutput() {
    dup2(before_, STDOUT_FILENO);
    close(before_);
    close(pipe_[0]);
  }
  std::string read_all() {
    fcntl(pipe_[0], F_SETFL, O_NONBLOCK);
    std::string text(1 << 17, '\0');
    const auto n = read(pipe_[0], text.data(), text.size());
    text.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    return text;
  }

 private:
  int before_, pipe_[2] = {};
};

TEST(Voice, ProgressIsLeftOutWhereNobodyReadsAndNotesAreNot) {
  for (const bool for_launcher : {true, false}) {
    UnreadOutput out;
    const auto voice = make_voice(for_launcher);
    for (int i = 0; i < 5000; ++i) voice->show_progress({.step = i});
    voice->note("waiting for ply_1");
    const std::string said = out.read_all();
    EXPECT_THAT(said, HasSubstr("step       0"));
    EXPECT_TRUE(said.ends_with("\nwaiting for ply_1\n"));
    EXPECT_LT(said.size(), 1u << 15);
  }
}

TEST(Voice, OnlyALauncherIsToldWordsThatItReads) {
  const Outcome outcome{
      .exit_code = 5, .message = "cancelled", .summary = "a\nb", .summary_json = "{}", .frames_recorded = 3};
  UnreadOutput out;
  make_voice(true)->note("@digest 0");
  make_voice(true)->say_end(outcome, 5);
  EXPECT_EQ(out.read_all(), "\\x40digest 0\n@summary a\n@summary b\n@json {}\n@reason cancelled\n");
  testing::internal::CaptureStderr();
  make_voice(false)->say_end(outcome, 5);
  EXPECT_EQ(out.read_all(), "a\nb\n");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "cancelled; the record holds 3 of 5 frames\n");
}

}  // namespace
}  // namespace interply::coordinator
