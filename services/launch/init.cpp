#include "launch/init.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <ostream>
#include <stdexcept>
#include <string_view>

#include "launch/command_line.hpp"
#include "launch/run.hpp"

namespace interply::launch {

extern const std::array<std::string_view, 3> kTemplates;  // by SceneKind

namespace {

std::string fill_in(std::string_view text, const std::string& name) {
  constexpr std::string_view kBlank = "NAME";
  std::string filled(text);
  for (std::size_t at = 0; (at = filled.find(kBlank, at)) != filled.npos; at += name.size())
    filled.replace(at, kBlank.size(), name);
  return filled;
}

/// @throws BadArgument if there is such a file
void write_new_file(const std::filesystem::path& file, const std::string& text) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor < 0 && errno == EEXIST)
    throw BadArgument(fmt::format("{} is there already and stays as it is; give another name", file.string()));
  const bool written =
      descriptor >= 0 && ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  const int error = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (!written) throw std::runtime_error(fmt::format("cannot write {}: {}", file.string(), std::strerror(error)));
}

}  // namespace

int init_command(const InitOptions& options, std::ostream& out) {
  std::filesystem::path file = options.name;
  if (file.extension() == ".yaml") file.replace_extension();
  const std::string name = file.filename().string();
  const bool plain =
      std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; });
  if (name.empty() || !plain)
    throw BadArgument(fmt::format("\"{}\" cannot name a scene; use letters, digits, '_' and '-'", options.name));
  file += ".yaml";
  write_new_file(file, fill_in(kTemplates[static_cast<std::size_t>(options.kind)], name));
  out << fmt::format("wrote {}\n  interply check {}   what it would cost\n  interply run {}     forms it\n",
                     file.string(), file.string(), file.string());
  return kDone;
}

}  // namespace interply::launch
