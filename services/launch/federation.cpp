#include "launch/federation.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <system_error>

#include "process/signals.hpp"

namespace interply::launch {
namespace {

// Seconds. The coordinator notices a dead solver in well under one and then needs a moment to close the record.
constexpr double kGraceAfterLoss = 1.5;
constexpr double kRecorderGraceAfterLoss = 5;
constexpr double kCoordinatorAfterSuspect = 5;
constexpr double kGraceAfterCancel = 1.0;     ///< with the next but two, all have ended within 2 s of a signal
constexpr double kGraceAfterCoordinator = 3;  ///< which has waited for all that joined
constexpr double kGraceAfterItsCancel = 0.3;  ///< who joins too late knows nothing of it
constexpr double kKillAfterTerminate = 0.6;

/// A process that leaves with one of these has said why, or was told to: by itself no reason to name it as lost.
bool is_orderly(const Child& child) {
  if (child.was_killed()) return false;
  const int code = child.exit_code();
  const bool has_told = code == kFailed && child.name() == "recorder";  // the coordinator says it
  return has_told || code == kDone || code == kDiverged || code == kLost || code == kCancelled;
}

std::string quote_log(const Child& child) {
  std::string text = child.last_lines().empty() ? "; its log is empty" : "; the last lines of its log:";
  for (const auto& line : child.last_lines()) text += "\n    " + line;
  return text;
}

/// True if the text holds the name, and not only as part of a longer one.
bool holds_name(const std::string& text, const std::string& name) {
  const auto is_part = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; };
  for (std::size_t at = 0; (at = text.find(name, at)) != text.npos; ++at) {
    const std::size_t end = at + name.size();
    if ((at == 0 || !is_part(text[at - 1])) && (end == text.size() || !is_part(text[end]))) return true;
  }
  return false;
}

/// Text after `prefix`, or nothing.
std::optional<std::string> after_prefix(const std::string& line, const std::string& prefix) {
  if (!line.starts_with(prefix)) return std::nullopt;
  return line.substr(prefix.size());
}

}  // namespace

Federation::Federation(FederationPlan plan, Terminal& terminal) : plan_(std::move(plan)), terminal_(terminal) {
  sigset_t handled = process::list_end_signals();
  sigaddset(&handled, SIGCHLD);
  if (!process::is_ignored(SIGTSTP)) sigaddset(&handled, SIGTSTP);
  sigprocmask(SIG_BLOCK, &handled, &old_mask_);
  signals_ = signalfd(-1, &handled, SFD_NONBLOCK | SFD_CLOEXEC);
  if (signals_ < 0) throw std::system_error(errno, std::generic_category(), "signalfd");
}

Federation::~Federation() {
  processes_.clear();
  close(signals_);
  sigprocmask(SIG_SETMASK, &old_mask_, nullptr);
}

RunResult Federation::supervise() {
  start(plan_.coordinator);
  limit(processes_.front(), plan_.startup_deadline);
  while (anyone_running()) {
    wait_for_events();
    stop_late();
  }
  if (result_.exit_code == kLost) describe_named();
  const bool said_cancelled = cause_ && cause_->exit_code == kCancelled && result_.exit_code == kCancelled;
  if (cause_ && cause_->exit_code == kLost && processes_.front().child->exit_code() == kLost && !reason_.empty())
    cause_->message += "\nthe coordinator: " + reason_;
  RunResult result = cause_ && !said_cancelled ? *cause_ : result_;  // the coordinator knows at which step
  result.summary = result_.summary;  // of mechanics that were done, even if the record was lost then
  result.summary_json = result_.summary_json;
  result.digest = result_.digest;
  for (const auto& p : processes_) result.cpu.push_back({p.child->name(), p.child->cpu_seconds()});
  return result;
}

void Federation::start(const Participant& participant) {
  processes_.push_back({std::make_unique<Child>(participant.name, participant.command,
                                                plan_.logs / (participant.name + ".log"), participant.inherited)});
}

