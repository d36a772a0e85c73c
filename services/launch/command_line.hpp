/// The words of the `interply` command.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace interply::launch {

/// A word of the command line that cannot be: a sentence.
class BadArgument : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// "; did you mean --set?" if one of the names is near to `word` (process/nearest.hpp), else "; known: --with, --set".
std::string propose(const std::string& word, const std::vector<std::string>& names, const std::string& quote = "");

/// Parses and runs one `interply` command (`interply --help` lists them). Returns the exit code; never throws.
int run_command_line(int argc, char** argv);

}  // namespace interply::launch
