#include "solve/law_guard.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>

namespace interply::solve {

namespace {

thread_local const LawName* law_of_this_thread = nullptr;
std::atomic<const LawName*> law_called = nullptr;  // by any thread: a law may leave from a thread of its own
std::atomic<int> report_descriptor = STDERR_FILENO;

struct Signal {
  int number;
  const char* how;
  struct sigaction before {};
};
std::array<Signal, 5> signals{{{SIGSEGV, "it crashed with signal 11 (segmentation fault)"},
                               {SIGBUS, "it crashed with signal 7 (bus error)"},
                               {SIGFPE, "it crashed with signal 8 (floating-point exception)"},
                               {SIGILL, "it crashed with signal 4 (illegal instruction)"},
                               {SIGABRT, "it called abort or an error ended it (signal 6)"}}};

/// Only calls that are safe in a signal handler.
[[noreturn]] void leave(const LawName& law, const char* how) {
  const int to = report_descriptor;
  for (const char* part : {law.text.c_str(), " ended the process that called it: ", how, "\n"}) {
    [[maybe_unused]] const auto written = write(to, part, std::strlen(part));
  }
  _exit(kEndedByLaw);
}

void flush(const LawName& law) {
  if (law.flush) law.flush(nullptr);
  std::fflush(nullptr);
}

void handle_exit() {
  const LawName* law = law_called;
  if (!law) return;
  flush(*law);
  leave(*law, "STOP or exit");
}

void handle_signal(int number) {
  for (Signal& s : signals) {
    if (s.number != number) continue;
    if (law_of_this_thread) leave(*law_of_this_thread, s.how);
    sigaction(number, &s.before, nullptr);  // not the law's doing
  }
  raise(number);
}

/// A law that overflows the stack leaves its handler none.
void give_handlers_a_stack() {
  thread_local std::array<char, 16384> memory;
  stack_t present{};
  sigaltstack(nullptr, &present);
  if (!(present.ss_flags & SS_DISABLE)) return;
  const stack_t own{.ss_sp = memory.data(), .ss_flags = 0, .ss_size = memory.size()};
  sigaltstack(&own, nullptr);
}

}  // namespace

LawCall::LawCall(const LawName& law) {
  thread_local const bool ready = (give_handlers_a_stack(), true);
  static_cast<void>(ready);
  law_of_this_thread = &law;
  law_called = &law;
}

LawCall::~LawCall() {
  law_called = nullptr;
  law_of_this_thread = nullptr;
}

void install_law_guard() {
  static std::once_flag once;
  std::call_once(once, [] {
    setenv("GFORTRAN_UNBUFFERED_PRECONNECTED", "y", 0);
    setvbuf(stdout, nullptr, _IOLBF, 0);
    std::atexit(handle_exit);
    std::at_quick_exit(handle_exit);
    for (Signal& s : signals) {
      struct sigaction action {};
      action.sa_handler = handle_signal;
      action.sa_flags = SA_ONSTACK | SA_NODEFER;
      sigaction(s.number, &action, &s.before);
    }
  });
}

void report_law_to(int descriptor) { report_descriptor = descriptor; }

void end_by_law(const char* how) {
  const LawName* law = law_called;
  static const LawName unknown{"an own law", nullptr};
  flush(law ? *law : unknown);
  leave(law ? *law : unknown, how);
}

}  // namespace interply::solve
