#include "launch/bench_exchange.hpp"

#include <fmt/format.h>
#include <grp.h>
#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "bench/carriers.hpp"
#include "launch/bench_tools.hpp"
#include "launch/command_line.hpp"
#include "launch/process.hpp"
#include "launch/run.hpp"

namespace interply::launch {
namespace fs = std::filesystem;
namespace {

volatile std::sig_atomic_t interrupted = 0;

/// Ctrl-C as a flag, as long as this lives.
class Interrupts {
 public:
  Interrupts() {
    struct sigaction action {};
    action.sa_handler = [](int) { interrupted = 1; };
    for (std::size_t i = 0; i < kSignals.size(); ++i) ::sigaction(kSignals[i], &action, &old_[i]);
  }
  ~Interrupts() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) ::sigaction(kSignals[i], &old_[i], nullptr);
  }
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

 private:
  static constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, kSignals.size()> old_{};
};

struct Cancelled {};

/// Reads a child's lines until `done(line)`, its end, or the deadline. True if done.
template <typename Done>
bool read_until(Child& child, double seconds, const Done& done) {
  using Clock = std::chrono::steady_clock;
  const auto until = Clock::now() + std::chrono::duration<double>(seconds);
  bool found = false;
  while (!found && child.output() >= 0 && Clock::now() < until) {
    pollfd wanted{child.output(), POLLIN, 0};
    ::poll(&wanted, 1, 100);
    if (interrupted) throw Cancelled();
    child.read_output([&](const std::string& line) { found = found || done(line); });
  }
  return found;
}

/// The daemon that shared memory of iceoryx needs. Ends in order: it has memory of its own to remove.
class Roudi {
 public:
  explicit Roudi(const std::string& folder) {
    const std::string program = find();
    if (program.empty()) {
      why_not_ = "iox-roudi (Debian package iceoryx) is not installed";
      return;
    }
    daemon_ = std::make_unique<Child>("iox-roudi", std::vector<std::string>{program, "-m", "off", "-k", "1"},
                                      folder + "/roudi.log");
    const bool ready =
        read_until(*daemon_, 10, [](const auto& line) { return line.find("RouDi is ready") != std::string::npos; });
    if (!ready) why_not_ = "iox-roudi cannot start here (does another one run?)";
  }
  ~Roudi() {
    if (!daemon_) return;
    daemon_->send_signal(SIGTERM);
    for (int i = 0; i < 1000 && !daemon_->reap() && daemon_->running(); ++i) ::poll(nullptr, 0, 10);
    if (why_not_.empty()) remove_leftovers();
  }
  Roudi(const Roudi&) = delete;
  Roudi& operator=(const Roudi&) = delete;
  const std::string& why_not() const { return why_not_; }

 private:
  static std::string find() {
    for (const fs::path folder : {"/usr/bin", "/usr/local/bin"})
      if (fs::exists(folder / "iox-roudi")) return folder / "iox-roudi";
    return "";
  }
  /// A killed process leaves /tmp/iceoryx_rt_PID_TIME.lock; and a daemon that had one among its processes aborts at its
  /// own end (iceoryx 2.0.3) before it has removed its memory, which has the name of our group.
  static void remove_leftovers() {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator("/tmp", ignored)) {
      int pid = 0;
      if (std::sscanf(entry.path().filename().c_str(), "iceoryx_rt_%d_", &pid) == 1 && ::kill(pid, 0) != 0)
        fs::remove(entry.path(), ignored);
    }
    ::shm_unlink("/iceoryx_mgmt");
    if (const group* own = ::getgrgid(::getegid())) ::shm_unlink(fmt::format("/{}", own->gr_name).c_str());
  }
  std::unique_ptr<Child> daemon_;
  std::string why_not_;
};

/// One measurement of one carrier.
struct Star {
  long steps = 0;
  double wall = 0, cpu = 0;  ///< s
  std::string digest;
};

constexpr std::string_view kName = "interply: ";  ///< before what a program of ours says

Star run_star(const bench::Carrier& carrier, const bench::StarSize& size, double seconds, const std::string& folder) {
  Child hub(
      "hub",
      {find_program_folder() / "interply", "bench", "hub", "--carrier", carrier.name, "--folder", folder, "--peers",
       std::to_string(size.peers), "--nodes", std::to_string(size.nodes), "--seconds", fmt::format("{}", seconds)},
      folder + "/hub.log");
  Star star;
  const bool done = read_until(hub, seconds + 60, [&](const std::string& line) {
    char digest[17] = {};
    if (std::sscanf(line.c_str(), "@star %ld %lf %lf %16s", &star.steps, &star.wall, &star.cpu, digest) != 4)
      return false;
    star.digest = digest;
    return true;
  });
  if (!done) {
    const std::string last = hub.last_lines().empty() ? "the hub's process said nothing" : hub.last_lines().back();
    throw std::runtime_error(last.starts_with(kName) ? last.substr(kName.size()) : last);
  }
  read_until(hub, 10, [](const std::string&) { return false; });  // it ends in order
  return star;
}

