#include "record/writer.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <mutex>
#include <optional>
#include <system_error>
#include <variant>
#include <vector>

#include "record/disk.hpp"
#include "record/file.hpp"
#include "record/run_folder.hpp"
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
using Pending = std::variant<LayerFrame, InterfaceFrame, ToolFrame>;

constexpr std::size_t kBlock = 100;  ///< history rows that are written together

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
      : participants_(list_participants(header)), frames_(static_cast<std::size_t>(std::max(header.frames, 0)) + 1) {}

  /// @throws Misfit unless the frame is expected
  template <typename F>
  void check(const F& f) const {
    const auto refuse = [&](const std::string& why) {
      throw Misfit(fmt::format("frame {} of {} does not fit: {}", f.frame, participant(f), why));
    };
    const std::size_t at = find(participant(f));
    if (at == participants_.size()) refuse("not part of this run");
    if (f.frame < 0 || f.frame >= size()) refuse(fmt::format("not in [0, {}]", size() - 1));
    const Frame& known = frames_[static_cast<std::size_t>(f.frame)];
    if (!known.present.empty() && known.present[at]) refuse("already recorded");
    if (known.step >= 0 && known.step != f.step)
      refuse(fmt::format("of step {} where the others have step {}", f.step, known.step));
  }
  template <typename F>
  void note(const F& f) {
    Frame& known = frames_[static_cast<std::size_t>(f.frame)];
    known.present.resize(participants_.size());
    known.present[find(participant(f))] = true;
    known.step = f.step;
    known.time = f.time;
  }
  bool is_complete(int frame) const {
    if (frame >= size()) return false;
    const std::vector<bool>& present = frames_[static_cast<std::size_t>(frame)].present;
    return !present.empty() && std::find(present.begin(), present.end(), false) == present.end();
  }
  std::string describe_missing(int frame) const {
    std::string who;
    for (std::size_t i = 0; frame < size() && i < participants_.size(); ++i) {
      const std::vector<bool>& present = frames_[static_cast<std::size_t>(frame)].present;
      if (present.empty() || !present[i]) who += (who.empty() ? "" : ", ") + participants_[i];
    }
    return fmt::format("frame {} of {} is missing", frame, who);
  }
  double time(int frame) const { return frames_[static_cast<std::size_t>(frame)].time; }
  std::int64_t step(int frame) const { return frames_[static_cast<std::size_t>(frame)].step; }

 private:
  struct Frame {
    std::int64_t step = -1;
    double time = 0;
    std::vector<bool> present;  ///< empty: nobody
  };
  int size() const { return static_cast<int>(frames_.size()); }
  std::size_t find(const std::string& who) const {
    return static_cast<std::size_t>(std::find(participants_.begin(), participants_.end(), who) -
                                    participants_.begin());
  }
  std::vector<std::string> participants_;
  std::vector<Frame> frames_;
};

void check_mesh(const RunHeader& header, const LayerMesh& mesh) {
  const auto found = std::find(header.layers.begin(), header.layers.end(), mesh.layer);
  if (found == header.layers.end()) throw Misfit(fmt::format("the mesh of '{}' is not part of this run", mesh.layer));
  const auto which = static_cast<std::size_t>(found - header.layers.begin());
  const bool fits = header.nodes.empty() || (mesh.reference.cols() == header.nodes.at(which) &&
                                             mesh.triangles.cols() == header.elements.at(which));
  if (!fits)
    throw Misfit(fmt::format("the mesh of layer '{}' has {} nodes and {} elements, the scene gives it {} and {}",
                             mesh.layer, mesh.reference.cols(), mesh.triangles.cols(), header.nodes[which],
                             header.elements[which]));
  if (mesh.triangles.size() > 0 &&
      (mesh.triangles.minCoeff() < 0 || mesh.triangles.maxCoeff() >= mesh.reference.cols()))
    throw Misfit(fmt::format("the mesh of layer '{}' has corners that are none of its {} nodes", mesh.layer,
                             mesh.reference.cols()));
}

