#include "solve/vumat_probe.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <sstream>
#include <system_error>

#include "scene/read_scene.hpp"
#include "solve/law_guard.hpp"
#include "solve/vumat.hpp"

namespace interply::solve {

namespace {

constexpr int kElements = kVumatBlock + 5;  // a full call and a short one
constexpr std::size_t kLastLines = 5;
// First words of the lines that the child reports.
constexpr const char* kWarning = "warning ";
constexpr const char* kRefusal = "refused ";
constexpr const char* kEnd = "end";

void write_line(int to, const std::string& line) {
  const std::string text = line + '\n';
  for (std::size_t done = 0; done < text.size();) {
    const auto n = write(to, text.data() + done, text.size() - done);
    if (n <= 0) return;
    done += static_cast<std::size_t>(n);
  }
}

/// The child's whole life.
[[noreturn]] void examine_law(const scene::VumatLaw& law, const std::string& layer, double density, int said,
                              int report, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  const rlimit no_core{};
  setrlimit(RLIMIT_CORE, &no_core);
  dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
  dup2(said, STDOUT_FILENO);
  dup2(said, STDERR_FILENO);
  report_law_to(report);
  try {
    VumatPoints points(law, layer, density, kElements, law.integration == scene::Integration::Shell ? 3 : 1);
    for (const auto& warning : points.examine()) write_line(report, kWarning + warning);
  } catch (const std::exception& e) {
    write_line(report, kRefusal + std::string(e.what()));
  }
  write_line(report, kEnd);
  _exit(0);
}

class Pipe {
 public:
  Pipe() {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
    fcntl(ends_[0], F_SETFL, O_NONBLOCK);
  }
  ~Pipe() {
    close(ends_[0]);
    close_input();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int output() const { return ends_[0]; }
  int input() const { return ends_[1]; }
  void close_input() {
    if (ends_[1] >= 0) close(ends_[1]);
    ends_[1] = -1;
  }
  void read_into(std::string& text) const {
    std::array<char, 4096> buffer;
    for (ssize_t n; (n = read(ends_[0], buffer.data(), buffer.size())) > 0;)
      text.append(buffer.data(), static_cast<std::size_t>(n));
    constexpr std::size_t kMost = 1 << 20;  // of a law that never stops talking
    if (text.size() > 2 * kMost) text.erase(0, text.size() - kMost);
  }

 private:
  std::array<int, 2> ends_{};
};

std::vector<std::string> split_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string quote_last_lines(const std::string& said) {
  const auto lines = split_lines(said);
  if (lines.empty()) return "; it has written nothing";
  std::string text = "; its last lines:";
  for (std::size_t i = lines.size() - std::min(lines.size(), kLastLines); i < lines.size(); ++i)
    text += "\n    " + lines[i];
  return text;
}

}  // namespace

std::vector<std::string> probe_vumat(const scene::VumatLaw& law, const std::string& layer, double density,
                                     double limit) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  Pipe output, report;
  std::fflush(nullptr);  // what is still unwritten is the parent's
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "cannot start a process to try the law in");
  if (child == 0) examine_law(law, layer, density, output.input(), report.input(), parent);
  output.close_input();
  report.close_input();

  std::string said, reported;
  int status = 0;
  bool late = false;
  for (bool running = true; running;) {
    running = waitpid(child, &status, WNOHANG) != child;
    std::array<pollfd, 2> watched{{{output.output(), POLLIN, 0}, {report.output(), POLLIN, 0}}};
    if (running) poll(watched.data(), watched.size(), 10);
    output.read_into(said);
    report.read_into(reported);
    if (running && !late && Clock::now() - start > std::chrono::duration<double>(limit)) {
      late = true;
      kill(child, SIGKILL);
    }
  }

  std::vector<std::string> lines = split_lines(reported), warnings;
  if (!lines.empty() && lines.back() == kEnd) {
    std::string refusal;
    for (const std::string& line : lines) {
      if (line.starts_with(kWarning)) warnings.push_back(line.substr(std::strlen(kWarning)));
      if (line.starts_with(kRefusal)) refusal = line.substr(std::strlen(kRefusal));
    }
    if (refusal.empty()) return warnings;
    throw scene::SceneError(refusal + (said.empty() ? "" : quote_last_lines(said)));
  }
  std::string why = lines.empty() ? "" : lines.back();
  if (why.empty()) {
    why = fmt::format("layer {}: law.vumat.library: {} ", layer, law.library.path);
    if (late)
      why += fmt::format("does not return within {:g} s from calls with small strains", limit);
    else if (WIFSIGNALED(status))
      why += fmt::format("ended the process that called it: signal {} ({})", WTERMSIG(status),
                         strsignal(WTERMSIG(status)));
    else
      why += fmt::format("ended the process that called it: exit code {}", WEXITSTATUS(status));
  }
  throw scene::SceneError(why + quote_last_lines(said));
}

}  // namespace interply::solve