void Federation::start_others(const std::string& bound) {
  bound_ = true;
  auto& coordinator = processes_.front();
  if (!coordinator.told_to_end) coordinator.stop_at = Clock::time_point::max();
  if (cause_) return;
  for (const auto& participant : plan_.others(bound)) start(participant);
  const bool is_private = bound.find("://@interply-") != bound.npos;  // of no use to anybody else
  terminal_.note(is_private ? fmt::format("{} processes over {}", processes_.size(), bound.substr(0, bound.find(':')))
                            : fmt::format("{} processes, the coordinator listens at {}", processes_.size(), bound));
}

bool Federation::anyone_running() const {
  return std::any_of(processes_.begin(), processes_.end(), [](const auto& p) { return p.child->running(); });
}

void Federation::wait_for_events() {
  auto deadline = Clock::time_point::max();
  std::vector<pollfd> watched{{signals_, POLLIN, 0}};
  std::vector<Supervised*> speakers{nullptr};
  for (auto& p : processes_) {
    watched.push_back({p.child->output(), POLLIN, 0});  // poll() skips -1
    speakers.push_back(&p);
    if (p.child->running()) deadline = std::min(deadline, p.stop_at);
  }
  int timeout = -1;
  if (deadline != Clock::time_point::max()) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    timeout = static_cast<int>(std::max<long long>(left, 0));
  }
  poll(watched.data(), watched.size(), timeout);
  for (std::size_t i = 1; i < watched.size(); ++i) {
    if (watched[i].revents == 0) continue;
    speakers[i]->child->read_output([&](const auto& line) { handle_line(*speakers[i], line); });
  }
  if (watched[0].revents != 0) handle_signals();
}

void Federation::handle_signals() {
  int cancel = 0;
  bool stop = false;
  for (signalfd_siginfo info; read(signals_, &info, sizeof info) == sizeof info;) {
    const int signal = static_cast<int>(info.ssi_signo);
    if (signal == SIGTSTP)
      stop = true;
    else if (signal != SIGCHLD)
      cancel = signal;
  }
  reap_ended();  // SIGCHLD signals coalesce: look at every child
  if (cancel != 0)
    handle_cancel(cancel);
  else if (stop)
    pause();
}

void Federation::pause() {
  const auto begin = Clock::now();
  terminal_.pause();
  for (auto& p : processes_) p.child->send_signal(SIGSTOP);  // each has a process group of its own
  process::stop_this_process();
  for (auto& p : processes_) p.child->send_signal(SIGCONT);
  const auto paused = Clock::now() - begin;
  for (auto& p : processes_)
    if (p.stop_at != Clock::time_point::max()) p.stop_at += paused;
}

void Federation::handle_cancel(int signal) {
  if (cancelled_) {
    for (auto& p : processes_) p.child->send_signal(SIGKILL);
    return;
  }
  cancelled_ = true;
  terminal_.note("stopping (once more: kill at once)");
  if (!cause_) cause_ = {kCancelled, "the run was cancelled", "", ""};
  for (auto& p : processes_) p.told_to_end = true;
  limit_all(kGraceAfterCancel);
  processes_.front().child->send_signal(signal);
  if (!bound_) limit_all(0);
}

void Federation::handle_line(const Supervised& from, const std::string& line) {
  if (!is_coordinator(from)) return;
  if (const auto progress = after_prefix(line, "@progress ")) {
    terminal_.show_progress(*progress);
  } else if (const auto summary = after_prefix(line, "@summary")) {
    if (!result_.summary.empty()) result_.summary += '\n';
    result_.summary += summary->starts_with(' ') ? summary->substr(1) : *summary;
  } else if (const auto json = after_prefix(line, "@json ")) {
    result_.summary_json += *json + '\n';
  } else if (const auto digest = after_prefix(line, "@digest ")) {
    result_.digest = *digest;
  } else if (const auto reason = after_prefix(line, "@reason ")) {
    reason_ = *reason;
  } else if (const auto address = after_prefix(line, "@bound "); address && !bound_) {
    start_others(*address);
  } else {
    terminal_.note(line);
  }
}

void Federation::reap_ended() {
  std::vector<Supervised*> ended;
  for (auto& p : processes_) {
    if (!p.child->reap()) continue;
    p.child->read_output([&](const auto& line) { handle_line(p, line); });
    ended.push_back(&p);
    if (!is_coordinator(p) && !p.told_to_end) left_.push_back(p.child.get());
  }
  // A crash that made others leave in order comes first.
  std::stable_partition(ended.begin(), ended.end(), [](const auto* p) { return !is_orderly(*p->child); });
  for (auto* p : ended) handle_end(*p);
}

