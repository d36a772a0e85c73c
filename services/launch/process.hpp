/// A child process whose output the launcher reads line by line and keeps in a log file.
#pragma once

#include <sys/types.h>

#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace interply::launch {

/// Started on construction, in its own process group (a terminal's Ctrl-C reaches only the launcher), without any
/// descriptor of ours but `inherited`, and sent SIGTERM by the kernel if the launcher dies. Never waits: the owner
/// polls `output()` and calls reap() on SIGCHLD.
class Child {
 public:
  /// @param name     for messages
  /// @param command  absolute path of the program, then its arguments
  /// @param log      file that receives stdout and stderr, except lines beginning with "@progress " or "@json "
  /// @param inherited  descriptor that the program keeps open under the same number; -1: none
  /// @throws std::system_error if the program cannot be started
  Child(std::string name, const std::vector<std::string>& command, const std::filesystem::path& log,
        int inherited = -1);
  /// Kills and reaps the process if it still runs.
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  const std::string& name() const { return name_; }
  pid_t pid() const { return pid_; }
  bool running() const { return running_; }
  /// File descriptor to poll for output, -1 after its end.
  int output() const { return output_; }

  /// Reads what has arrived and passes every complete line on, fit for a terminal.
  void read_output(const std::function<void(const std::string&)>& on_line);
  /// True if the process has just ended; its output may still hold lines.
  bool reap();
  void send_signal(int signal);

  bool was_killed() const;                             ///< @pre not running: ended by a signal
  int exit_code() const;                               ///< @pre not running: 128 + signal if killed
  double cpu_seconds() const { return cpu_seconds_; }  ///< @pre not running: that it has used
  std::string describe_end() const;  ///< @pre not running: "was killed by signal 9 (Killed)", "left with exit code 1"
  const std::deque<std::string>& last_lines() const { return last_lines_; }  ///< of its log, at most five

 private:
  void keep_line(const std::string& line);

  std::string name_;
  pid_t pid_ = -1;
  int output_ = -1;
  int status_ = 0;
  double cpu_seconds_ = 0;
  bool running_ = false;
  std::string partial_;
  std::ofstream log_;
  std::deque<std::string> last_lines_;
};

/// Folder of the running program, where its sibling programs are.
std::filesystem::path find_program_folder();

}  // namespace interply::launch
