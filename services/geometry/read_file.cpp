#include "geometry/read_file.hpp"

#include <filesystem>
#include <fstream>

namespace interply::geometry {

std::string read_file(const std::string& path) {
  constexpr std::uintmax_t kLargest = std::uintmax_t{1} << 30;
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw Unreadable(path + ": there is no such file");
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
