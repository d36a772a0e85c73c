#include "record/disk.hpp"

#include <spdlog/fmt/fmt.h>

#include <cerrno>

namespace interply::record {

namespace fs = std::filesystem;

std::optional<std::uint64_t> find_free_space(const fs::path& path) {
  std::error_code error;
  fs::path there = fs::absolute(path, error);
  while (!fs::exists(there, error) && there.has_relative_path()) there = there.parent_path();
  const fs::space_info space = fs::space(there, error);
  if (error || space.capacity == 0) return std::nullopt;
  return space.available;
}

bool means_full(const std::error_code& error) {
  return error == std::errc::no_space_on_device || error == std::errc::file_too_large ||
         error == std::error_code(EDQUOT, std::generic_category());
}

std::string describe_full_disk(const fs::path& file, const std::error_code& error, std::uint64_t needed) {
  constexpr double kMebibyte = 1 << 20;
  const auto free = find_free_space(file);
  return fmt::format("cannot write {}: {}; the record takes {:.1f} MiB in all{}: {}", file.string(), error.message(),
                     static_cast<double>(needed) / kMebibyte,
                     free ? fmt::format(" and {:.1f} MiB are free there", static_cast<double>(*free) / kMebibyte) : "",
                     "ask for fewer frames (record.frames), or give another folder (--out)");
}

}  // namespace interply::record
