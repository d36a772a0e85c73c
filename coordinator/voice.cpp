#include "coordinator/voice.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <iostream>
#include <sstream>

#include "process/words.hpp"
#include "solve/session.hpp"

namespace interply::coordinator {
namespace {

constexpr int kUnread = 16 << 10;  ///< bytes in a pipe, a quarter of what it holds: the rest is for notes

bool is_anybody_reading() {
  pollfd out{STDOUT_FILENO, POLLOUT, 0};
  if (::poll(&out, 1, 0) != 1) return false;
  int unread = 0;
  return ::isatty(STDOUT_FILENO) != 0 || ::ioctl(STDOUT_FILENO, FIONREAD, &unread) != 0 || unread < kUnread;
}

class ForPerson final : public Voice {
 public:
  void say_address(const std::string& address, const scene::Scene& scene, bool recorder) override {
    std::cout << "listening at " << address << '\n';
    for (const scene::Layer& layer : scene.layers)
      std::cout << fmt::format("start interply-solver-{} --connect {} --layer {}\n", solve::to_word(layer.kind()),
                               address, layer.name);
    if (recorder) std::cout << fmt::format("start interply-recorder --connect {} --out DIR\n", address);
    std::cout.flush();
  }
  void show_progress(const Progress& progress) override {
    const auto now = Clock::now();
    if (now < next_ || !is_anybody_reading()) return;
    next_ = now + std::chrono::seconds(5);
    std::cout << process::to_line(format_progress(progress)) << std::endl;
  }
  void note(const std::string& line) override { std::cout << process::to_line(line) << std::endl; }
  void say_end(const Outcome& outcome, int frames) override {
    std::istringstream summary(outcome.summary);
    for (std::string line; std::getline(summary, line);) std::cout << process::to_line(line) << '\n';
    if (!outcome.digest.empty()) std::cout << "digest " << outcome.digest << '\n';
    std::cout.flush();
    if (outcome.exit_code == 0) return;
    say_reason(outcome.message + (outcome.frames_recorded < 0 ? ""
                                                              : fmt::format("; the record holds {} of {} frames",
                                                                            outcome.frames_recorded, frames)));
  }
  void say_reason(const std::string& sentence) override { std::cerr << process::to_line(sentence) << std::endl; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point next_{};
};

class ForLauncher final : public Voice {
 public:
  void say_address(const std::string& address, const scene::Scene&, bool) override {
    std::cout << "@bound " << address << std::endl;
  }
  void show_progress(const Progress& progress) override {
    if (is_anybody_reading()) std::cout << "@progress " << process::to_line(format_progress(progress)) << std::endl;
  }
  void note(const std::string& text) override {
    const std::string line = process::to_line(text);
    std::cout << (line.starts_with('@') ? "\\x40" + line.substr(1) : line) << std::endl;
  }
  void say_end(const Outcome& outcome, int /*frames*/) override {
    std::istringstream summary(outcome.summary), json(outcome.summary_json);  // the second has its own escapes
    for (std::string line; std::getline(summary, line);) std::cout << "@summary " << process::to_line(line) << '\n';
    for (std::string line; std::getline(json, line);) std::cout << "@json " << line << '\n';
    if (!outcome.digest.empty()) std::cout << "@digest " << outcome.digest << '\n';
    std::cout.flush();
    if (outcome.exit_code != 0) say_reason(outcome.message);
  }
  void say_reason(const std::string& sentence) override {
    std::cout << "@reason " << process::to_line(sentence) << std::endl;
  }
};

}  // namespace

std::unique_ptr<Voice> make_voice(bool for_launcher) {
  if (for_launcher) return std::make_unique<ForLauncher>();
  return std::make_unique<ForPerson>();
}

}  // namespace interply::coordinator
