#include "launch/new_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "launch/command_line.hpp"

namespace interply::launch {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse(const fs::path& file, const std::string& cure) {
  throw BadArgument(fmt::format("{} is there already and stays as it is; {}", file.string(), cure));
}

bool is_device_or_pipe(const fs::path& file) {
  const auto status = fs::status(file);
  return fs::exists(status) && !fs::is_regular_file(status);
}

}  // namespace

void check_is_new(const fs::path& file, const std::string& cure) {
  if (fs::exists(fs::symlink_status(file)) && !is_device_or_pipe(file)) refuse(file, cure);
}

void write_new_file(const fs::path& file, const std::string& text, bool overwrite, const std::string& cure) {
  const int how = is_device_or_pipe(file) ? 0 : O_CREAT | (overwrite ? O_TRUNC : O_EXCL);
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CLOEXEC | how, 0644);
  if (descriptor < 0 && errno == EEXIST) refuse(file, cure);
  std::size_t written = 0;
  while (descriptor >= 0 && written < text.size()) {
    const ssize_t n = ::write(descriptor, text.data() + written, text.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    written += static_cast<std::size_t>(n);
  }
  const int error = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (descriptor < 0 || written < text.size())
    throw std::runtime_error(fmt::format("cannot write {}: {}", file.string(), std::strerror(error)));
}

}  // namespace interply::launch