void write_text_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::trunc);
  file << text;
  file.close();
  if (!file) throw std::system_error(errno, std::generic_category(), fmt::format("cannot write {}", path.string()));
}

}  // namespace

struct RecordWriter::Impl {
  std::filesystem::path path;
  mutable std::mutex mutex;
  Layout layout;  ///< what is known of it
  std::optional<RunHeader> header;
  std::optional<RunEnd> end;
  std::vector<Pending> pending;  ///< until the file exists
  std::optional<RecordFile> file;
  std::optional<Sidecar> sidecar;
  Attendance attendance;
  std::map<int, std::map<std::string, double>> tool_positions;  ///< of frames that are not shown yet, mm
  int frames = 0;                ///< complete and in the file
  std::vector<HistoryRow> rows;  ///< that wait to be written
  int rows_written = 0;
  std::int64_t rows_left_out = 0;
  bool closed = false;

  std::filesystem::path beside(const std::string& name) const { return path.parent_path() / name; }
  std::filesystem::path sidecar_path() const { return std::filesystem::path(path).replace_extension(".xdmf"); }

  /// Everything that is replaced.
  std::vector<std::filesystem::path> list_files() const {
    std::vector<std::filesystem::path> files{beside("summary.json")};
    for (const auto& whole : {path, sidecar_path()})
      for (const char* half : {"", ".partial"}) files.push_back(whole.string() + half);
    return files;
  }

  void begin(const RunHeader& h) {
    header = h;
    layout.header = h;
    attendance = Attendance(h);
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
    make_room_for(list_files());
    if (!std::filesystem::exists(beside("scene.yaml"))) write_scene(beside("scene.yaml"), h.scene_text);
  }

  /// Fixes the layout of the participant that sends its first frame.
  void learn(const LayerFrame& f) {
    if (!layout.meshes.contains(f.layer)) throw Misfit(fmt::format("layer '{}' has sent no mesh", f.layer));
    const std::vector<FieldShape> fields = shapes_of(f.fields);
    check_fields(f.layer, layout.meshes.at(f.layer), fields);
    layout.layer_fields.try_emplace(f.layer, fields);
  }
  void learn(const InterfaceFrame& f) {
    layout.interface_fields.try_emplace(f.interface, shapes_of(f.fields));
    layout.other_fields.try_emplace(f.interface, shapes_of(f.fields_on_other));
  }
  void learn(const ToolFrame&) {}

  void create_file() {
    file.emplace(path, layout);
    sidecar.emplace(sidecar_path(), path.filename().string(), layout);
    for (const Pending& p : std::exchange(pending, {})) {
      std::visit([this](const auto& value) { store(value); }, p);
    }
  }

  template <typename F>
  void store(const F& f) {
    if constexpr (!std::is_same_v<F, ToolFrame>) {
      if (const std::string problem = file->describe_mismatch(f); !problem.empty())
        throw Misfit(fmt::format("frame {} of {} does not fit: {}", f.frame, participant(f), problem));
    }
    file->write(f);
  }

  template <typename F>
  void take(const F& f) {
    const std::lock_guard lock(mutex);
    if (closed) return;
    check_begun();
    attendance.check(f);
    if (f.frame == 0) learn(f);
    attendance.note(f);
    if constexpr (std::is_same_v<F, ToolFrame>) tool_positions[f.frame][f.tool] = f.position;
    if (file) {
      store(f);
    } else {
      pending.emplace_back(f);
      if (attendance.is_complete(0)) create_file();
    }
    complete_frames();
  }

  void take(const HistoryRow& row) {
    const std::lock_guard lock(mutex);
    if (closed) return;
    check_begun();
    if (rows_written + static_cast<int>(rows.size()) < header->history_capacity)
      rows.push_back(row);
    else if (rows_left_out++ == 0)
      spdlog::warn("record: history is full with {} rows; later rows are left out", header->history_capacity);
    if (rows.size() >= kBlock) write_rows();
  }

