#include "coordinator/coordinator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "coordinator/frames.hpp"
#include "coordinator/report.hpp"
#include "coordinator/step.hpp"
#include "coordinator/waiting.hpp"
#include "mechanics/digest.hpp"
#include "mechanics/failure.hpp"

namespace interply::coordinator {

namespace {

using exchange::Event;
using exchange::StopReason;

/// Why the loop ends early; caught in run().
struct Ended {
  StopReason reason;
  std::string message;
};

class Run {
 public:
  Run(const scene::Scene& scene, exchange::CoordinatorLink& link, observe::Sink& sink,
      const std::function<void(const Progress&)>& report, const std::function<void(const std::string&)>& log)
      : scene_(scene),
        link_(link),
        report_(report),
        log_(log),
        forming_(scene, link, sink),
        is_here_(scene.layers.size(), false),
        has_ended_(scene.layers.size(), false),
        finals_(scene.layers.size()) {}

  Outcome form() {
    await_participants();
    const auto start = Waiting::Clock::now();
    form_all_steps();
    await_finals();
    const std::chrono::duration<double> seconds = Waiting::Clock::now() - start;
    const EnergyBalance end = forming_.balance_end(finals_);
    forming_.put_history_row(end);
    mechanics::Digest digest;
    for (const exchange::Final& f : finals_) digest.add(&f.digest, sizeof f.digest);
    summary::Summary summary = summarise(scene_, forming_, end, finals_, seconds.count());
    summary.set_digest(mechanics::to_hex(digest.value()));
    return {.exit_code = 0,
            .digest = summary.digest(),
            .summary = format_text(summary),
            .summary_json = format_json(summary),
            .measures = measure(end)};
  }

  int frames_begun() const { return frames_begun_; }
  const std::string& too_soft() const { return forming_.too_soft(); }

 private:
  void await_participants() {
    begin_waiting();
    while (!everyone_is_here()) {
      const Event event = next_event();
      if (event.kind == Event::Kind::Joined) {
        is_here_[static_cast<std::size_t>(event.who)] = true;
        log_(fmt::format("{} joined (pid {} on {})", name(event.who), link_.joined(event.who).pid,
                         link_.joined(event.who).host));
      } else if (event.kind == Event::Kind::Moved) {
        early_.push_back(event.who);  // a quick one has sent its initial state already
      }
      if (waiting_.seconds() > scene_.exchange.startup_deadline)
        throw Ended{StopReason::Lost, fmt::format("start-up deadline of {:g} s passed: joined {}; missing {}",
                                                  scene_.exchange.startup_deadline, list(true), list(false))};
      if (waiting_.is_due()) log_(fmt::format("waiting for {} to join for {:.0f} s", list(false), waiting_.seconds()));
    }
  }

  void form_all_steps() {
    while (true) {
      const auto step_start = Waiting::Clock::now();
      const bool last = forming_.pace().is_last();
      double waited = 0;
      forming_.begin_step();
      if (forming_.pace().frame() >= 0) ++frames_begun_;
      begin_waiting();
      for (const int who : std::exchange(early_, {})) take(who);
      while (!forming_.is_step_complete()) {
        const auto wait_start = Waiting::Clock::now();
        const Event event = next_event();
        waited += std::chrono::duration<double>(Waiting::Clock::now() - wait_start).count();
        if (event.kind == Event::Kind::Moved) take_or_keep(event.who);
        check_patience();
      }
      forming_.finish_step();
      if (last) return;
      forming_.step_seconds = std::chrono::duration<double>(Waiting::Clock::now() - step_start).count();
      forming_.wait_seconds = waited;
      report_progress({});
    }
  }

  Measures measure(const EnergyBalance& end) const {
    return {.steps = forming_.pace().step(),
            .largest_residual = forming_.largest_residual(),
            .final_residual = forming_.final_residual(end),
            .penetration_99 = forming_.penetration_99(),
            .penetration_peak = forming_.penetration_peak(),
            .holder_deviation = forming_.holder_deviation(),
            .holder_mean = forming_.holder_mean()};
  }

  void await_finals() {
    begin_waiting();
    is_here_ = has_ended_;
    while (!everyone_is_here()) {
      next_event();
      is_here_ = has_ended_;
      check_patience();
    }
  }

  /// Events that end a run wherever they occur.
  Event next_event() {
    Event event = link_.receive(0.25);
    switch (event.kind) {
      case Event::Kind::Failed:
        throw Ended{StopReason::Diverged, event.message};
      case Event::Kind::Cancelled:
        throw Ended{StopReason::Cancelled, event.message};
      case Event::Kind::Suspect:
        if (event.who >= 0) throw lost(event.who, event.message);
        break;
      case Event::Kind::Ended:  // perhaps before others have even arrived at the last step
        has_ended_[static_cast<std::size_t>(event.who)] = true;
        finals_[static_cast<std::size_t>(event.who)] = event.final;
        break;
      default:
        break;
    }
    return event;
  }

  /// A layer that was answered early may be a step ahead of the others: its motion waits for the next step.
  void take_or_keep(int who) {
    if (is_here_[static_cast<std::size_t>(who)])
      early_.push_back(who);
    else
      take(who);
  }

