#include "process/limits.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>

namespace interply::process {
namespace {

/// In a process of its own whose limit is soft and hard.
template <typename Action>
bool is_refused_within(int resource, rlim_t soft, rlim_t hard, const Action& action) {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit limit{soft, hard};
    setrlimit(static_cast<__rlimit_resource>(resource), &limit);
    try {
      action();
    } catch (const std::runtime_error&) {
      _exit(1);
    }
    rlimit after{};
    getrlimit(static_cast<__rlimit_resource>(resource), &after);
    _exit(after.rlim_cur >= soft ? 0 : 2);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WEXITSTATUS(status) == 1;
}

TEST(Limits, TooFewDescriptorsAreRefusedAndASoftLimitIsRaised) {
  EXPECT_TRUE(is_refused_within(RLIMIT_NOFILE, 24, 24, [] { require_descriptors(25); }));
  EXPECT_FALSE(is_refused_within(RLIMIT_NOFILE, 24, 24, [] { require_descriptors(24); }));
  EXPECT_FALSE(is_refused_within(RLIMIT_NOFILE, 24, 64, [] { require_descriptors(64); }));
}

TEST(Limits, TooLittleAddressSpaceIsRefused) {
  EXPECT_TRUE(is_refused_within(RLIMIT_AS, 1 << 28, 1 << 28, [] { require_address_space(1 << 29); }));
  EXPECT_FALSE(is_refused_within(RLIMIT_AS, 1 << 30, 1 << 30, [] { require_address_space(1 << 29); }));
}

}  // namespace
}  // namespace interply::process
