#include "launch/process.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>

#include "process/words.hpp"
#include "record/run_folder.hpp"

namespace interply::launch {
namespace {

constexpr std::size_t kLastLines = 5;

[[noreturn]] void throw_errno(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// The child's side of the fork: only calls that are safe there. Reports a failed exec through `error_pipe`.
[[noreturn]] void become_program(const std::vector<char*>& arguments, int output, int error_pipe, int inherited,
                                 pid_t launcher) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != launcher) _exit(1);  // the launcher died before the line above
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  const int null = open("/dev/null", O_RDONLY);
  dup2(null, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
  if (inherited >= 0) fcntl(inherited, F_SETFD, 0);
  execv(arguments[0], arguments.data());
  const int error = errno;
  [[maybe_unused]] const auto written = write(error_pipe, &error, sizeof error);
  _exit(127);
}

}  // namespace

Child::Child(std::string name, const std::vector<std::string>& command, const std::filesystem::path& log, int inherited)
    : name_(std::move(name)) {
  record::begin_log(log, name_);
  log_.open(log, std::ios::app);
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (const auto& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);

  std::array<int, 2> output{}, failure{};
  if (pipe2(output.data(), O_CLOEXEC) != 0 || pipe2(failure.data(), O_CLOEXEC) != 0) throw_errno("pipe");
  const pid_t launcher = getpid();
  pid_ = fork();
  if (pid_ < 0) throw_errno("cannot start " + command[0]);
  if (pid_ == 0) become_program(arguments, output[1], failure[1], inherited, launcher);

  close(output[1]);
  close(failure[1]);
  int error = 0;
  const auto got = read(failure[0], &error, sizeof error);  // ends at once: exec closes the other side
  close(failure[0]);
  if (got == static_cast<ssize_t>(sizeof error)) {
    close(output[0]);
    waitpid(pid_, nullptr, 0);
    throw std::system_error(error, std::generic_category(), "cannot start " + command[0]);
  }
  output_ = output[0];
  fcntl(output_, F_SETFL, O_NONBLOCK);
  running_ = true;
}

Child::~Child() {
  if (running_) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  if (output_ >= 0) close(output_);
}

void Child::read_output(const std::function<void(const std::string&)>& on_line) {
  std::array<char, 4096> buffer;
  while (output_ >= 0) {
    const auto n = read(output_, buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) return;
    if (n <= 0) {
      close(output_);
      output_ = -1;
      if (!partial_.empty()) partial_ += '\n';
    } else {
      partial_.append(buffer.data(), static_cast<std::size_t>(n));
    }
    for (std::size_t end; (end = partial_.find('\n')) != std::string::npos;) {
      const std::string line = process::to_line(std::string_view(partial_).substr(0, end));
      partial_.erase(0, end + 1);
      keep_line(line);
      on_line(line);
    }
  }
}

namespace {

/// Of a coordinator's line for its launcher (coordinator/voice.hpp), what a person may want to read.
std::string to_log(const std::string& line) {
  const std::string summary = "@summary ";
  if (line.starts_with(summary)) return line.substr(summary.size());
  for (const char* word : {"@bound ", "@digest ", "@reason "})
    if (line.starts_with(word)) return line.substr(1);
  return line;
}

}  // namespace

void Child::keep_line(const std::string& line) {
  if (line.starts_with("@progress ") || line.starts_with("@json ")) return;
  last_lines_.push_back(to_log(line));
  log_ << last_lines_.back() << std::endl;
  if (last_lines_.size() > kLastLines) last_lines_.pop_front();
}

bool Child::reap() {
  rusage used{};
  if (!running_ || wait4(pid_, &status_, WNOHANG, &used) != pid_) return false;
  for (const timeval& t : {used.ru_utime, used.ru_stime})
    cpu_seconds_ += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  running_ = false;
  return true;
}

void Child::send_signal(int signal) {
  if (running_) kill(pid_, signal);
}

bool Child::was_killed() const { return WIFSIGNALED(status_); }

int Child::exit_code() const { return was_killed() ? 128 + WTERMSIG(status_) : WEXITSTATUS(status_); }

std::string Child::describe_end() const {
  if (!was_killed()) return "left with exit code " + std::to_string(exit_code());
  const int signal = WTERMSIG(status_);
  return "was killed by signal " + std::to_string(signal) + " (" + strsignal(signal) + ")";
}

std::filesystem::path find_program_folder() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

}  // namespace interply::launch