  /// Anything that writes. What a full disk says becomes a sentence with the room that the record needs.
  template <typename Action>
  void write(Action&& action) try {
    action();
  } catch (const std::system_error& error) {
    if (!means_full(error.code())) throw;
    throw std::runtime_error(describe_full_disk(path, error.code(), measure_record(layout)));
  }

  void check_begun() const {
    if (!header) throw Misfit("something came before the header of the run");
  }

  void complete_frames() {
    if (!file || !attendance.is_complete(frames)) return;
    write_rows();
    for (; attendance.is_complete(frames); ++frames) {
      file->complete_frame(frames, attendance.time(frames), attendance.step(frames));
      sidecar->show(frames, attendance.time(frames), tool_positions[frames]);
      tool_positions.erase(frames);
    }
  }

  void write_rows() {
    if (!file || rows.empty()) return;
    file->write(rows, rows_written);
    rows_written += static_cast<int>(rows.size());
    rows.clear();
  }

  int expected_frames() const { return end ? std::min(end->frames_complete, header ? header->frames + 1 : 0) : 0; }

  std::string describe_missing() const {
    if (!header) return "the run's header is missing";
    if (!end) return "the message that the run has ended is missing";
    return frames >= expected_frames() ? std::string() : attendance.describe_missing(frames);
  }

  void close() {
    const std::lock_guard lock(mutex);
    if (std::exchange(closed, true)) return;
    if (!header) {
      spdlog::warn("record: no run header has arrived, so nothing is written to {}", path.string());
      return;
    }
    if (!end) end = RunEnd{"interrupted", "The recorder was closed before the run ended.", "", 0};
    if (const std::string missing = describe_missing(); end->status == "done" && !missing.empty())
      end = RunEnd{"lost", missing, "", frames};
    if (!file) create_file();
    write_rows();
    if (!end->summary.empty()) write_text_file(beside("summary.json"), end->summary);
    file->write_end(end->status, end->message, end->digest);
    sidecar.reset();
    file.reset();
  }
};

RecordWriter::RecordWriter(const std::filesystem::path& file, bool overwrite) : impl_(std::make_unique<Impl>()) {
  impl_->path = file;
  check_room_for(impl_->list_files(), overwrite);
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
  if (impl_->header) throw Misfit("a second header of the run came");
  impl_->write([&] { impl_->begin(header); });
}

void RecordWriter::put(const LayerMesh& mesh) {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->closed) return;
  impl_->check_begun();
  check_mesh(*impl_->header, mesh);
  if (!impl_->layout.meshes.try_emplace(mesh.layer, mesh).second)
    throw Misfit(fmt::format("a second mesh of layer '{}' came", mesh.layer));
}

void RecordWriter::put(const LayerFrame& frame) {
  impl_->write([&] { impl_->take(frame); });
}
void RecordWriter::put(const InterfaceFrame& frame) {
  impl_->write([&] { impl_->take(frame); });
}
void RecordWriter::put(const ToolFrame& frame) {
  impl_->write([&] { impl_->take(frame); });
}
void RecordWriter::put(const HistoryRow& row) {
  impl_->write([&] { impl_->take(row); });
}

void RecordWriter::put(const RunEnd& end) {
  const std::lock_guard lock(impl_->mutex);
  if (!impl_->end && !impl_->closed) impl_->end = end;
}

bool RecordWriter::flush(double) {
  const std::lock_guard lock(impl_->mutex);
  impl_->write([&] { impl_->write_rows(); });
  return true;
}

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
  return impl_->describe_missing().empty();
}

int RecordWriter::frames_complete() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->frames;
}

std::int64_t RecordWriter::rows_settled() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->rows_written + impl_->rows_left_out;
}

std::string RecordWriter::describe_missing() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->describe_missing();
}

void RecordWriter::close() {
  impl_->write([&] { impl_->close(); });
}

}  // namespace interply::record
