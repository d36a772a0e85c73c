/// Whether the disk has room, and what to say if it has not. Internal to record and launch.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>

namespace interply::record {

/// Bytes that may still be written where `path` is, or will be once its folders are made; nothing if the system does
/// not say.
std::optional<std::uint64_t> find_free_space(const std::filesystem::path& path);

/// True for what a full disk, a quota or a limit on the size of files says.
bool means_full(const std::error_code& error);

/// One sentence: "cannot write FILE: No space left on device; the record takes 212 MiB in all and 3 MiB are free there:
/// ..." @param needed  by the whole record, bytes
std::string describe_full_disk(const std::filesystem::path& file, const std::error_code& error, std::uint64_t needed);

}  // namespace interply::record
