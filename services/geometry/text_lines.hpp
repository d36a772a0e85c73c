/// Text files line by line, with errors that say where.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace interply::geometry {

/// The text of a file as editors save it: without the byte order mark of UTF-8 before it.
/// @throws Unreadable  if it is UTF-16
std::string_view open_text(std::string_view content, const std::string& origin);

/// Lines of a file that belong together.
struct Piece {
  std::string origin;           ///< path of the file
  std::int64_t first_line = 1;  ///< number of the first line of `text` in the file
  std::string text;
};
/// A file with those that it includes, in the order in which their lines are read; the first piece is the file's own.
using Pieces = std::vector<Piece>;

/// A line of a file.
struct Place {
  int piece = 0;  ///< index in Pieces
  std::int64_t line = 0;
};

/// The lines of a text that outlives this object; line ends LF, CR LF or CR.
class Lines {
 public:
  Lines(std::string_view text, const std::string& origin) : text_(text), rest_(text), origin_(&origin) {}
  explicit Lines(const Pieces& pieces);

  /// Goes to the next line. False at the end of the text.
  bool next();
  std::string_view line() const { return line_; }  ///< without blanks at its ends
  std::int64_t number() const { return number_; }  ///< of the line in its file, from 1
  Place place() const { return {piece_, number_}; }
  std::size_t offset() const { return text_.size() - rest_.size(); }  ///< of the line after this one, of one text
  const std::string& origin() const { return *origin_; }              ///< path of the line's file

  /// @throws Unreadable  "part.msh:12: sentence"
  [[noreturn]] void refuse(const std::string& sentence) const;

 private:
  std::string_view text_, rest_, line_;
  const std::string* origin_;
  const Pieces* pieces_ = nullptr;
  int piece_ = 0;
  std::int64_t number_ = 0;
};

/// The values of one line from left to right, separated by blanks (separator ' ') or by commas.
class Fields {
 public:
  Fields(const Lines& lines, std::string_view text, char separator)
      : lines_(lines), rest_(text), separator_(separator) {}
  Fields(const Lines& lines, char separator) : Fields(lines, lines.line(), separator) {}

  bool empty() const;       ///< nothing but blanks is left
  std::string_view next();  ///< the next value, without blanks around it; empty if there is none
  std::string_view rest() const { return rest_; }  ///< what has not been read
  void go_on_with(std::string_view text) { rest_ = text; }

  /// The next value as a whole number in [-2^63, 2^63), or as a finite number. @param what it is, for the refusal
  std::int64_t next_integer(const char* what);
  double next_number(const char* what);

 private:
  const Lines& lines_;
  std::string_view rest_;
  char separator_;
};

std::string_view trim(std::string_view text);
std::string to_lower(std::string_view text);
/// What a file holds, fit for a sentence: at most 60 characters, printable.
std::string quote(std::string_view text);

/// "; did you mean 'blank'?" (never what was asked for) or "; it has: a, b" or "; it has none".
std::string suggest_set(const std::string& set, const std::vector<std::string>& known);

}  // namespace interply::geometry
