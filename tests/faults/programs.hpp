/// The real programs, started as a person would, and a look at what they started in turn.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "launch/process.hpp"
#include "paths.hpp"
#include "record/reader.hpp"

namespace interply::faults {

namespace fs = std::filesystem;

inline const fs::path kPrograms = INTERPLY_BIN_DIR;
inline const fs::path kScenes = fs::path(INTERPLY_SOURCE_DIR) / "tests/scenes";
/// Longest wait for anything in these tests, s; a test that reaches it has failed.
inline constexpr double kPatience = 120;

inline std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A folder that is removed at the end of a test.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string path = testing::TempDir() + "interply-test-XXXXXX";
    path_ = mkdtemp(path.data());
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// One program with everything it has said.
class Program {
 public:
  Program(const std::string& name, std::vector<std::string> arguments, const fs::path& folder)
      : child_(name, with_program(name, std::move(arguments)), folder / (name + "-said.log")) {}

  pid_t pid() const { return child_.pid(); }
  void send_signal(int signal) { child_.send_signal(signal); }
  const std::string& said() const { return said_; }
  std::string last_line() const {
    const auto text = said_.substr(0, said_.find_last_not_of('\n') + 1);
    return text.substr(text.find_last_of('\n') + 1);
  }

  /// Waits until `done`, the program's end or the end of patience. True if done.
  bool wait_until(const std::function<bool()>& done) {
    const auto start = std::chrono::steady_clock::now();
    while (true) {
      child_.read_output([&](const auto& line) { said_ += line + "\n"; });
      if (done()) return true;
      if (!running_ || std::chrono::steady_clock::now() - start > std::chrono::duration<double>(kPatience))
        return false;
      if (child_.reap()) {
        running_ = false;
        continue;  // once more for its last words
      }
      pollfd output{child_.output(), POLLIN, 0};
      poll(&output, 1, 20);
      if (child_.output() < 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  bool wait_for_words(const std::string& words) {
    return wait_until([&] { return said_.find(words) != std::string::npos; });
  }
  /// Exit code, 128 + signal if killed, -1 if it did not end in time (it is killed then).
  int wait() {
    wait_until([] { return false; });
    if (!running_) return child_.exit_code();
    child_.send_signal(SIGKILL);
    return -1;
  }

 private:
  static std::vector<std::string> with_program(const std::string& name, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), kPrograms / name);
    return arguments;
  }

  launch::Child child_;
  bool running_ = true;
  std::string said_;
};

/// Arguments of a process, separated by blanks; empty if it is gone or a zombie.
inline std::string read_command(pid_t pid) {
  std::string text = read_text(fs::path("/proc") / std::to_string(pid) / "cmdline");
  for (char& c : text)
    if (c == '\0') c = ' ';
  return text;
}

/// Calls f(pid, command) for every running process.
inline void for_each_process(const std::function<void(pid_t, const std::string&)>& f) {
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const pid_t pid = std::stoi(name);
    if (const auto command = read_command(pid); !command.empty()) f(pid, command);
  }
}

/// Processes of one run by role ("coordinator", "recorder" or the layer's name), found by their parent.
inline std::map<std::string, pid_t> find_participants(pid_t launcher) {
  std::map<std::string, pid_t> found;
  for_each_process([&](pid_t pid, const std::string& command) {
    const std::string stat = read_text(fs::path("/proc") / std::to_string(pid) / "stat");
    const auto after_name = stat.rfind(')');
    if (after_name == std::string::npos) return;
    std::istringstream rest(stat.substr(after_name + 2));
    char state = 0;
    pid_t parent = 0;
    rest >> state >> parent;
    if (parent != launcher) return;
    const auto layer = command.find("--layer ");
    if (layer != std::string::npos) {
      const auto begin = layer + 8;
      found[command.substr(begin, command.find(' ', begin) - begin)] = pid;
    } else {
      for (const auto* role : {"coordinator", "recorder"})
        if (command.find("interply-" + std::string(role)) != std::string::npos) found[role] = pid;
    }
  });
  return found;
}

/// True once a run has recorded its initial state and at least one more frame.
inline bool is_under_way(const fs::path& out) {
  return fs::exists(out / "record.h5") && record::RecordReader(out / "record.h5").frames_complete() >= 2;
}

/// What a process is doing: its command, then name, state and kernel function of each thread. For the log of a test that
/// waits for it in vain.
inline std::string describe_process(pid_t pid) {
  std::string text = read_command(pid);
  std::error_code gone;
  for (const auto& thread : fs::directory_iterator(fs::path("/proc") / std::to_string(pid) / "task", gone)) {
    const std::string stat = read_text(thread.path() / "stat");
    const auto name = stat.find('('), end = stat.rfind(')');
    if (end == std::string::npos || end + 2 >= stat.size()) continue;
    text += "\n    " + stat.substr(name + 1, end - name - 1) + " " + stat[end + 2] + " " + read_text(thread.path() / "wchan");
  }
  return text;
}

inline bool is_gone(pid_t pid) { return read_command(pid).empty(); }

}  // namespace interply::faults
