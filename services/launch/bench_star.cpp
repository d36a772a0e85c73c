/// The processes of one star: the hub, which starts its peers, and a peer.
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <list>
#include <optional>
#include <stdexcept>
#include <thread>

#include "bench/carriers.hpp"
#include "bench/loops.hpp"
#include "launch/bench_exchange.hpp"
#include "launch/process.hpp"
#include "launch/run.hpp"

namespace interply::launch {
namespace {

constexpr double kHubPatience = 10, kPeerPatience = 15;  ///< s of silence

const bench::Carrier& find_carrier(const std::string& name) {
  for (const bench::Carrier& carrier : bench::list_carriers())
    if (carrier.name == name) return carrier;
  throw std::runtime_error("there is no carrier " + name);
}

/// Gives up when a loop has not come to its next step for so long.
class Silence {
 public:
  Silence(double patience, const std::int64_t& step) : patience_(patience), step_(step) {}
  void look() {
    if (step_ != seen_) since_ = Clock::now();
    seen_ = step_;
    if (std::chrono::duration<double>(Clock::now() - since_).count() > patience_)
      throw std::runtime_error(fmt::format("nothing has arrived for {:g} s", patience_));
  }

 private:
  using Clock = std::chrono::steady_clock;
  double patience_;
  const std::int64_t& step_;
  std::int64_t seen_ = -1;
  Clock::time_point since_ = Clock::now();
};

/// Peers as child processes.
class PeerProcesses {
 public:
  PeerProcesses(const BenchStarOptions& options, const std::string& address) {
    for (int p = 0; p < options.peers; ++p) {
      const std::string name = fmt::format("peer {}", p);
      children_.emplace_back(name,
                             std::vector<std::string>{find_program_folder() / "interply", "bench", "peer",  //
                                                      "--carrier", options.carrier, "--address", address,   //
                                                      "--peers", std::to_string(options.peers), "--nodes",
                                                      std::to_string(options.nodes), "--peer", std::to_string(p)},
                             options.folder + fmt::format("/peer_{}.log", p));
    }
    reports_.resize(children_.size());
  }

  /// @throws std::runtime_error naming a peer that has failed
  void look() {
    int p = 0;
    for (Child& child : children_) {
      child.read_output([&](const std::string& line) { read_line(p, line); });
      if (child.reap() && child.exit_code() != kDone) {
        child.read_output([&](const std::string& line) { read_line(p, line); });
        throw std::runtime_error(fmt::format("{} {}{}", child.name(), child.describe_end(),
                                             child.last_lines().empty() ? "" : ": " + child.last_lines().back()));
      }
      ++p;
    }
  }

  void look_for_death() {
    for (int i = 0; i < 20; ++i) {
      look();
      ::poll(nullptr, 0, 10);
    }
  }

  std::vector<bench::PeerReport> collect() {
    const std::int64_t end = -1;
    Silence silence(kHubPatience, end);
    for (auto& child : children_)
      while (child.output() >= 0) {
        pollfd wanted{child.output(), POLLIN, 0};
        if (::poll(&wanted, 1, static_cast<int>(1e3 * bench::kSlice)) == 0) silence.look();
        look();
      }
    std::vector<bench::PeerReport> reports;
    for (const auto& report : reports_) {
      if (!report) throw std::runtime_error("a peer has left without a report");
      reports.push_back(*report);
    }
    return reports;
  }

 private:
  void read_line(int p, const std::string& line) {
    bench::PeerReport report;
    unsigned long motion = 0, force = 0;
    if (std::sscanf(line.c_str(), "@peer %lf %lx %lx", &report.cpu, &motion, &force) != 3) return;
    report.motion = motion;
    report.force = force;
    reports_[static_cast<std::size_t>(p)] = report;
  }

  std::list<Child> children_;
  std::vector<std::optional<bench::PeerReport>> reports_;
};

/// Peers as threads of this process; their CPU time is the hub's.
class PeerThreads {
 public:
  PeerThreads(const bench::StarSize& size, bench::Hub& hub)
      : reports_(static_cast<std::size_t>(size.peers)), errors_(reports_.size()) {
    for (int p = 0; p < size.peers; ++p)
      threads_.emplace_back([this, p, size, &hub] {
        const auto i = static_cast<std::size_t>(p);
        try {
          std::int64_t step = -1;
          reports_[i] = bench::run_peer(*hub.connect_thread(p), p, size, step);
          reports_[i].cpu = 0;
        } catch (...) {
          errors_[i] = std::current_exception();
        }
      });
  }
  std::vector<bench::PeerReport> collect() {
    threads_.clear();
    for (const auto& error : errors_)
      if (error) std::rethrow_exception(error);
    return reports_;
  }

 private:
  std::vector<bench::PeerReport> reports_;
  std::vector<std::exception_ptr> errors_;
  std::vector<std::jthread> threads_;
};

void check_ends(const bench::HubReport& hub, const std::vector<bench::PeerReport>& peers) {
  for (std::size_t p = 0; p < peers.size(); ++p)
    if (peers[p].motion != hub.ends[p].motion || peers[p].force != hub.ends[p].force)
      throw std::runtime_error(fmt::format("what peer {} has and what the hub has are not the same arrays", p));
}

}  // namespace

int bench_hub_command(const BenchStarOptions& options) {
  const bench::Carrier& carrier = find_carrier(options.carrier);
  const bench::StarSize size{options.peers, options.nodes};
  std::optional<PeerProcesses> processes;
  std::int64_t step = -1;
  Silence silence(kHubPatience, step);
  const auto hub = carrier.make_hub(size, options.folder, [&] {
    if (processes) processes->look();
    silence.look();
  });
  std::optional<PeerThreads> threads;
  if (carrier.connect)
    processes.emplace(options, hub->address());
  else
    threads.emplace(size, *hub);
  bench::HubReport report;
  try {
    report = bench::run_hub(*hub, size, options.seconds, step);
  } catch (const std::exception&) {
    if (processes) processes->look_for_death();  // says more than what came of it
    throw;
  }
  const std::vector<bench::PeerReport> peers = processes ? processes->collect() : threads->collect();
  check_ends(report, peers);
  for (const auto& peer : peers) report.cpu += peer.cpu;
  fmt::print("@star {} {:.9g} {:.9g} {:016x}\n", report.steps, report.wall, report.cpu, report.digest);
  return kDone;
}

int bench_peer_command(const BenchStarOptions& options) {
  const bench::StarSize size{options.peers, options.nodes};
  std::int64_t step = -1;
  Silence silence(kPeerPatience, step);
  const auto peer = find_carrier(options.carrier).connect(size, options.peer, options.address, [&] { silence.look(); });
  const bench::PeerReport report = bench::run_peer(*peer, options.peer, size, step);
  fmt::print("@peer {:.9g} {:x} {:x}\n", report.cpu, report.motion, report.force);
  return kDone;
}

}  // namespace interply::launch
