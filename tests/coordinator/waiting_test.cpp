#include "coordinator/waiting.hpp"

#include <gtest/gtest.h>

namespace interply::coordinator {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(Waiting, CountsWhatThisProcessWaitedAndNotWhatItWasStopped) {
  Waiting::Clock::time_point now{};
  Waiting waiting(now);
  for (int i = 0; i < 8; ++i) EXPECT_NEAR(waiting.seconds(now += milliseconds(250)), 0.25 * (i + 1), 1e-9);
  EXPECT_LE(waiting.seconds(now += seconds(3600)), 3.0);
  EXPECT_NEAR(waiting.seconds(now += milliseconds(500)), 3.5, 1e-9);
  EXPECT_FALSE(waiting.is_due(now));
  EXPECT_FALSE(waiting.is_due(now += milliseconds(900)));
  EXPECT_TRUE(waiting.is_due(now += milliseconds(900)));
  EXPECT_FALSE(waiting.is_due(now));
  waiting.restart(now);
  EXPECT_EQ(waiting.seconds(now), 0);
}

}  // namespace
}  // namespace interply::coordinator