void Federation::handle_end(Supervised& ended) {
  const Child& child = *ended.child;
  // the coordinator's own words suffice
  const bool has_said_why = is_coordinator(ended) && !child.was_killed() && (!bound_ || !reason_.empty());
  if (!ended.told_to_end && !is_orderly(child) && !has_said_why) report_lost(child);
  if (is_coordinator(ended)) {
    handle_coordinator_end(child);
  } else if (!ended.told_to_end && child.exit_code() != kDone && suspect_ == nullptr) {
    suspect_ = &child;
    limit(processes_.front(), kCoordinatorAfterSuspect);
  }
}

void Federation::handle_coordinator_end(const Child& coordinator) {
  const bool cancelled = !coordinator.was_killed() && coordinator.exit_code() == kCancelled;
  limit_all(cancelled ? kGraceAfterItsCancel : is_orderly(coordinator) ? kGraceAfterCoordinator : kGraceAfterLoss);
  if (cause_ && (!cancelled || reason_.empty())) return;
  result_.exit_code = coordinator.was_killed() ? kLost : coordinator.exit_code();
  if (result_.exit_code == kDone) return;
  const auto& lines = coordinator.last_lines();
  const std::string said = !reason_.empty() ? reason_ : lines.empty() ? "" : lines.back();
  const std::string left = "the coordinator " + coordinator.describe_end(), because = said.empty() ? "" : ": " + said;
  if (!bound_)
    result_.message = left + " before anything was started" + because;
  else if (coordinator.was_killed() || result_.exit_code > kCancelled || result_.exit_code == kRefused)
    result_.message = left + because;
  else
    result_.message = describe_early_end(result_.exit_code, result_.exit_code == kCancelled ? reason_ : said);
}

void Federation::describe_named() {
  for (const Child* child : left_) {
    if (!holds_name(result_.message, child->name())) continue;
    result_.message +=
        fmt::format("\n{} (process {}) {}{}", child->name(), child->pid(), child->describe_end(), quote_log(*child));
    return;
  }
}

void Federation::report_lost(const Child& lost) {
  if (cause_ || result_.exit_code != kDone) return;
  const bool failed = !lost.was_killed() && lost.exit_code() == kFailed;
  cause_ = {failed ? kFailed : kLost, fmt::format("{} (process {}) {}", lost.name(), lost.pid(), lost.describe_end()),
            "", ""};
  cause_->message += quote_log(lost);
  terminal_.end_progress();
  terminal_.note(fmt::format("{} is lost: stopping the others", lost.name()));
  for (auto& p : processes_) {
    p.told_to_end = true;
    limit(p, p.child->name() == "recorder" ? kRecorderGraceAfterLoss : kGraceAfterLoss);
  }
}

void Federation::limit(Supervised& process, double seconds) {
  const auto at = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  if (process.next_signal == SIGTERM) process.stop_at = std::min(process.stop_at, at);
}

void Federation::limit_all(double seconds) {
  for (auto& p : processes_) limit(p, seconds);
}

void Federation::stop_late() {
  const auto now = Clock::now();
  for (auto& p : processes_) {
    if (!p.child->running() || now < p.stop_at) continue;
    if (suspect_ != nullptr) report_lost(*suspect_);
    if (!cause_ && result_.exit_code == kDone) {
      const bool silent_start = is_coordinator(p) && !bound_;
      const std::string what = silent_start ? "does not listen" : "does not end after the run";
      cause_ = {kLost, fmt::format("{} (process {}) {}", p.child->name(), p.child->pid(), what), "", ""};
    }
    p.told_to_end = true;
    p.child->send_signal(p.next_signal);
    p.child->send_signal(SIGCONT);  // a stopped process acts on SIGTERM only when continued
    p.stop_at =
        p.next_signal == SIGTERM
            ? now + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(kKillAfterTerminate))
            : Clock::time_point::max();
    p.next_signal = SIGKILL;
  }
}

}  // namespace interply::launch
