/// Who takes part in a run and whose turn it is: the checks at the coordinator's edge, the same for every carrier.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "exchange/link.hpp"

namespace interply::exchange {

/// One line for a peer in messages: `ply_2 (process 4711 on host)`.
std::string describe(const Join& join);

/// Keeps one seat per expected layer, and the last one for the recorder if there is one. Every judge_ function either accepts a message and takes note of it, or returns
/// the sentence of the refusal (empty: accepted) and changes nothing.
class Admission {
 public:
  Admission(std::uint64_t scene_digest, std::vector<Expected> expected, bool recorder = false);

  int size() const { return static_cast<int>(seats_.size()); }
  int n_layers() const { return size() - (recorder_ ? 1 : 0); }
  /// Seat of the recorder, -1: the run has none.
  int recorder() const { return recorder_ ? n_layers() : -1; }
  const Join& join(int who) const { return seat(who).join; }
  /// Joined, and neither ended, failed nor lost.
  bool is_active(int who) const { return seat(who).stage == Stage::Active; }
  /// Most nodes of any layer; most bytes of a sample.
  std::int64_t largest_layer() const;
  std::int64_t largest_sample() const;

  /// Version, layer name, kind of solver, scene digest (0: it takes ours), first of its name.
  /// @returns the seat, or the refusal
  struct Verdict {
    int who = -1;
    std::string refusal;
  };
  Verdict judge(const Join& join);

  /// A Motion is accepted once per step, after the answer to the step before. The first one of a run sets the first
  /// step.
  std::string judge_motion(int who, std::int64_t step, std::int64_t n_nodes, std::int64_t n_thickness);
  /// A Final is accepted after an answer with `last`.
  std::string judge_final(int who);
  std::string judge_failure(int who);
  /// A Sample is accepted from a layer for itself, while it takes part.
  std::string judge_sample(int who, const Sample& sample) const;
  /// `closed` is the recorder's last word.
  std::string judge_recorded(int who, bool closed);

  /// Checks the coordinator's own answer. False if the participant is not there any more.
  /// @throws std::logic_error for a step that was not asked for or an array of another size
  bool note_answer(int who, const Force& force);
  /// Its connection is gone. @returns true if that is a loss: it was active and nobody was told to leave
  bool note_gone(int who);
  /// Nobody may join any more.
  void close(const std::string& why);

 private:
  enum class Stage { Awaited, Active, Ended, Failed, Lost };
  struct Seat {
    Expected expected;
    Join join;
    Stage stage = Stage::Awaited;
    std::int64_t step = -1;  ///< of the last accepted Motion
    bool answered = false;   ///< that Motion has its Force
    bool last = false;       ///< and it was the last one
  };
  Seat& seat(int who) { return seats_[static_cast<std::size_t>(who)]; }
  const Seat& seat(int who) const { return seats_[static_cast<std::size_t>(who)]; }
  std::string find_nearest(const std::string& layer) const;

  std::uint64_t scene_digest_;
  std::vector<Seat> seats_;
  bool recorder_;
  std::optional<std::int64_t> first_step_;
  std::string closed_;
};

/// Warns about refused messages: one line per peer and kind, and not without end.
class RefusalLog {
 public:
  void warn(const std::string& peer, const std::string& kind, const std::string& sentence);

 private:
  std::set<std::pair<std::string, std::string>> seen_;
};

}  // namespace interply::exchange
