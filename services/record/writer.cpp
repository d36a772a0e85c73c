#include "record/writer.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <variant>
#include <vector>

#include "record/file.hpp"
#include "record/xdmf.hpp"

namespace interply::record {
namespace {

using observe::HistoryRow;
using observe::InterfaceFrame;
using observe::LayerFrame;
using observe::LayerMesh;
using observe::RunEnd;
using observe::RunHeader;
using observe::ToolFrame;
using Pending = std::variant<LayerFrame, InterfaceFrame, ToolFrame, HistoryRow>;

std::string participant(const LayerFrame& f) { return "layer '" + f.layer + "'"; }
std::string participant(const InterfaceFrame& f) { return "interface '" + f.interface + "'"; }
std::string participant(const ToolFrame& f) { return "tool '" + f.tool + "'"; }

/// Everyone who delivers each frame, as in participant().
std::vector<std::string> list_participants(const RunHeader& header) {
  std::vector<std::string> all;
  for (const std::string& name : header.layers) all.push_back("layer '" + name + "'");
  for (const std::string& name : header.interfaces) all.push_back("interface '" + name + "'");
  for (const std::string& name : header.tools) all.push_back("tool '" + name + "'");
  return all;
}

/// Who has delivered which frame, and its time.
class Attendance {
 public:
  Attendance() = default;
  explicit Attendance(const RunHeader& header)
      : participants_(list_participants(header)), frames_(static_cast<std::size_t>(std::max(header.frames, 0)) + 1) {
    for (Frame& f : frames_) f.present.resize(participants_.size());
  }

  /// Empty if the frame is expected, else why not.
  template <typename F>
  std::string describe_problem(const F& f) const {
    if (find(participant(f)) == participants_.size()) return "not part of this run";
    if (f.frame < 0 || f.frame >= size()) return fmt::format("not in [0, {}]", size() - 1);
    const Frame& known = frames_[f.frame];
    if (known.present[find(participant(f))]) return "already recorded";
    if (known.step >= 0 && known.step != f.step) {
      return fmt::format("of step {} where the others have step {}", f.step, known.step);
    }
    return {};
  }
  template <typename F>
  void note(const F& f) {
    Frame& known = frames_[f.frame];
    known.present[find(participant(f))] = true;
    known.step = f.step;
    known.time = f.time;
  }
  bool is_complete(int frame) const {
    if (frame >= size()) return false;
    const std::vector<bool>& present = frames_[frame].present;
    return std::all_of(present.begin(), present.end(), [](bool p) { return p; });
  }
  std::string describe_missing(int frame) const {
    std::string who;
    for (std::size_t i = 0; frame < size() && i < participants_.size(); ++i) {
      if (!frames_[frame].present[i]) who += (who.empty() ? "" : ", ") + participants_[i];
    }
    return fmt::format("frame {} of {} is missing", frame, who);
  }
  double time(int frame) const { return frames_[frame].time; }
  std::int64_t step(int frame) const { return frames_[frame].step; }

 private:
  struct Frame {
    std::int64_t step = -1;
    double time = 0;
    std::vector<bool> present;
  };
  int size() const { return static_cast<int>(frames_.size()); }
  std::size_t find(const std::string& who) const {
    return std::find(participants_.begin(), participants_.end(), who) - participants_.begin();
  }
  std::vector<std::string> participants_;
  std::vector<Frame> frames_;
};

}  // namespace

struct RecordWriter::Impl {
  std::filesystem::path path, sidecar;
  mutable std::mutex mutex;
  Layout layout;  ///< what is known of it
  std::optional<RunHeader> header;
  std::optional<RunEnd> end;
  std::vector<Pending> pending;  ///< until the file exists
  std::optional<RecordFile> file;
  Attendance attendance;
  std::vector<double> times;  ///< of complete frames
  int rows = 0;
  bool full = false;  ///< a history row has been dropped
  bool closed = false;

