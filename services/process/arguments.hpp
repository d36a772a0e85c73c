/// The command line of a program that `interply run` starts, and that a person may start by hand.
#pragma once

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "process/exit_codes.hpp"
#include "process/nearest.hpp"
#include "process/words.hpp"

namespace interply::process {

/// For options that hold a time: a finite number of seconds above 0.
inline CLI::Validator positive_seconds() {
  const auto check = [](const std::string& text) -> std::string {
    double seconds = 0;
    const char* end = text.data() + text.size();
    const auto [last, error] = std::from_chars(text.data(), end, seconds);
    const bool is_number = error == std::errc{} && last == end;
    return is_number && seconds > 0 && std::isfinite(seconds) ? "" : text + " is not in (0, inf) s";
  };
  return CLI::Validator(check, "SECONDS");
}

/// Reads the arguments. @return the exit code if the program has no more to do: 0 after help or version, 2 after one
/// sentence about what is wrong
inline std::optional<int> read_arguments(CLI::App& app, const std::string& version, int argc, char** argv) {
  app.set_version_flag("--version", version);
  const std::string name = std::string(argv[0]).substr(std::string(argv[0]).find_last_of('/') + 1);
  app.allow_extras();  // to name them before what is missing
  const auto refuse = [&](const std::string& sentence) {
    std::fprintf(stderr, "%s: %s (see --help)\n", name.c_str(), to_line(sentence, 300).c_str());
    return kRefused;
  };
  std::optional<std::string> wrong;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    wrong = e.what();
  }
  std::vector<std::string> options;
  for (const auto* option : app.get_options())
    for (const auto& name : option->get_lnames()) options.push_back("--" + name);
  for (const std::string& word : app.remaining()) {
    if (!word.starts_with("-")) continue;
    const std::string option = word.substr(0, word.find('=')), nearest = find_nearest(option, options);
    return refuse("there is no option " + option + (nearest.empty() ? "" : "; did you mean " + nearest + "?"));
  }
  if (!app.remaining().empty()) wrong = "takes no further argument " + app.remaining().front();
  return wrong ? std::optional(refuse(*wrong)) : std::nullopt;
}

}  // namespace interply::process
