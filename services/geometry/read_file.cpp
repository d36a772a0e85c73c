#include "geometry/read_file.hpp"

#include <filesystem>
#include <fstream>
#include <vector>

#include "process/nearest.hpp"

namespace interply::geometry {
namespace {

/// "; did you mean 'punch.stl'?" if the folder holds a file with a name near to the one that is missing, else nothing.
std::string suggest_neighbour(const std::filesystem::path& missing) {
  std::vector<std::string> names;
  std::error_code error;
  const auto folder = missing.has_parent_path() ? missing.parent_path() : ".";
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (entry->path().extension() == missing.extension()) names.push_back(entry->path().stem().string());
  const std::string nearest = process::find_nearest(missing.stem().string(), names);
  return nearest.empty() ? "" : "; did you mean '" + nearest + missing.extension().string() + "'?";
}

}  // namespace

std::string read_file(const std::string& path) {
  constexpr std::uintmax_t kLargest = std::uintmax_t{1} << 30;
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw Unreadable(path + ": there is no such file" + suggest_neighbour(path));
  if (!std::filesystem::is_regular_file(status)) throw Unreadable(path + ": is not a regular file");
  const auto size = std::filesystem::file_size(path, error);
  if (error) throw Unreadable(path + ": " + error.message());
  if (size > kLargest) throw Unreadable(path + ": is larger than 1 GiB");
  std::string text(size, '\0');
  std::ifstream in(path, std::ios::binary);
  if (!in.read(text.data(), static_cast<std::streamsize>(size))) throw Unreadable(path + ": cannot be read");
  return text;
}

}  // namespace interply::geometry
