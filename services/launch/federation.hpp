/// Supervision of one run's processes: starts them, relays what the coordinator says, names who died, leaves nothing
/// behind.
#pragma once

#include <sys/signalfd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "launch/process.hpp"
#include "launch/run.hpp"
#include "launch/terminal.hpp"

namespace interply::launch {

/// One process of the federation.
struct Participant {
  std::string name;                  ///< "coordinator", "recorder" or the layer's name
  std::vector<std::string> command;  ///< absolute path of the program and its arguments
  int inherited = -1;                ///< descriptor of ours that it keeps open
};

/// What to start: the coordinator first; the others once it has said where it listens.
struct FederationPlan {
  Participant coordinator;
  /// Made from the address of the coordinator's line "@bound ADDRESS" (coordinator/voice.hpp).
  std::function<std::vector<Participant>(const std::string& bound)> others;
  std::filesystem::path logs;    ///< folder for one log file per process
  double startup_deadline = 60;  ///< s until the coordinator listens
};

/// Waits for events only (output, child exits, signals, one deadline per process), never spins.
///
/// A process that ends before its time is named with its last lines of log. The coordinator, which notices a dead
/// solver over its link, is given a moment to stop everyone in order; then what is left gets SIGTERM, later SIGKILL.
/// The first SIGINT, SIGTERM or SIGHUP asks the coordinator to stop the run; the second kills everything. SIGTSTP
/// (Ctrl-Z) stops all of them and this process until it is continued.
class Federation {
 public:
  /// Blocks the signals that it handles; one Federation at a time.
  Federation(FederationPlan plan, Terminal& terminal);
  ~Federation();
  Federation(const Federation&) = delete;
  Federation& operator=(const Federation&) = delete;

  /// Returns when every process has been reaped.
  RunResult supervise();

 private:
  using Clock = std::chrono::steady_clock;
  struct Supervised {
    std::unique_ptr<Child> child;
    Clock::time_point stop_at = Clock::time_point::max();  ///< when it gets `next_signal`
    int next_signal = SIGTERM;
    bool told_to_end = false;  ///< by us: its end is no loss
  };

  void start(const Participant& participant);
  void start_others(const std::string& bound);
  void wait_for_events();
  void handle_signals();
  void handle_cancel(int signal);
  void pause();
  void handle_line(const Supervised& from, const std::string& line);
  void reap_ended();
  void handle_end(Supervised& ended);
  void handle_coordinator_end(const Child& coordinator);
  /// Whom the coordinator named as lost, with its last lines: a law of the user's own may have ended it in good order.
  void describe_named();
  void report_lost(const Child& lost);
  void stop_late();
  void limit(Supervised& process, double seconds);
  void limit_all(double seconds);
  bool anyone_running() const;
  bool is_coordinator(const Supervised& process) const { return &process == &processes_.front(); }

  FederationPlan plan_;
  Terminal& terminal_;
  sigset_t old_mask_{};
  int signals_ = -1;                 ///< signalfd
  std::list<Supervised> processes_;  ///< the coordinator first; addresses stay while others are added
  const Child* suspect_ = nullptr;   ///< left in order but too early; the coordinator should say why
  std::vector<const Child*> left_;   ///< by themselves, with any exit code; not the coordinator
  bool bound_ = false, cancelled_ = false;
  std::optional<RunResult> cause_;  ///< first reason to end early that was seen here
  RunResult result_;                ///< what the coordinator said
  std::string reason_;              ///< of an early end, in its words
};

}  // namespace interply::launch
