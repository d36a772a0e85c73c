/// Words for a person: text from outside on its way to a terminal, a log or a reader of lines, and what is near to it.
#pragma once

#include <string>
#include <string_view>

namespace interply::process {

/// One printable line: control characters (newlines, escapes, those of Latin-1 in UTF-8) and bytes that are no UTF-8
/// are written as \x1b. Anything longer than `most` bytes is cut and ends in "...".
std::string to_line(std::string_view text, std::size_t most = std::string_view::npos);

/// Insertions, deletions, substitutions and exchanges of neighbouring characters that make one of the other.
std::size_t count_edits(std::string_view a, std::string_view b);

/// Of this machine, as it calls itself.
std::string host_name();

}  // namespace interply::process
