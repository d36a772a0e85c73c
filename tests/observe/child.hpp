/// Part of a test in a process of its own.
#pragma once

#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <utility>

namespace interply::test {

/// Runs a function in a forked process; start it before this process has threads. Killed at the end if it still runs.
class Child {
 public:
  /// Says `text`, a line of it, to the parent.
  class Voice {
   public:
    explicit Voice(int file) : file_(file) {}
    void say(const std::string& text) const {
      const std::string line = text + "\n";
      if (write(file_, line.data(), line.size()) < 0) _exit(99);
    }

   private:
    int file_;
  };

  template <typename Function>
  explicit Child(Function function) {
    int ends[2];
    if (pipe(ends) != 0) std::abort();
    pid_ = fork();
    if (pid_ == 0) {
      close(ends[0]);
      function(Voice(ends[1]));
      _exit(0);
    }
    close(ends[1]);
    voice_ = ends[0];
  }
  ~Child() {
    if (pid_ > 0) {
      send(SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    close(voice_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  pid_t pid() const { return pid_; }
  void send(int signal) const { kill(pid_, signal); }

  /// The next line that it says; empty if none comes within `seconds`.
  std::string hear(double seconds) {
    while (heard_.find('\n') == std::string::npos) {
      pollfd ready{.fd = voice_, .events = POLLIN, .revents = 0};
      char some[4096];
      if (poll(&ready, 1, static_cast<int>(seconds * 1000)) <= 0) return "";
      const ssize_t n = read(voice_, some, sizeof some);
      if (n <= 0) return "";
      heard_.append(some, static_cast<std::size_t>(n));
    }
    const std::size_t end = heard_.find('\n');
    std::string line = heard_.substr(0, end);
    heard_.erase(0, end + 1);
    return line;
  }

 private:
  pid_t pid_ = -1;
  int voice_ = -1;
  std::string heard_;
};

}  // namespace interply::test
