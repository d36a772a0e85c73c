#include "coordinator/coordinator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "coordinator/frames.hpp"
#include "coordinator/quantity.hpp"
#include "coordinator/report.hpp"
#include "coordinator/step.hpp"
#include "coordinator/time_left.hpp"
#include "coordinator/waiting.hpp"
#include "mechanics/digest.hpp"
#include "mechanics/failure.hpp"
#include "process/exit_codes.hpp"

namespace interply::coordinator {

namespace {

using exchange::Event;
using exchange::StopReason;

constexpr int kFramesUnderWay = 4;                 ///< ordered, and not yet in the record
constexpr std::int64_t kBytesUnderWay = 64 << 20;  ///< these together, but one frame at least
constexpr std::int64_t kRowsUnderWay = 100;        ///< of the history
constexpr double kWatchers = 0.2;                  ///< s that whoever watches has for the last samples
constexpr double kLastWords = 1.5;  ///< s for a recorder to close the record of a run that was broken off

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
        sink_(sink),
        report_(report),
        log_(log),
        forming_(scene, link, sink),
        time_left_(scene.end_time()),
        is_here_(scene.layers.size(), false),
        has_ended_(scene.layers.size(), false),
        finals_(scene.layers.size()) {}

  Outcome form(const std::string& run_name) {
    if (!link_.expects_recorder()) put_header(run_name);
    await_participants(run_name);
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

  /// Until all frames and history rows are in the file.
  void await_record() {
    check_sink();
    const auto is_behind = [&] {
      return link_.expects_recorder() && (recorded_.frames < frames_begun_ || recorded_.rows < forming_.rows());
    };
    await_recorder(is_behind);
  }

  /// Once the recorder has been told of the end: until it has closed the record.
  /// @throws Ended
  void await_closing(double patience) {
    if (!recorder_is_here_) return;
    waiting_.restart();
    while (!recorded_.closed) {
      const Event event = link_.receive(0.1);
      if (event.kind == Event::Kind::Recorded) recorded_ = event.recorded;
      if (event.kind == Event::Kind::Cancelled) patience = std::min(patience, waiting_.seconds() + kLastWords);
      if (event.who == recorder() && event.kind == Event::Kind::Failed) throw failure_of(event);
      if (event.who == recorder() && event.kind == Event::Kind::Suspect) throw lost(event.who, event.message);
      if (waiting_.seconds() > patience)
        throw Ended{
            StopReason::Lost,
            fmt::format("no word from recorder for {:g} s after the end: the record may not be closed", patience)};
      if (waiting_.is_due()) log_(fmt::format("waiting for recorder to close for {:.0f} s", waiting_.seconds()));
    }
  }

  int frames_recorded() const { return link_.expects_recorder() ? static_cast<int>(recorded_.frames) : -1; }
  int frames_begun() const { return frames_begun_; }
  const std::string& too_soft() const { return forming_.measurements().too_soft(); }

 private:
  void put_header(const std::string& run_name) {
    observe::RunHeader header = make_header(scene_, run_name, forming_.stack());
    for (int i = 0; i < forming_.stack().n_layers(); ++i) {
      header.nodes.push_back(forming_.stack().layer(i).mesh.n_nodes());
      header.elements.push_back(forming_.stack().layer(i).mesh.n_elements());
    }
    sink_.put(header);
  }

  void await_participants(const std::string& run_name) {
    begin_waiting();
    while (!everyone_is_here() || recorder_is_here_ != link_.expects_recorder()) {
      const Event event = next_event();
      if (event.kind == Event::Kind::Joined) {
        if (event.who == recorder()) {
          recorder_is_here_ = true;
          put_header(run_name);
        } else {
          is_here_[static_cast<std::size_t>(event.who)] = true;
        }
        log_(fmt::format("{} joined (pid {} on {})", name(event.who), link_.joined(event.who).pid,
                         link_.joined(event.who).host));
      } else if (event.kind == Event::Kind::Moved) {
        early_.push_back(event.who);  // a quick one has sent its initial state already
      }
      if (waiting_.seconds() > scene_.exchange.startup_deadline)
        throw Ended{StopReason::Lost, fmt::format("start-up deadline of {:g} s passed: joined {}; missing {}{}",
                                                  scene_.exchange.startup_deadline, list(true), list(false), cure())};
      if (waiting_.is_due())
        log_(fmt::format("waiting for {} to join for {:.0f} s{}", list(false), waiting_.seconds(), cure()));
    }
  }
  std::string cure() const {
    return recorder_is_here_ == link_.expects_recorder()
               ? ""
               : "; start interply-recorder --connect ADDRESS --out DIR, or the coordinator with --no-record";
  }

  void form_all_steps() {
    while (true) {
      const auto step_start = Waiting::Clock::now();
      const bool last = forming_.pace().is_last();
      double waited = await_room_in_record();
      forming_.begin_step();
      if (forming_.pace().frame() >= 0) ++frames_begun_;
      begin_waiting();
      for (const int who : std::exchange(early_, {})) take(who);
      while (!forming_.is_step_complete()) {
        const auto wait_start = Waiting::Clock::now();
        const Event event = next_event();
        waited += std::chrono::duration<double>(Waiting::Clock::now() - wait_start).count();
        if (event.kind == Event::Kind::Moved) take_or_keep(event.who);
        if (!everyone_is_here()) check_patience(list(false));
      }
      if (!forming_.pace().is_started() && !forming_.start()) throw_lost();
      forming_.finish_step();
      if (last) return;
      forming_.note_time({std::chrono::duration<double>(Waiting::Clock::now() - step_start).count(), waited});
      time_left_.note(forming_.pace().time(),
                      std::chrono::duration<double>(Waiting::Clock::now().time_since_epoch()).count());
      report_progress({});
    }
  }

  Measures measure(const EnergyBalance& end) const {
    const Measurements& m = forming_.measurements();
    return {.steps = forming_.pace().step(),
            .largest_residual = m.largest_residual(),
            .final_residual = forming_.final_residual(end),
            .penetration_99 = m.penetration_99(),
            .penetration_peak = m.penetration_peak(),
            .holder_deviation = m.holder_deviation(),
            .holder_mean = m.holder_mean(forming_.holder_force())};
  }

  void await_finals() {
    begin_waiting();
    is_here_ = has_ended_;
    while (!everyone_is_here()) {
      next_event();
      is_here_ = has_ended_;
      if (!everyone_is_here()) check_patience(list(false));
    }
  }

  /// Before a step with a frame or a history row: until the recorder has kept enough of the earlier ones. The layers
  /// wait for their forces meanwhile.
  /// @returns s
  double await_room_in_record() {
    const Pace& pace = forming_.pace();
    if (pace.frame() < 0 && !pace.has_row()) return 0;
    check_sink();
    const auto is_behind = [&] {
      if (!link_.expects_recorder()) return false;
      return (pace.frame() >= 0 && pace.frame() - recorded_.frames >= frames_under_way()) ||
             (pace.has_row() && forming_.rows() - recorded_.rows >= kRowsUnderWay);
    };
    if (!is_behind()) return 0;
    await_recorder(is_behind);
    return waiting_.seconds();
  }

  template <typename Condition>
  void await_recorder(const Condition& is_behind) {
    waiting_.restart();
    while (is_behind()) {
      const Event event = next_event();
      if (event.kind == Event::Kind::Moved) early_.push_back(event.who);
      if (is_behind()) check_patience(list_owing());
    }
  }

  /// Frame 0 shows what a frame takes, and that the disk holds them all.
  int frames_under_way() const {
    if (recorded_.frames == 0) return 1;
    return static_cast<int>(std::clamp<std::int64_t>(kBytesUnderWay / first_frame_bytes_, 1, kFramesUnderWay));
  }

  /// Who keeps the record waiting.
  std::string list_owing() const {
    std::string names;
    for (int who = 0; who < recorder(); ++who)
      if (link_.owes_sample(who)) names += (names.empty() ? "" : ", ") + name(who);
    return names.empty() ? "recorder" : names;
  }

  /// A sink in this process has no other way to say so.
  void check_sink() const {
    if (const std::string why = sink_.failure(); !why.empty()) throw Ended{StopReason::Failed, why};
  }

  /// Events that end a run wherever they occur.
  Event next_event() {
    Event event = link_.receive(0.25);
    switch (event.kind) {
      case Event::Kind::Failed:
        if (event.who == recorder()) recorder_is_here_ = false;
        throw failure_of(event);
      case Event::Kind::Cancelled:
        throw Ended{StopReason::Cancelled,
                    fmt::format("the run was cancelled {} ({})", describe_instant(), event.message)};
      case Event::Kind::Suspect:
        if (event.who == recorder()) recorder_is_here_ = false;
        if (event.who >= 0) throw lost(event.who, event.message);
        break;
      case Event::Kind::Recorded:
        recorded_ = event.recorded;
        if (recorded_.frames > 0 && first_frame_bytes_ == 0)
          first_frame_bytes_ = std::max<std::int64_t>(link_.bytes_recorded(), 1);
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
    if (!forming_.take_motion(who)) throw_lost();
  }

  /// A force could not be delivered.
  [[noreturn]] void throw_lost() {
    while (next_event().kind != Event::Kind::None) {
    }  // whose it was may have said why: its failure overtakes its motion
    throw lost(forming_.lost(), "its connection is closed");
  }

  /// What a layer sent cannot be. Its own failure, which knows the element, may be on its way and goes first; if it
  /// only leaves, the fault says more.
  Ended blame(const std::string& fault) {
    const auto start = Waiting::Clock::now();
    try {
      while (Waiting::Clock::now() - start < std::chrono::seconds(1)) next_event();
    } catch (const Ended& ended) {
      if (ended.reason != StopReason::Lost) throw;
    }
    return {StopReason::Diverged, fault};
  }

  void check_patience(const std::string& whom) {
    if (waiting_.seconds() > scene_.exchange.wait_deadline)
      throw Ended{StopReason::Lost, fmt::format("no word from {} at step {} for {:g} s", whom, forming_.pace().step(),
                                                scene_.exchange.wait_deadline)};
    if (!waiting_.is_due()) return;
    log_(fmt::format("waiting for {} at step {} for {:.0f} s", whom, forming_.pace().step(), waiting_.seconds()));
    last_report_ = {};
    report_progress(whom);
  }

  void report_progress(const std::string& waiting_for) {
    const auto now = Waiting::Clock::now();
    if (now - last_report_ < std::chrono::milliseconds(500)) return;
    const Pace& pace = forming_.pace();
    last_report_ = now;
    report_({.step = pace.step(),
             .time = pace.time(),
             .end_time = scene_.end_time(),
             .dt = pace.next_dt(),
             .stroke = forming_.stroke(),
             .punch_force = forming_.punch_force(),
             .residual = forming_.residual(),
             .seconds_left = time_left_.seconds(),
             .waiting_for = waiting_for});
  }

  void begin_waiting() {
    std::fill(is_here_.begin(), is_here_.end(), false);
    waiting_.restart();
  }
  bool everyone_is_here() const { return std::find(is_here_.begin(), is_here_.end(), false) == is_here_.end(); }
  int recorder() const { return static_cast<int>(scene_.layers.size()); }
  std::string name(int who) const {
    return who == recorder() ? "recorder" : scene_.layers[static_cast<std::size_t>(who)].name;
  }
  std::string list(bool here) const {
    std::string names;
    for (std::size_t i = 0; i < is_here_.size(); ++i)
      if (is_here_[i] == here) names += (names.empty() ? "" : ", ") + scene_.layers[i].name;
    if (link_.expects_recorder() && recorder_is_here_ == here) names += (names.empty() ? "" : ", ") + name(recorder());
    return names.empty() ? "nobody" : names;
  }
  std::string describe_instant() const {
    const Pace& pace = forming_.pace();
    if (frames_begun_ == 0 && pace.step() == 0) return "before the first step";
    return fmt::format("at step {}, {:.3f} ms, stroke {:.1f} mm", pace.step(), 1e3 * pace.time(), forming_.stroke());
  }
  Ended lost(int who, const std::string& why) const {
    return {StopReason::Lost, fmt::format("lost {} at step {}: {}", name(who), forming_.pace().step(), why)};
  }

  Ended failure_of(const Event& event) const {
    return {event.reason, event.who == recorder() ? "recorder: " + event.message : event.message};
  }

  const scene::Scene& scene_;
  exchange::CoordinatorLink& link_;
  observe::Sink& sink_;
  const std::function<void(const Progress&)>& report_;
  const std::function<void(const std::string&)>& log_;
  Forming forming_;
  TimeLeft time_left_;
  std::vector<bool> is_here_, has_ended_;
  std::vector<int> early_;  ///< layers whose motion of the next step is already here
  std::vector<exchange::Final> finals_;
  Waiting waiting_;
  Waiting::Clock::time_point last_report_{};
  int frames_begun_ = 0;
  bool recorder_is_here_ = false;
  exchange::Recorded recorded_;
  std::int64_t first_frame_bytes_ = 0;  ///< with meshes; 0: not known
};

int find_exit_code(StopReason reason) {
  switch (reason) {
    case StopReason::Failed:
      return process::kFailed;
    case StopReason::Diverged:
      return process::kDiverged;
    case StopReason::Lost:
      return process::kLost;
    case StopReason::Cancelled:
      break;
  }
  return process::kCancelled;
}

}  // namespace

Outcome run(const scene::Scene& scene, const std::string& run_name, exchange::CoordinatorLink& link,
            observe::Sink& sink, const std::function<void(const Progress&)>& report,
            const std::function<void(const std::string&)>& log) {
  Outcome outcome;
  Run run(scene, link, sink, report, log);
  StopReason reason{};
  const auto end_early = [&](StopReason why, const std::string& message) {
    reason = why;
    outcome.exit_code = find_exit_code(why);
    outcome.message = message;
  };
  try {
    outcome = run.form(run_name);
    run.await_record();
  } catch (const Ended& ended) {
    end_early(ended.reason, ended.message);
  } catch (const mechanics::Divergence& failure) {
    end_early(StopReason::Diverged, failure.what());
  }
  if (outcome.exit_code == 3 && !run.too_soft().empty()) outcome.message += "; before that, " + run.too_soft();
  if (outcome.exit_code != 0) link.stop(reason, outcome.message);
  static const char* const kStatus[] = {"done", "failed", "", "diverged", "lost", "cancelled"};
  const bool done = outcome.exit_code == 0;
  sink.put(observe::RunEnd{.status = kStatus[outcome.exit_code],
                           .message = outcome.message,
                           .digest = done ? outcome.digest : "",
                           .frames_complete = run.frames_begun(),
                           .summary = done ? outcome.summary_json : ""});
  try {
    run.await_closing(done || outcome.exit_code == 3 ? scene.exchange.wait_deadline : kLastWords);
  } catch (const Ended& ended) {
    if (done) end_early(ended.reason, ended.message);
  }
  sink.flush(kWatchers);
  outcome.frames_recorded = run.frames_recorded();
  return outcome;
}

}  // namespace interply::coordinator
