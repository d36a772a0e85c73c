#include "process/signals.hpp"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace interply::process {

void end_within(double seconds, int exit_code) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);  // signals are for the other threads
  std::thread([=] {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    ::_exit(exit_code);
  }).detach();
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

sigset_t list_end_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    if (signal != SIGHUP || !is_ignored(SIGHUP)) sigaddset(&signals, signal);
  return signals;
}

bool is_ignored(int signal) {
  struct sigaction action {};
  ::sigaction(signal, nullptr, &action);
  return action.sa_handler == SIG_IGN;
}

void stop_this_process() {
  sigset_t only, before;
  sigemptyset(&only);
  sigaddset(&only, SIGTSTP);
  ::raise(SIGTSTP);  // waits until it is let through, for this thread
  pthread_sigmask(SIG_UNBLOCK, &only, &before);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

void end_at_once_by_signals(int exit_code) {
  static volatile int code = 0;
  code = exit_code;
  const sigset_t signals = list_end_signals();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    if (sigismember(&signals, signal) == 1) std::signal(signal, [](int) { ::_exit(code); });
}

std::string describe_request(int signal) { return std::string("interrupted by SIG") + sigabbrev_np(signal); }

struct EndRequests::Parts {
  const int exit_code;
  const pid_t launcher = ::getppid();
  sigset_t handled{};
  std::mutex mutex;
  std::optional<std::string> why;
  std::function<void(const std::string&)> told;

  [[noreturn]] void watch() {
    for (bool first = true;; first = false) {
      int signal = 0;
      if (sigwait(&handled, &signal) != 0) continue;
      if (!first) ::_exit(exit_code);
      end_within(kGrace, exit_code);
      const bool orphaned = signal == SIGTERM && ::getppid() != launcher;
      const std::lock_guard lock(mutex);
      why = orphaned ? "the launcher has died" : describe_request(signal);
      if (told) told(*why);
    }
  }
};

EndRequests::EndRequests(int exit_code) : parts_(new Parts{.exit_code = exit_code}) {
  parts_->handled = list_end_signals();
  pthread_sigmask(SIG_BLOCK, &parts_->handled, nullptr);
  std::thread([parts = parts_] { parts->watch(); }).detach();
}

EndRequests::Listener EndRequests::tell(std::function<void(const std::string&)> told) {
  const std::lock_guard lock(parts_->mutex);
  parts_->told = std::move(told);
  if (parts_->why) parts_->told(*parts_->why);
  return Listener(*this);
}

void EndRequests::forget() {
  const std::lock_guard lock(parts_->mutex);
  parts_->told = nullptr;
}

namespace {

volatile pid_t launcher = 0;

void end(int signal) {
  if (signal == SIGTERM && ::getppid() != launcher) {
    ::alarm(1);
    return;
  }
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

}  // namespace

void end_by_signals() {
  launcher = ::getppid();
  std::signal(SIGALRM, SIG_DFL);
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, end);
}

}  // namespace interply::process