  /// Fixes the layout of the participant that sends its first frame.
  void learn(const LayerFrame& f) {
    if (f.frame == 0) layout.layer_fields.try_emplace(f.layer, shapes_of(f.fields));
  }
  void learn(const InterfaceFrame& f) {
    if (f.frame != 0) return;
    layout.interface_fields.try_emplace(f.interface, shapes_of(f.fields));
    layout.other_fields.try_emplace(f.interface, shapes_of(f.fields_on_other));
  }
  void learn(const ToolFrame&) {}
  void learn(const HistoryRow&) {}

  bool knows_layout() const {
    if (!header) return false;
    const auto in = [](const auto& map) { return [&map](const std::string& name) { return map.contains(name); }; };
    const auto& layers = header->layers;
    const auto& interfaces = header->interfaces;
    return std::all_of(layers.begin(), layers.end(), in(layout.meshes)) &&
           std::all_of(layers.begin(), layers.end(), in(layout.layer_fields)) &&
           std::all_of(interfaces.begin(), interfaces.end(), in(layout.interface_fields)) &&
           std::all_of(header->tools.begin(), header->tools.end(), [this](const std::string& tool) {
             return std::any_of(pending.begin(), pending.end(), [&](const Pending& p) {
               const ToolFrame* f = std::get_if<ToolFrame>(&p);
               return f && f->tool == tool && f->frame == 0;
             });
           });
  }

  void create_file() {
    layout.header = *header;
    forget_strangers(layout.meshes, header->layers);
    forget_strangers(layout.layer_fields, header->layers);
    forget_strangers(layout.interface_fields, header->interfaces);
    std::erase_if(layout.other_fields, [this](const auto& i) { return !layout.interface_fields.contains(i.first); });
    std::erase_if(layout.layer_fields, [this](const auto& item) { return !layout.meshes.contains(item.first); });
    file.emplace(path, layout);
    attendance = Attendance(*header);
    write_sidecar();
    for (const Pending& p : std::exchange(pending, {})) {
      std::visit([this](const auto& value) { store(value); }, p);
    }
    if (end) file->write_end(end->status, end->message, end->digest);
  }

  template <typename Value>
  static void forget_strangers(std::map<std::string, Value>& map, const std::vector<std::string>& names) {
    std::erase_if(map, [&](const auto& item) {
      const bool stranger = std::find(names.begin(), names.end(), item.first) == names.end();
      if (stranger) spdlog::warn("record: '{}' is not part of this run and left out", item.first);
      return stranger;
    });
  }

  template <typename F>
  void store(const F& f) {
    std::string problem = attendance.describe_problem(f);
    if constexpr (!std::is_same_v<F, ToolFrame>) {
      if (problem.empty()) problem = file->describe_mismatch(f);
    }
    if (!problem.empty()) {
      spdlog::warn("record: frame {} of {} is left out: {}", f.frame, participant(f), problem);
      return;
    }
    file->write(f);
    attendance.note(f);
    complete_frames();
  }

  void store(const HistoryRow& row) {
    if (rows < header->history_capacity) {
      file->write(row, rows++);
    } else if (!std::exchange(full, true)) {
      spdlog::warn("record: history is full with {} rows; later rows are left out", rows);
    }
  }

  void complete_frames() {
    const std::size_t before = times.size();
    while (attendance.is_complete(static_cast<int>(times.size()))) {
      const int frame = static_cast<int>(times.size());
      file->complete_frame(frame, attendance.time(frame), attendance.step(frame));
      times.push_back(attendance.time(frame));
    }
    if (times.size() > before) write_sidecar();
  }

  void write_sidecar() const { write_xdmf(sidecar, path.filename().string(), layout, times); }

  template <typename T>
  void take(const T& value) {
    const std::lock_guard lock(mutex);
    if (closed) return;
    if (file) {
      store(value);
      return;
    }
    learn(value);
    pending.emplace_back(value);
    if (knows_layout()) create_file();
  }

