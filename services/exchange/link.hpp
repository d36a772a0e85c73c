/// The lock-step link between a layer's process and the coordinator: one message per participant and direction per
/// step. Implementations: in_process.hpp (queues in one process) and zeromq.hpp (shm, ipc or tcp). Same calls, same
/// bits. Beside it the way of the record: samples from solvers and coordinator to the one recorder of a run, which
/// says what is in its file; so nothing reaches a record but from a participant, and nothing is dropped.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "mechanics/nodal.hpp"

namespace interply::exchange {

/// Version that all participants of a run must share; also written into the record.
inline constexpr const char* kVersion = "0.1.0";

/// Energies of one layer at step n, mJ, accumulated from the start with the integrator's midpoint displacements.
struct LayerEnergies {
  double kinetic = 0;
  double internal = 0;       ///< state function W (fabric) or stress work (metal)
  double internal_work = 0;  ///< work done against the nodal internal forces
  double contact_work = 0;   ///< work done on the layer by contact forces
};

/// Kind of the participant that keeps the record, and its name.
inline constexpr const char* kRecorder = "recorder";

struct Join {
  std::string version = kVersion;
  std::uint64_t scene_digest = 0;  ///< of the solver's own scene; 0: it has none and takes the coordinator's
  std::string layer;
  int pid = 0;
  std::string host;
  std::string kind;  ///< of layers that this solver computes: "fabric" or "metal"; kRecorder has no layer
};

/// Coordinator -> solver, the answer to Join. A solver started by hand needs nothing else: address and layer name
/// suffice. Both carriers are made with it: bind_zeromq(address, welcome, expected), InProcessHub(welcome, expected);
/// its digest is what Join::scene_digest (unless 0) must equal.
struct Welcome {
  std::string scene_text;  ///< resolved scene (scene::Scene::text)
  std::uint64_t scene_digest = 0;
  std::string run;  ///< unique name of this run (DDS partition)
};

/// Solver -> coordinator, state after the drift to step n.
struct Motion {
  std::int64_t step = 0;
  double vote = 0;                   ///< largest stable increment of this layer alone (no safety factor), s
  LayerEnergies energies;            ///< at step n - 1, the last complete one
  double step_seconds = 0;           ///< wall time of the last step
  double wait_seconds = 0;           ///< of that, spent waiting for the coordinator
  mechanics::NodalVectors position;  ///< x(n) [3 x n_nodes] mm
  mechanics::Scalars thickness;      ///< nodal thickness; size 0: unchanged since the last message that held one
};

/// Coordinator -> solver, the answer to Motion(n).
struct Force {
  std::int64_t step = 0;
  double time = 0;                ///< t(n), s
  double next_dt = 0;             ///< increment from step n to n + 1, s; unused if `last`
  int frame = -1;                 ///< number of the frame to publish of state n; -1: none
  bool last = false;              ///< state n is final: send Final and leave
  mechanics::NodalVectors force;  ///< contact force on the layer [3 x n_nodes] N
};

/// A named number of the one-screen summary.
struct SummaryItem {
  std::string name, unit;
  double value = 0;
};

/// A documented limit (THEORY.md of the solver) that elements of a layer passed in some frame of the run.
struct OutsideTrust {
  std::string quantity, unit, meaning;  ///< "thinning", "%", what lies beyond
  double limit = 0;
  double worst = 0;       ///< largest value of all frames
  double share = 0;       ///< largest share of the layer's reference area beyond the limit
  double x = 0, y = 0;    ///< centre of the worst element in the flat blank, mm
  double first_time = 0;  ///< of the first frame with an element beyond, s
};

/// Solver -> coordinator, once, after Force.last.
struct Final {
  std::uint64_t digest = 0;  ///< of the layer's whole state
  LayerEnergies energies;    ///< at the last step
  std::vector<SummaryItem> summary;
  std::vector<OutsideTrust> outside_trust;  ///< limits that were passed; empty: none
};

/// Bytes for the recorder (observe/sample.hpp), which the exchange does not look into.
struct Sample {
  std::string layer;  ///< of the solver that sent it, as it has joined; empty: the coordinator's own
  int frame = -1;     ///< that it belongs to; -1: none
  std::span<const std::byte> payload;
};

/// Recorder -> coordinator: what is in its file.
struct Recorded {
  int frames = 0;         ///< 0 ... frames - 1, from all participants
  std::int64_t rows = 0;  ///< of the history
  bool closed = false;    ///< after the run's end: the record is closed
};

/// Why a run ends before its time.
enum class StopReason { Diverged, Lost, Cancelled, Failed };

/// Thrown by the link of a solver or a recorder.
class Refused : public std::runtime_error {  ///< the coordinator's sentence
  using runtime_error::runtime_error;
};
class CoordinatorLost : public std::runtime_error {  ///< died or silent past the deadline
  using runtime_error::runtime_error;
};
class Stopped : public std::runtime_error {  ///< the coordinator says stop
 public:
  Stopped(StopReason r, const std::string& why) : runtime_error(why), reason(r) {}
  StopReason reason;
};

/// A solver's end.
class SolverLink {
 public:
  virtual ~SolverLink() = default;
  /// Connects and introduces the layer; returns when accepted.
  /// @throws Refused, CoordinatorLost (after `deadline` s: names the address)
  virtual Welcome join(const Join& join, double deadline) = 0;
  /// What the kernel has no room for (of a layer of some 100000 nodes, over TCP) leaves in receive().
  virtual void send(const Motion& motion) = 0;
  /// Waits for the answer to the last Motion, at most `deadline` s. Overwrites `force` without allocating once sized.
  /// @throws Stopped, CoordinatorLost
  virtual void receive(Force& force, double deadline) = 0;
  virtual void send(const Final& final) = 0;
  /// Says why this solver cannot go on (mechanics diverged), then waits briefly until it is delivered.
  virtual void send_failure(const std::string& message) = 0;
  /// For the recorder, if the run has one.
  virtual void send(const Sample& /*sample*/) {}
  /// Before leaving: waits until the coordinator has taken the Final and all before it, at most `deadline` s.
  /// @throws Stopped, CoordinatorLost
  virtual void wait_until_received(double /*deadline*/) {}
};

/// The recorder's end.
class RecorderLink {
 public:
  virtual ~RecorderLink() = default;
  /// As a solver's.
  virtual Welcome join(const Join& join, double deadline) = 0;
  /// The next sample, in the order in which each participant sent its own; nothing after `timeout` s. Its payload is
  /// valid until the next call. @throws CoordinatorLost
  virtual std::optional<Sample> receive(double timeout) = 0;
  virtual void send(const Recorded& recorded) = 0;
  /// Says why the record cannot go on (Failed: the disk; Lost: what a participant sent), then waits briefly until it is
  /// delivered.
  virtual void send_failure(StopReason reason, const std::string& message) = 0;
};

/// What happened at the coordinator's end.
struct Event {
  enum class Kind {
    None,      ///< timeout
    Joined,    ///< participant `who` was accepted (all checks done by the link)
    Moved,     ///< `motion(who)` holds a new Motion
    Ended,     ///< `final` of participant `who` arrived
    Failed,    ///< participant `who` cannot go on: `reason`, `message`
    Recorded,  ///< news of the recorder: `recorded`
    Suspect,   ///< a connection was lost (whose is not known unless who >= 0): check who is silent
    Cancelled  ///< interrupt: `message`
  };
  Kind kind = Kind::None;
  int who = -1;  ///< index into Expected, -1 unknown; the recorder's is the number of layers
  std::string message;
  Final final;
  StopReason reason = StopReason::Diverged;
  Recorded recorded;
};

/// Who may join: one entry per layer in scene order.
struct Expected {
  std::string layer;
  std::int64_t n_nodes = 0;         ///< every Motion of this layer must hold so many nodes
  std::int64_t largest_sample = 0;  ///< bytes; no Sample of this layer is larger
  std::string kind{};               ///< of the layer, as in Join
};

/// The coordinator's end. Checks every message at the edge; a stranger, a duplicate, a wrong version, digest or layer
/// and anything malformed is refused with one log line and does not disturb the run.
class CoordinatorLink {
 public:
  virtual ~CoordinatorLink() = default;
  /// Next event, or Kind::None after `timeout` s.
  virtual Event receive(double timeout) = 0;
  /// Last Motion of participant `who`; valid until its next Moved event.
  virtual const Motion& motion(int who) const = 0;
  virtual const Join& joined(int who) const = 0;
  /// Answers participant `who`; what the kernel has no room for leaves in receive(). False if it is gone.
  virtual bool send(int who, const Force& force) = 0;
  /// Tells everyone to stop.
  virtual void stop(StopReason reason, const std::string& message) = 0;
  /// Makes a pending or coming receive() return Cancelled. Callable from any thread (not from a signal handler).
  virtual void cancel(const std::string& message) = 0;

  /// A recorder takes part. What solvers send for it is handed on in receive().
  virtual bool expects_recorder() const { return false; }
  /// To the recorder, which must have joined. Never waits: order no more than it has confirmed, and a little.
  virtual void send(const Sample& /*sample*/) {}
  /// Participant `who` has been told to publish a frame of which the recorder has not been sent its part.
  virtual bool owes_sample(int /*who*/) const { return false; }
  /// Handed to the recorder so far, bytes.
  virtual std::int64_t bytes_recorded() const { return 0; }
};

}  // namespace interply::exchange
