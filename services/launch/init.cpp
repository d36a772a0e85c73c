#include "launch/init.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <ostream>
#include <string_view>

#include "launch/command_line.hpp"
#include "launch/new_file.hpp"
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
  write_new_file(file, fill_in(kTemplates[static_cast<std::size_t>(options.kind)], name), false, "give another name");
  out << fmt::format("wrote {}\n  interply check {}   what it would cost\n  interply run {}     forms it\n",
                     file.string(), file.string(), file.string());
  return kDone;
}

}  // namespace interply::launch
