#include "exchange/deadline.hpp"

#include <gtest/gtest.h>

namespace interply::exchange {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(Deadline, PassesForWhoeverLooks) {
  Deadline::Clock::time_point now{};
  Deadline until(3, now);
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(until.passed(now += seconds(1)));
  EXPECT_FALSE(until.passed(now += milliseconds(999)));
  EXPECT_TRUE(until.passed(now += milliseconds(1)));
  EXPECT_TRUE(Deadline(0, now).passed(now));
}

TEST(Deadline, WhoeverWasStoppedMeanwhileHasAllButASecondOfItLeft) {
  Deadline::Clock::time_point now{};
  Deadline until(3, now);
  EXPECT_FALSE(until.passed(now += seconds(1)));
  EXPECT_FALSE(until.passed(now += seconds(3600)));
  EXPECT_FALSE(until.passed(now += milliseconds(900)));
  EXPECT_TRUE(until.passed(now += milliseconds(200)));
}

TEST(Deadline, IsLookedAtOnceASecond) { EXPECT_LE(Deadline(3600).left(), seconds(1)); }

}  // namespace
}  // namespace interply::exchange
