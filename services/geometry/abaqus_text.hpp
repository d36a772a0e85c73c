/// Keyword lines of Abaqus input files, and the files that they include.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/text_lines.hpp"

namespace interply::geometry {

/// A keyword line: *ELEMENT, TYPE=S4R, ELSET=blank. As in Abaqus, blanks, case and the ends of long words do not count.
struct Keyword {
  std::string name;                                             ///< lower case, without '*' and blanks, written out
  std::vector<std::pair<std::string, std::string>> parameters;  ///< keys in lower case; values without quotes
  /// The value of a parameter, given by its first three letters at least; null if it is not there.
  const std::string* find(std::string_view key) const;
};

inline bool is_comment(std::string_view line) { return line.starts_with("**"); }
inline bool is_keyword(std::string_view line) { return line.starts_with("*") && !is_comment(line); }

/// The keyword on the current line and those that continue it.
Keyword parse_keyword(Lines& lines);

/// The text of an Abaqus file with the files of *INCLUDE in their places, and those of INPUT= behind the line that
/// names them. A path starts at the file that names it, or else at `path`.
/// @param read  content of a file
/// @throws Unreadable  also if a file includes itself
Pieces follow_includes(const std::string& content, const std::string& path,
                       const std::function<std::string(const std::string& path)>& read);

}  // namespace interply::geometry