  void take(int who) {
    is_here_[static_cast<std::size_t>(who)] = true;
    if (const std::string fault = forming_.find_fault(who); !fault.empty()) throw blame(fault);
    if (forming_.take_motion(who)) return;
    while (next_event().kind != Event::Kind::None) {
    }  // the one that cannot be answered may have said why: its failure overtakes its answer
    throw lost(forming_.lost(), "its connection is closed");
  }

  /// What a layer sent cannot be. Its own failure, which knows the element, may be on its way and goes first.
  Ended blame(const std::string& fault) {
    const auto start = Waiting::Clock::now();
    while (Waiting::Clock::now() - start < std::chrono::seconds(1)) next_event();
    return {StopReason::Diverged, fault};
  }

  void check_patience() {
    if (everyone_is_here()) return;
    if (waiting_.seconds() > scene_.exchange.wait_deadline)
      throw Ended{StopReason::Lost, fmt::format("no word from {} at step {} for {:g} s", list(false),
                                                forming_.pace().step(), scene_.exchange.wait_deadline)};
    if (!waiting_.is_due()) return;
    log_(
        fmt::format("waiting for {} at step {} for {:.0f} s", list(false), forming_.pace().step(), waiting_.seconds()));
    last_report_ = {};
    report_progress(list(false));
  }

  void report_progress(const std::string& waiting_for) {
    const auto now = Waiting::Clock::now();
    if (now - last_report_ < std::chrono::milliseconds(500)) return;
    const Pace& pace = forming_.pace();
    const double elapsed = std::chrono::duration<double>(now - first_report_).count();
    // pace of the last few seconds: the increment changes over a run
    if (elapsed > 3) {
      rate_ = (pace.time() - first_time_) / elapsed;
      first_report_ = now;
      first_time_ = pace.time();
    }
    last_report_ = now;
    report_({.step = pace.step(),
             .time = pace.time(),
             .end_time = scene_.end_time(),
             .dt = pace.next_dt(),
             .stroke = forming_.stroke(),
             .punch_force = forming_.punch_force(),
             .residual = forming_.residual(),
             .seconds_left = rate_ > 0 ? (scene_.end_time() - pace.time()) / rate_ : -1,
             .waiting_for = waiting_for});
  }

  void begin_waiting() {
    std::fill(is_here_.begin(), is_here_.end(), false);
    waiting_.restart();
  }
  bool everyone_is_here() const { return std::find(is_here_.begin(), is_here_.end(), false) == is_here_.end(); }
  const std::string& name(int who) const { return scene_.layers[static_cast<std::size_t>(who)].name; }
  std::string list(bool here) const {
    std::string names;
    for (std::size_t i = 0; i < is_here_.size(); ++i)
      if (is_here_[i] == here) names += (names.empty() ? "" : ", ") + scene_.layers[i].name;
    return names.empty() ? "nobody" : names;
  }
  Ended lost(int who, const std::string& why) const {
    return {StopReason::Lost, fmt::format("lost {} at step {}: {}", name(who), forming_.pace().step(), why)};
  }

  const scene::Scene& scene_;
  exchange::CoordinatorLink& link_;
  const std::function<void(const Progress&)>& report_;
  const std::function<void(const std::string&)>& log_;
  Forming forming_;
  std::vector<bool> is_here_, has_ended_;
  std::vector<int> early_;  ///< layers whose motion of the next step is already here
  std::vector<exchange::Final> finals_;
  Waiting waiting_;
  Waiting::Clock::time_point last_report_{}, first_report_ = Waiting::Clock::now();
  double first_time_ = 0, rate_ = 0;
  int frames_begun_ = 0;
};

}  // namespace

Outcome run(const scene::Scene& scene, const std::string& run_name, exchange::CoordinatorLink& link,
            observe::Sink& sink, const std::function<void(const Progress&)>& report,
            const std::function<void(const std::string&)>& log) {
  sink.put(make_header(scene, run_name));
  Outcome outcome;
  Run run(scene, link, sink, report, log);
  try {
    outcome = run.form();
  } catch (const Ended& ended) {
    outcome.exit_code = ended.reason == StopReason::Diverged ? 3 : ended.reason == StopReason::Lost ? 4 : 5;
    outcome.message = ended.message;
  } catch (const mechanics::Divergence& failure) {
    outcome.exit_code = 3;
    outcome.message = failure.what();
  }
  if (outcome.exit_code == 3 && !run.too_soft().empty()) outcome.message += "; before that, " + run.too_soft();
  static const char* const kStatus[] = {"done", "", "", "diverged", "lost", "cancelled"};
  if (outcome.exit_code != 0) {
    const StopReason reason = outcome.exit_code == 3   ? StopReason::Diverged
                              : outcome.exit_code == 4 ? StopReason::Lost
                                                       : StopReason::Cancelled;
    link.stop(reason, outcome.message);
  }
  sink.put(observe::RunEnd{.status = kStatus[outcome.exit_code],
                           .message = outcome.message,
                           .digest = outcome.digest,
                           .frames_complete = run.frames_begun(),
                           .summary = outcome.summary_json});
  sink.flush(outcome.exit_code == 0 ? 10 : 2);  // what was lost may be the recorder: do not wait for it for long
  return outcome;
}

}  // namespace interply::coordinator
