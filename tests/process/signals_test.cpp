#include "process/signals.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

namespace interply::process {
namespace {

/// Runs `body` in a process, sends it signals a tenth of a second apart once it is ready, and waits for its end.
struct Ended {
  int status = 0;
  double seconds = 0;  ///< from the first signal
};

template <typename Body>
Ended end_by(std::initializer_list<int> signals, const Body& body) {
  int ready[2];
  EXPECT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    body([&] { EXPECT_EQ(write(ready[1], "x", 1), 1); });
    _exit(0);
  }
  char byte;
  EXPECT_EQ(read(ready[0], &byte, 1), 1);
  const auto start = std::chrono::steady_clock::now();
  for (const int signal : signals) {
    kill(child, signal);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  Ended ended;
  waitpid(child, &ended.status, 0);
  ended.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  close(ready[0]);
  close(ready[1]);
  return ended;
}

void wait_for_ever() {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

TEST(EndRequests, AProcessThatDoesNotListenEndsAllTheSame) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const Ended ended = end_by({signal}, [](auto ready) {
      EndRequests requests(5);
      ready();
      wait_for_ever();
    });
    EXPECT_EQ(WEXITSTATUS(ended.status), 5);
    EXPECT_GE(ended.seconds, kGrace - 0.1) << "it has had its time";
    EXPECT_LT(ended.seconds, 5);
  }
}

TEST(EndRequests, WhoWantsToKnowIsToldWhyEvenAfterwards) {
  const Ended ended = end_by({SIGHUP}, [](auto ready) {
    EndRequests requests(5);
    ready();
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const auto listening = requests.tell([](const std::string& why) { _exit(why == "interrupted by SIGHUP" ? 7 : 8); });
  });
  EXPECT_EQ(WEXITSTATUS(ended.status), 7);
}

TEST(EndRequests, ASecondSignalEndsAtOnce) {
  const Ended ended = end_by({SIGINT, SIGINT}, [](auto ready) {
    EndRequests requests(5);
    ready();
    wait_for_ever();
  });
  EXPECT_EQ(WEXITSTATUS(ended.status), 5);
  EXPECT_LT(ended.seconds, kGrace);
}

TEST(EndRequests, AHangUpThatWasIgnoredStaysIgnored) {
  const Ended ended = end_by({SIGHUP}, [](auto ready) {
    std::signal(SIGHUP, SIG_IGN);
    EndRequests requests(5);
    const auto listening = requests.tell([](const std::string&) { _exit(9); });
    ready();
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
  });
  EXPECT_EQ(WEXITSTATUS(ended.status), 0) << "nohup";
}

TEST(EndBySignals, EndsAtOnceWhileTheParentLives) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const Ended ended = end_by({signal}, [](auto ready) {
      end_by_signals();
      ready();
      wait_for_ever();
    });
    EXPECT_TRUE(WIFSIGNALED(ended.status));
    EXPECT_EQ(WTERMSIG(ended.status), signal);
  }
}

TEST(EndWithin, EndsAProcessThatHangs) {
  const Ended ended = end_by({}, [](auto ready) {
    end_within(0.2, 3);
    ready();
    wait_for_ever();
  });
  EXPECT_EQ(WEXITSTATUS(ended.status), 3);
}

}  // namespace
}  // namespace interply::process
