#include "exchange/admission.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "process/words.hpp"

namespace interply::exchange {

namespace {

constexpr std::size_t kLines = 200;  ///< refusals that are logged in one run

/// What a peer wrote, fit for a log line: short and printable.
std::string quote(const std::string& text) { return '"' + process::to_line(text, 64) + '"'; }

}  // namespace

std::string describe(const Join& join) {
  return fmt::format("{} (process {} on {})", join.layer, join.pid, join.host.empty() ? "this host" : join.host);
}

Admission::Admission(std::uint64_t scene_digest, std::vector<Expected> expected, bool recorder)
    : scene_digest_(scene_digest), recorder_(recorder) {
  if (recorder) expected.push_back({.layer = kRecorder, .kind = kRecorder});
  for (Expected& e : expected) {
    seats_.emplace_back();
    seats_.back().expected = std::move(e);
  }
}

std::int64_t Admission::largest_layer() const {
  std::int64_t largest = 0;
  for (const Seat& s : seats_) largest = std::max(largest, s.expected.n_nodes);
  return largest;
}

std::int64_t Admission::largest_sample() const {
  std::int64_t largest = 0;
  for (const Seat& s : seats_) largest = std::max(largest, s.expected.largest_sample);
  return largest;
}

std::string Admission::find_nearest(const std::string& layer) const {
  const auto nearest =
      std::min_element(seats_.begin(), seats_.begin() + n_layers(), [&](const Seat& a, const Seat& b) {
        return process::count_edits(layer, a.expected.layer) < process::count_edits(layer, b.expected.layer);
      });
  return n_layers() == 0 ? "" : nearest->expected.layer;
}

Admission::Verdict Admission::judge(const Join& join) {
  const bool records = join.kind == kRecorder;
  const auto refuse = [&](const std::string& why) {
    const std::string name = records ? "the recorder" : "layer " + quote(join.layer);
    return Verdict{-1, fmt::format("{} may not join: {}", name, why)};
  };
  if (join.version != kVersion)
    return refuse(fmt::format("it runs interply {}, the coordinator {}: start all processes from one build",
                              quote(join.version), kVersion));
  if (join.layer.size() > 256) return refuse("its name is longer than 256 characters");
  if (records && !recorder_)
    return refuse("this run keeps no record; set record.frames and leave --no-record out for one");
  const auto layers_end = seats_.begin() + n_layers();
  const auto found = records ? layers_end : std::find_if(seats_.begin(), layers_end, [&](const Seat& s) {
    return s.expected.layer == join.layer;
  });
  if (!records && found == layers_end)
    return refuse(fmt::format("the scene has no such layer, the nearest is {}", quote(find_nearest(join.layer))));
  if (const std::string& kind = found->expected.kind; join.kind != kind)
    return refuse(fmt::format("it is a {} layer and this solver computes {}: start interply-solver-{} for it", kind,
                              quote(join.kind), kind));
  if (join.scene_digest != 0 && join.scene_digest != scene_digest_)
    return refuse(
        fmt::format("its scene has digest {:016x}, the coordinator's {:016x}: give all processes the same "
                    "scene and overrides",
                    join.scene_digest, scene_digest_));
  if (found->stage != Stage::Awaited) return refuse(fmt::format("it has joined before as {}", describe(found->join)));
  if (!closed_.empty()) return refuse(fmt::format("the run is stopping: {}", closed_));
  found->join = join;
  found->join.layer = found->expected.layer;
  found->join.host = process::to_line(join.host, 64);
  found->stage = Stage::Active;
  return {static_cast<int>(found - seats_.begin()), ""};
}

std::string Admission::judge_motion(int who, std::int64_t step, std::int64_t n_nodes, std::int64_t n_thickness) {
  Seat& s = seat(who);
  if (who == recorder()) return "sent a motion, which is a layer's to send";
  if (s.stage != Stage::Active || s.last) return fmt::format("sent a motion of step {} after its end", step);
  if (s.step >= 0 && !s.answered)
    return fmt::format("sent a motion of step {} while its step {} is not answered", step, s.step);
  const std::int64_t wanted = s.step >= 0 ? s.step + 1 : first_step_.value_or(step);
  if (step != wanted || step < 0)
    return fmt::format("sent a motion of step {}, expected was step {}", step, std::max<std::int64_t>(wanted, 0));
  if (n_nodes != s.expected.n_nodes || (n_thickness != 0 && n_thickness != n_nodes))
    return fmt::format("sent a motion of {} nodes and {} thicknesses, the scene gives it {} nodes", n_nodes,
                       n_thickness, s.expected.n_nodes);
  first_step_ = first_step_.value_or(step);
  s.step = step;
  s.answered = false;
  return {};
}

std::string Admission::judge_final(int who) {
  Seat& s = seat(who);
  if (s.stage != Stage::Active) return "sent a final message after its end";
  if (!s.last) return fmt::format("sent a final message before the last step, at step {}", s.step);
  s.stage = Stage::Ended;
  return {};
}

std::string Admission::judge_failure(int who) {
  if (seat(who).stage != Stage::Active) return "sent a failure after its end";
  seat(who).stage = Stage::Failed;
  return {};
}

std::string Admission::judge_sample(int who, const Sample& sample) const {
  const Seat& s = seat(who);
  if (s.stage != Stage::Active || !recorder_ || who == recorder()) return "sent a sample that nobody waits for";
  if (sample.layer != s.expected.layer) return fmt::format("sent a sample of layer {}", quote(sample.layer));
  if (static_cast<std::int64_t>(sample.payload.size()) > s.expected.largest_sample)
    return fmt::format("sent a sample of {} bytes, more than the {} that the scene gives it", sample.payload.size(),
                       s.expected.largest_sample);
  return {};
}

std::string Admission::judge_recorded(int who, bool closed) {
  if (who != recorder() || !is_active(who)) return "sent a message that only a recorder sends";
  if (closed) seat(who).stage = Stage::Ended;
  return {};
}

bool Admission::note_answer(int who, const Force& force) {
  Seat& s = seat(who);
  if (s.stage != Stage::Active) return false;
  if (s.step < 0 || s.answered || force.step != s.step)
    throw std::logic_error(fmt::format("answer of step {} to {}, whose last motion is step {}{}", force.step,
                                       s.expected.layer, s.step, s.answered ? " and has its answer" : ""));
  if (force.force.cols() != s.expected.n_nodes)
    throw std::logic_error(fmt::format("answer with {} forces to {}, which has {} nodes", force.force.cols(),
                                       s.expected.layer, s.expected.n_nodes));
  s.answered = true;
  s.last = force.last;
  return true;
}

bool Admission::note_gone(int who) {
  if (!is_active(who)) return false;
  seat(who).stage = Stage::Lost;
  return closed_.empty();
}

void Admission::close(const std::string& why) { closed_ = why.empty() ? "it is over" : why; }

void RefusalLog::warn(const std::string& peer, const std::string& kind, const std::string& sentence) {
  if (seen_.size() > kLines || !seen_.emplace(peer, kind).second) return;
  spdlog::warn("{} {}; the message is refused, the run goes on", peer, sentence);
  if (seen_.size() > kLines) spdlog::warn("{} messages were refused, further ones are not reported", kLines);
}

}  // namespace interply::exchange
