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

/// The candidate that takes the fewest insertions, deletions and replacements of a letter to become `word`; empty if
/// there are none.
std::string find_nearest_name(const std::string& word, const std::vector<std::string>& candidates);

/// Parses and runs one `interply` command (`interply --help` lists them). Returns the exit code; never throws.
int run_command_line(int argc, char** argv);

}  // namespace interply::launch
