/// A run's folder: who has it, and which files in it a run may replace.
///
/// Nothing that a person put there is ever removed or written over. A file is a run's by what is in it, wherever it was
/// copied to, and only as long as nobody has changed it.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace interply::record {

/// The folder cannot be used: one sentence with what is in the way and the cure.
class FolderRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A folder that nobody else runs in. Ends with this object, and with the process whatever ends it; a process that has
/// inherited descriptor() keeps the folder taken, too.
class FolderLock {
 public:
  /// Makes the folder if it is not there.
  /// @param purpose  what runs there, for whoever is refused
  /// @throws FolderRefused that says who has it; std::runtime_error if the folder cannot be written
  FolderLock(const std::filesystem::path& folder, const std::string& purpose);
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

/// What a run puts into its folder, beside its logs: record and sidecar, finished or not, and the resolved scene.
std::vector<std::filesystem::path> list_run_files(const std::filesystem::path& folder);

/// True for a regular file with the content of a record, a sidecar (also half of one), a log or a resolved scene of a
/// run. A link is none.
bool was_written_by_a_run(const std::filesystem::path& file);

/// @throws FolderRefused for a file that no run wrote, and for any unless `overwrite`
void check_room_for(const std::vector<std::filesystem::path>& files, bool overwrite);
/// Removes those that are there. @pre check_room_for() has passed
void make_room_for(const std::vector<std::filesystem::path>& files);

/// After everyone has left: the record says how the run ended, whoever was killed before it could, and nothing unfinished
/// stays. @pre the folder is ours   @throws std::runtime_error
void settle_record(const std::filesystem::path& folder, const std::string& status, const std::string& message);

/// Begins the log of a participant, so that it is known as a run's. @throws std::runtime_error
void begin_log(const std::filesystem::path& file, const std::string& participant);
/// The resolved scene, which runs again as it is. @throws std::runtime_error
void write_scene(const std::filesystem::path& file, const std::string& text);

}  // namespace interply::record
