#include "exchange/in_process.hpp"

#include <fmt/format.h>

#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

#include "exchange/admission.hpp"
#include "exchange/deadline.hpp"

namespace interply::exchange {

namespace {

/// What passes between one solver and the coordinator. `incoming` belongs to the solver's thread until its Moved event
/// is taken, `force` to the coordinator's until `answered`; so arrays are copied without the lock.
struct Lane {
  Motion incoming;  ///< written by the solver, swapped with `motion` by receive()
  Motion motion;    ///< what the coordinator reads
  Force force;      ///< swapped with the solver's by receive()
  bool answered = false;
  Final final;
  std::string message;  ///< of a failure or a loss
  std::condition_variable wake;
};

struct Pending {
  Event::Kind kind;
  int who;
};

}  // namespace

struct InProcessHub::State {
  State(std::uint64_t digest, std::vector<Expected> expected)
      : scene_digest(digest),
        admission(digest, std::move(expected)),
        lanes(static_cast<std::size_t>(admission.size())) {
    pending.reserve(8 * lanes.size() + 8);
  }

  Lane& lane(int who) { return lanes[static_cast<std::size_t>(who)]; }
  void push(Event::Kind kind, int who) {
    pending.push_back({kind, who});
    wake.notify_one();
  }
  void wake_solvers() {
    for (Lane& l : lanes) l.wake.notify_all();
  }

  const std::uint64_t scene_digest;
  std::mutex mutex;  ///< guards everything but the arrays in transit
  std::condition_variable wake;
  Admission admission;
  RefusalLog refusals;
  std::vector<Lane> lanes;
  std::vector<Pending> pending;
  std::optional<std::string> cancelled;
  std::optional<std::pair<StopReason, std::string>> stopped;
  bool closed = false;
};

namespace {

using State = InProcessHub::State;
using Lock = std::unique_lock<std::mutex>;

class InProcessSolver final : public SolverLink {
 public:
  explicit InProcessSolver(std::shared_ptr<State> state) : state_(std::move(state)) {}

  ~InProcessSolver() override {
    const Lock lock(state_->mutex);
    if (who_ < 0 || !state_->admission.note_gone(who_)) return;
    state_->lane(who_).message = fmt::format("{} has left before the end", describe(state_->admission.join(who_)));
    state_->push(Event::Kind::Suspect, who_);
  }

  Welcome join(const Join& join, double) override {
    const Lock lock(state_->mutex);
    if (state_->closed) throw CoordinatorLost("the coordinator has ended before this layer joined");
    if (state_->stopped) throw Stopped(state_->stopped->first, state_->stopped->second);
    const Admission::Verdict verdict = state_->admission.judge(join);
    if (verdict.who < 0) {
      state_->refusals.warn("a thread:", verdict.refusal, verdict.refusal);
      throw Refused(verdict.refusal);
    }
    who_ = verdict.who;
    state_->push(Event::Kind::Joined, who_);
    return {.scene_text = "", .scene_digest = state_->scene_digest, .run = ""};
  }

  void send(const Motion& motion) override {
    {
      const Lock lock(state_->mutex);
      const std::string refusal =
          who_ < 0 ? std::string("sent a motion without having joined")
                   : state_->admission.judge_motion(who_, motion.step, motion.position.cols(), motion.thickness.size());
      if (!refusal.empty()) return refuse("motion", refusal);
      step_ = motion.step;
    }
    Lane& lane = state_->lane(who_);
    lane.incoming = motion;
    const Lock lock(state_->mutex);
    state_->push(Event::Kind::Moved, who_);
  }

  void receive(Force& force, double deadline) override {
    if (who_ < 0) throw std::logic_error("receive() before join()");
    Deadline until(deadline);
    Lane& lane = state_->lane(who_);
    Lock lock(state_->mutex);
    const auto is_over = [&] { return lane.answered || state_->stopped.has_value() || state_->closed; };
    while (!is_over() && !until.passed()) lane.wake.wait_for(lock, until.left(), is_over);
    if (lane.answered) {
      lane.answered = false;
      std::swap(force, lane.force);
      return;
    }
    if (state_->stopped) throw Stopped(state_->stopped->first, state_->stopped->second);
    if (state_->closed) throw CoordinatorLost(fmt::format("the coordinator has ended at step {}", step_));
    throw CoordinatorLost(
        fmt::format("no answer from the coordinator in this process for {:g} s at step {}", deadline, step_));
  }