/// All rounds of one carrier for one size.
struct Series {
  std::vector<double> wall, cpu;  ///< us per step
  long steps = 0;
  std::string digest, problem;
};

std::vector<const bench::Carrier*> select_carriers(const std::vector<std::string>& names) {
  std::vector<const bench::Carrier*> selected;
  std::vector<std::string> known;
  for (const auto& carrier : bench::list_carriers()) known.push_back(carrier.name);
  for (const auto& name : names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw BadArgument(fmt::format("--carriers: there is no carrier \"{}\"{}", name, propose(name, known, "\"")));
  for (const auto& carrier : bench::list_carriers())
    if (names.empty() || std::find(names.begin(), names.end(), carrier.name) != names.end())
      selected.push_back(&carrier);
  return selected;
}

void print_row(std::ostream& out, const bench::StarSize& size, const bench::Carrier& carrier, const Series& series,
               const std::map<std::string, Series>& all) {
  out << fmt::format("{:>6} {:>6}  {:<13}", size.peers, size.nodes, carrier.name);
  if (!series.problem.empty()) {
    out << " not measured: " << series.problem << std::endl;
    return;
  }
  out << fmt::format(" {:>8} {:>10.1f} {:>10.1f}", series.steps, find_median(series.wall), find_median(series.cpu));
  const auto raw = all.find(carrier.reference);
  if (raw == all.end() || raw->second.wall.empty() || &raw->second == &series)
    out << fmt::format(" {:>7} {:>7}  {:<11}", "", "", "");
  else
    out << fmt::format(" {:>7.2f} {:>7.2f}  {:<11}", find_ratio(series.wall, raw->second.wall),
                       find_ratio(series.cpu, raw->second.cpu), carrier.reference);
  out << ' ' << series.digest << std::endl;
}

}  // namespace

int bench_exchange_command(const BenchExchangeOptions& options, std::ostream& out) {
  const auto carriers = select_carriers(options.carriers);
  interrupted = 0;
  const Interrupts interrupts;
  const TemporaryFolder folder;
  std::optional<Roudi> roudi;
  int exit_code = kDone;
  out << fmt::format(
             "exchange: one step of a hub with peers, [3 x nodes] doubles each way; medians of {} rounds, {:g} s "
             "per row\n",
             options.rounds, options.seconds)
      << fmt::format("{:>6} {:>6}  {:<13} {:>8} {:>10} {:>10} {:>7} {:>7}  {:<11} {}\n", "peers", "nodes", "carrier",
                     "steps", "us wall", "us CPU", "x wall", "x CPU", "of", "digest")
      << std::flush;
  try {
    for (const int peers : options.peers)
      for (const int nodes : options.nodes) {
        const bench::StarSize size{peers, nodes};
        std::map<std::string, Series> all;
        for (int round = 0; round < options.rounds; ++round)
          for (const auto* carrier : carriers) {
            Series& series = all[carrier->name];
            if (!series.problem.empty()) continue;
            if (carrier->wants_roudi && !roudi) roudi.emplace(folder.make_empty("roudi"));
            if (carrier->wants_roudi) series.problem = roudi->why_not();
            if (!series.problem.empty()) continue;
            try {
              const Star star = run_star(*carrier, size, options.seconds / options.rounds, folder.make_empty("star"));
              series.wall.push_back(1e6 * star.wall / static_cast<double>(star.steps));
              series.cpu.push_back(1e6 * star.cpu / static_cast<double>(star.steps));
              series.steps += star.steps;
              series.digest = star.digest;
            } catch (const std::runtime_error& e) {
              series.problem = e.what();
              exit_code = kFailed;
            }
          }
        for (const auto* carrier : carriers) {
          const Series& series = all[carrier->name];
          print_row(out, size, *carrier, series, all);
          const Series& first = all[carriers.front()->name];
          if (!series.digest.empty() && !first.digest.empty() && series.digest != first.digest) {
            out << carrier->name << " has delivered something else than " << carriers.front()->name << std::endl;
            exit_code = kFailed;
          }
        }
      }
  } catch (const Cancelled&) {
    return kCancelled;
  }
  return exit_code;
}

}  // namespace interply::launch
