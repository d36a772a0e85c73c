/// The words of the `interply` command.
#pragma once

#include <string>
#include <vector>

namespace interply::launch {

/// The candidate that takes the fewest insertions, deletions and replacements of a letter to become `word`; empty if
/// there are none.
std::string find_nearest_name(const std::string& word, const std::vector<std::string>& candidates);

/// Parses and runs `interply run | check | point | bench`. Returns the exit code; never throws.
int run_command_line(int argc, char** argv);

}  // namespace interply::launch
