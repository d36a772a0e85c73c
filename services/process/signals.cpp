#include "process/signals.hpp"

#include <unistd.h>

#include <chrono>
#include <cstring>
#include <thread>

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

EndRequests::EndRequests(int exit_code) : exit_code_(exit_code), launcher_(::getppid()) {
  sigemptyset(&handled_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    ::sigaction(signal, nullptr, &before);
    if (signal != SIGHUP || before.sa_handler != SIG_IGN) sigaddset(&handled_, signal);
  }
  pthread_sigmask(SIG_BLOCK, &handled_, nullptr);
  std::thread([this] { watch(); }).detach();
}

void EndRequests::watch() {
  for (bool first = true;; first = false) {
    int signal = 0;
    if (sigwait(&handled_, &signal) != 0) continue;
    if (!first) ::_exit(exit_code_);
    end_within(kGrace, exit_code_);
    const bool orphaned = signal == SIGTERM && ::getppid() != launcher_;
    request(orphaned ? "the launcher has died" : std::string("interrupted by SIG") + sigabbrev_np(signal));
  }
}

void EndRequests::request(const std::string& why) {
  const std::lock_guard lock(mutex_);
  why_ = why;
  if (told_) told_(why);
}

void EndRequests::tell(std::function<void(const std::string&)> told) {
  const std::lock_guard lock(mutex_);
  told_ = std::move(told);
  if (why_) told_(*why_);
}

void EndRequests::forget() {
  const std::lock_guard lock(mutex_);
  told_ = nullptr;
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
