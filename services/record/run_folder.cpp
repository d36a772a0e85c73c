#include "record/run_folder.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include "mechanics/digest.hpp"
#include "process/words.hpp"
#include "record/hdf5.hpp"

namespace interply::record {

namespace fs = std::filesystem;

namespace {

constexpr const char* kLockName = ".interply-lock";
constexpr std::string_view kLockMark = "interply: ";
constexpr std::string_view kLogMark = "# interply: log of ";
constexpr std::string_view kSceneMark = "# interply: resolved scene, digest ";
constexpr std::string_view kHdf5Mark = "\x89HDF\r\n\x1a\n";
constexpr std::string_view kSidecarMark = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Xdmf ";

[[noreturn]] void fail(const std::string& what) { throw std::system_error(errno, std::generic_category(), what); }

std::string read_start(const fs::path& file, std::size_t bytes) {
  std::ifstream stream(file, std::ios::binary);
  std::string text(bytes, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(bytes));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

std::string compute_digest(const std::string& text) {
  mechanics::Digest digest;
  digest.add(text.data(), text.size());
  return mechanics::to_hex(digest.value());
}

std::string mark_scene(const std::string& text) {
  return fmt::format("{}{}\n", kSceneMark, compute_digest(text)) + text;
}

bool is_resolved_scene(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string content(std::istreambuf_iterator<char>(stream), {});
  const std::size_t end = content.find('\n');
  return content.starts_with(kSceneMark) && end != std::string::npos && content == mark_scene(content.substr(end + 1));
}

bool is_record(const fs::path& file) {
  try {
    const Handle record = open_file(file, false);
    for (const char* known : {"scene/run", "status", "frames_complete"}) open_dataset(record, known);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

/// What a process that was killed has left of a record or a sidecar.
bool is_unfinished(const fs::path& file) {
  const std::string start = read_start(file, kSidecarMark.size());
  return start.starts_with(kHdf5Mark) || start == kSidecarMark ||
         std::all_of(start.begin(), start.end(), [](char c) { return c == '\0'; });
}

/// Opens the lock, made if it is not there; never another file of that name.
int open_lock(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (descriptor < 0) fail(fmt::format("cannot write {}", file.string()));
  return descriptor;
}

/// The file may have been removed by its last owner between open and lock.
bool is_still_there(int descriptor, const fs::path& file) {
  struct stat ours {
  }, there{};
  return ::fstat(descriptor, &ours) == 0 && ::lstat(file.c_str(), &there) == 0 && ours.st_dev == there.st_dev &&
         ours.st_ino == there.st_ino;
}

std::string describe_owner(const std::string& purpose) {
  return fmt::format("{}{}, process {} on {} since {:%F %T}", kLockMark, purpose, ::getpid(), process::host_name(),
                     fmt::localtime(std::time(nullptr)));
}

/// Who has the lock; a moment ago it may have been nobody's and not say yet.
std::string read_owner(const fs::path& lock) {
  for (int i = 0; i < 20; ++i) {
    if (const std::string said = read_start(lock, 1024); said.starts_with(kLockMark))
      return process::to_line(said.substr(kLockMark.size()));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return "another process";
}

}  // namespace

FolderLock::FolderLock(const fs::path& folder, const std::string& purpose) : file_(folder / kLockName) {
  for (fs::path part; const fs::path& name : folder)
    if (part /= name; fs::exists(part) && !fs::is_directory(part))
      throw FolderRefused(fmt::format("{} is a file, not a folder, and stays: choose another --out", part.string()));
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw std::runtime_error(
        fmt::format("cannot make the folder {}: {}; choose another --out", folder.string(), error.message()));
  for (;;) {
    descriptor_ = open_lock(file_);
    const std::string said = read_start(file_, 1024);
    const bool is_ours = said.empty() || said.starts_with(kLockMark);
    const bool taken = is_ours && ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
    if (taken && is_still_there(descriptor_, file_)) break;
    const int error = errno;
    ::close(std::exchange(descriptor_, -1));
    if (!is_ours) throw FolderRefused(fmt::format("{} is in the way and stays: move it away", file_.string()));
    if (taken || error == EINTR) continue;
    if (error != EWOULDBLOCK) {
      errno = error;
      fail(fmt::format("cannot lock {}", file_.string()));
    }
    throw FolderRefused(fmt::format("{} is taken by another run ({}): choose another --out, or wait for its end",
                                    folder.string(), read_owner(file_)));
  }
  const std::string owner = describe_owner(purpose);
  if (::ftruncate(descriptor_, 0) != 0 ||
      ::write(descriptor_, owner.data(), owner.size()) != static_cast<ssize_t>(owner.size()))
    fail(fmt::format("cannot write {}", file_.string()));
}

FolderLock::FolderLock(FolderLock&& other) noexcept
    : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

FolderLock::~FolderLock() {
  if (descriptor_ < 0) return;
  ::unlink(file_.c_str());
  ::close(descriptor_);
}

std::vector<fs::path> list_run_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const char* name :
       {"record.h5", "record.xdmf", "record.h5.partial", "record.xdmf.partial", "summary.json", "scene.yaml"})
    files.push_back(folder / name);
  return files;
}

bool was_written_by_a_run(const fs::path& file) {
  if (!fs::is_regular_file(fs::symlink_status(file))) return false;
  const std::string kind = file.extension();
  if (kind == ".h5") return is_record(file);
  if (kind == ".partial") return is_unfinished(file);
  if (kind == ".xdmf") return read_start(file, kSidecarMark.size()) == kSidecarMark;
  if (kind == ".log") return read_start(file, kLogMark.size()) == kLogMark;
  if (kind == ".json") return read_start(file, 200).find("\"interply\"") != std::string::npos;
  return is_resolved_scene(file);
}

void check_room_for(const std::vector<fs::path>& files, bool overwrite) {
  const auto is_there = [](const fs::path& file) { return fs::exists(fs::symlink_status(file)); };
  for (const fs::path& file : files)
    if (is_there(file) && !was_written_by_a_run(file))
      throw FolderRefused(fmt::format(
          "{} is in the way: no run wrote it, or it was changed since; choose another --out, or move it away",
          file.string()));
  const auto first = std::find_if(files.begin(), files.end(), is_there);
  if (first != files.end() && !overwrite)
    throw FolderRefused(
        fmt::format("{} is there from an earlier run: choose another --out, or say --overwrite", first->string()));
}

void make_room_for(const std::vector<fs::path>& files) {
  for (const fs::path& file : files) fs::remove(file);
}

void settle_record(const fs::path& folder, const std::string& status, const std::string& message) {
  for (const char* half : {"record.h5.partial", "record.xdmf.partial"}) fs::remove(folder / half);
  const fs::path record = folder / "record.h5";
  if (!is_record(record)) return;
  const Handle file = open_file(record, true);
  const Handle known = open_dataset(file, "status");
  if (read_text(known).front() == status) return;
  write_text(known, {status});
  write_text(open_dataset(file, "message"), {message.substr(0, message.find('\n'))});
  write_text(open_dataset(file, "digest"), {""});
  flush(file);
}

void begin_log(const fs::path& file, const std::string& participant) {
  std::ofstream log(file);
  log << kLogMark << participant << '\n' << std::flush;
  if (!log) fail(fmt::format("cannot write {}", file.string()));
}

void write_scene(const fs::path& file, const std::string& text) {
  std::ofstream scene(file);
  scene << mark_scene(text) << std::flush;
  if (!scene) fail(fmt::format("cannot write {}", file.string()));
}

}  // namespace interply::record