  int expected_frames() const { return end ? std::min(end->frames_complete, header ? header->frames + 1 : 0) : 0; }

  void close() {
    const std::lock_guard lock(mutex);
    if (std::exchange(closed, true)) return;
    if (!header) {
      spdlog::warn("record: no run header has arrived, so nothing is written to {}", path.string());
      return;
    }
    if (!end) end = RunEnd{"interrupted", "The recorder was closed before the run ended.", "", 0};
    if (!file) create_file();
    file->write_end(end->status, end->message, end->digest);
    file.reset();
  }
};

RecordWriter::RecordWriter(const std::filesystem::path& file, bool overwrite) : impl_(std::make_unique<Impl>()) {
  impl_->path = file;
  impl_->sidecar = std::filesystem::path(file).replace_extension(".xdmf");
  if (std::filesystem::exists(file) && !overwrite) {
    throw std::runtime_error(fmt::format(
        "{} exists already: choose another folder or allow it to be overwritten (--overwrite)", file.string()));
  }
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  std::filesystem::remove(file);
  std::filesystem::remove(impl_->sidecar);
}

RecordWriter::~RecordWriter() {
  try {
    close();
  } catch (const std::exception& e) {
    spdlog::error("record: {}", e.what());
  }
}

void RecordWriter::put(const RunHeader& header) {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->header || impl_->closed) return;
  impl_->header = header;
  if (impl_->knows_layout()) impl_->create_file();
}

void RecordWriter::put(const LayerMesh& mesh) {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->file || impl_->closed) return;
  impl_->layout.meshes.try_emplace(mesh.layer, mesh);
  if (impl_->knows_layout()) impl_->create_file();
}

void RecordWriter::put(const LayerFrame& frame) { impl_->take(frame); }
void RecordWriter::put(const InterfaceFrame& frame) { impl_->take(frame); }
void RecordWriter::put(const ToolFrame& frame) { impl_->take(frame); }
void RecordWriter::put(const HistoryRow& row) { impl_->take(row); }

void RecordWriter::put(const RunEnd& end) {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->end || impl_->closed) return;
  impl_->end = end;
  if (impl_->file) impl_->file->write_end(end.status, end.message, end.digest);
}

bool RecordWriter::flush(double) { return true; }

bool RecordWriter::has_header() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->header.has_value();
}

bool RecordWriter::has_end() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->end.has_value();
}

bool RecordWriter::is_complete() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->header && impl_->end && static_cast<int>(impl_->times.size()) >= impl_->expected_frames();
}

int RecordWriter::frames_complete() const {
  const std::lock_guard lock(impl_->mutex);
  return static_cast<int>(impl_->times.size());
}

std::string RecordWriter::describe_missing() const {
  const std::lock_guard lock(impl_->mutex);
  if (!impl_->header) return "the run's header is missing";
  if (!impl_->end) return "the message that the run has ended is missing";
  const int frame = static_cast<int>(impl_->times.size());
  if (frame >= impl_->expected_frames()) return {};
  if (impl_->file) return impl_->attendance.describe_missing(frame);
  Attendance early(*impl_->header);
  std::string meshes;
  for (const std::string& layer : impl_->header->layers) {
    if (!impl_->layout.meshes.contains(layer)) meshes += (meshes.empty() ? "" : ", ") + layer;
  }
  if (!meshes.empty()) return fmt::format("the mesh of {} is missing", meshes);
  for (const Pending& p : impl_->pending) {
    std::visit(
        [&]<typename T>(const T& f) {
          if constexpr (!std::is_same_v<T, HistoryRow>) {
            if (early.describe_problem(f).empty()) early.note(f);
          }
        },
        p);
  }
  return early.describe_missing(0);
}

void RecordWriter::close() { impl_->close(); }

}  // namespace interply::record
