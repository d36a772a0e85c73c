/// Text files line by line, with errors that say where.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace interply::geometry {

/// The lines of a text that outlives this object; line ends LF or CR LF.
class Lines {
 public:
  Lines(std::string_view text, std::string origin) : rest_(text), origin_(std::move(origin)) {}

  /// Goes to the next line. False at the end of the text.
  bool next();
  std::string_view line() const { return line_; }  ///< without blanks at its ends
  std::int64_t number() const { return number_; }  ///< of the line, from 1
  const std::string& origin() const { return origin_; }

  /// @throws Unreadable  "part.msh:12: sentence"
  [[noreturn]] void refuse(const std::string& sentence) const;

 private:
  std::string_view rest_, line_;
  std::string origin_;
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

/// "; did you mean 'blank'?" or "; it has: a, b" or "; it has none".
std::string suggest_set(const std::string& set, const std::vector<std::string>& known);

}  // namespace interply::geometry