  void send(const Final& final) override {
    const Lock lock(state_->mutex);
    const std::string refusal =
        who_ < 0 ? "sent a final message without having joined" : state_->admission.judge_final(who_);
    if (!refusal.empty()) return refuse("final", refusal);
    state_->lane(who_).final = final;
    state_->push(Event::Kind::Ended, who_);
  }

  void send_failure(const std::string& message) override {
    const Lock lock(state_->mutex);
    const std::string refusal =
        who_ < 0 ? "sent a failure without having joined" : state_->admission.judge_failure(who_);
    if (!refusal.empty()) return refuse("failure", refusal);
    state_->lane(who_).message = message;
    state_->push(Event::Kind::Failed, who_);
  }

 private:
  /// @pre the lock is held
  void refuse(const char* kind, const std::string& sentence) {
    state_->refusals.warn(who_ < 0 ? "a thread" : state_->admission.join(who_).layer, kind, sentence);
  }

  std::shared_ptr<State> state_;
  int who_ = -1;
  std::int64_t step_ = -1;
};

class InProcessCoordinator final : public CoordinatorLink {
 public:
  explicit InProcessCoordinator(std::shared_ptr<State> state) : state_(std::move(state)) {}

  Event receive(double timeout) override {
    Deadline until(timeout);
    Lock lock(state_->mutex);
    const auto is_over = [&] { return !state_->pending.empty() || state_->cancelled; };
    while (!is_over() && !until.passed()) state_->wake.wait_for(lock, until.left(), is_over);
    Event event;
    if (state_->cancelled) {
      event.kind = Event::Kind::Cancelled;
      event.message = std::move(*state_->cancelled);
      state_->cancelled.reset();
      return event;
    }
    if (state_->pending.empty()) return event;
    event.kind = state_->pending.front().kind;
    event.who = state_->pending.front().who;
    state_->pending.erase(state_->pending.begin());
    Lane& lane = state_->lane(event.who);
    if (event.kind == Event::Kind::Moved) std::swap(lane.incoming, lane.motion);
    if (event.kind == Event::Kind::Ended) event.final = std::move(lane.final);
    if (event.kind == Event::Kind::Failed || event.kind == Event::Kind::Suspect) event.message = lane.message;
    return event;
  }

  const Motion& motion(int who) const override { return state_->lane(who).motion; }
  const Join& joined(int who) const override { return state_->admission.join(who); }

  bool send(int who, const Force& force) override {
    Lane& lane = state_->lane(who);
    {
      const Lock lock(state_->mutex);
      if (!state_->admission.note_answer(who, force)) return false;
    }
    lane.force = force;
    const Lock lock(state_->mutex);
    lane.answered = true;
    lane.wake.notify_all();
    return true;
  }

  void stop(StopReason reason, const std::string& message) override {
    const Lock lock(state_->mutex);
    state_->admission.close(message);
    state_->stopped.emplace(reason, message);
    state_->wake_solvers();
  }

  void cancel(const std::string& message) override {
    const Lock lock(state_->mutex);
    state_->cancelled = message;
    state_->wake.notify_all();
  }

 private:
  std::shared_ptr<State> state_;
};

}  // namespace

InProcessHub::InProcessHub(std::uint64_t scene_digest, std::vector<Expected> expected)
    : state_(std::make_shared<State>(scene_digest, std::move(expected))),
      coordinator_(std::make_unique<InProcessCoordinator>(state_)) {}

InProcessHub::~InProcessHub() { close(); }

std::unique_ptr<SolverLink> InProcessHub::connect() { return std::make_unique<InProcessSolver>(state_); }

void InProcessHub::close() {
  const Lock lock(state_->mutex);
  state_->admission.close("the coordinator has ended");
  state_->closed = true;
  state_->wake_solvers();
}

}  // namespace interply::exchange
