/// How a process of a run is asked to end, and that it does.
#pragma once

#include <csignal>
#include <functional>
#include <string>

namespace interply::process {

/// Seconds that a process has to end once it was asked to, or once its work is done.
inline constexpr double kGrace = 1.7;

/// From now on the process ends with this exit code when `seconds` have passed, whatever its threads and libraries
/// still wait for. The first call of a process decides.
void end_within(double seconds, int exit_code);

/// SIGINT, SIGTERM and SIGHUP, the last unless it was ignored when the process began (nohup).
sigset_t list_end_signals();

/// Whether this process was started to take no notice of the signal, or has chosen so.
bool is_ignored(int signal);

/// What SIGTSTP (Ctrl-Z) does by default, for a process that takes it otherwise: stopped until it is continued; not at
/// all where no shell could continue it (an orphaned process group, as of the first process of a container).
void stop_this_process();

/// While nothing has been started yet: these signals end the process at once, with this exit code.
void end_at_once_by_signals(int exit_code);

/// "interrupted by SIGINT"
std::string describe_request(int signal);

/// Takes the signals of list_end_signals(). The first one is told
/// to whoever wants to know and ends the process within kGrace; the second ends it at once. For the start of main():
/// threads that began earlier would die of them. One per process.
class EndRequests {
 public:
  /// @param exit_code  of a process that has to be ended
  explicit EndRequests(int exit_code);

  /// Whoever wants to know, for as long as this lives.
  class Listener {
   public:
    explicit Listener(EndRequests& requests) : requests_(requests) {}
    ~Listener() { requests_.forget(); }
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;

   private:
    EndRequests& requests_;
  };
  /// `told` is called once with why, from another thread, or now if the request has come already.
  [[nodiscard]] Listener tell(std::function<void(const std::string& why)> told);

 private:
  struct Parts;
  void forget();
  Parts* const parts_;  ///< stay until the process ends, as the thread does that watches
};

/// For a process that needs no order to end: SIGINT, SIGTERM and SIGHUP end it at once; but when its parent has died,
/// which sends SIGTERM to every participant of a run at once, a second later, so that the coordinator can say so first.
void end_by_signals();

}  // namespace interply::process
