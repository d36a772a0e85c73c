#include "geometry/text_lines.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "geometry/read_file.hpp"
#include "process/words.hpp"

namespace interply::geometry {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

}  // namespace

std::string_view open_text(std::string_view content, const std::string& origin) {
  if (content.starts_with("\xEF\xBB\xBF")) return content.substr(3);
  if (content.starts_with("\xFF\xFE") || content.starts_with("\xFE\xFF"))
    throw Unreadable(origin + ": is saved as UTF-16; save it as UTF-8");
  return content;
}

Lines::Lines(const Pieces& pieces) : Lines(pieces.front().text, pieces.front().origin) { pieces_ = &pieces; }

bool Lines::next() {
  while (rest_.empty()) {
    if (!pieces_ || static_cast<std::size_t>(piece_) + 1 == pieces_->size()) return false;
    const Piece& piece = (*pieces_)[static_cast<std::size_t>(++piece_)];
    text_ = rest_ = piece.text;
    origin_ = &piece.origin;
    number_ = piece.first_line - 1;
  }
  const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
  line_ = trim(rest_.substr(0, end));
  rest_.remove_prefix(rest_.substr(end).starts_with("\r\n") ? end + 2 : std::min(end + 1, rest_.size()));
  ++number_;
  return true;
}

void Lines::refuse(const std::string& sentence) const {
  throw Unreadable(*origin_ + ":" + std::to_string(number_) + ": " + sentence);
}

bool Fields::empty() const { return std::all_of(rest_.begin(), rest_.end(), is_blank); }

std::string_view Fields::next() {
  if (separator_ == ' ') rest_ = trim(rest_);
  const auto is_end = [&](char c) { return separator_ == ' ' ? is_blank(c) : c == separator_; };
  const auto end = static_cast<std::size_t>(std::find_if(rest_.begin(), rest_.end(), is_end) - rest_.begin());
  const std::string_view value = trim(rest_.substr(0, end));
  rest_ = end == rest_.size() ? std::string_view{} : rest_.substr(end + 1);
  return value;
}

std::int64_t Fields::next_integer(const char* what) {
  const std::string_view word = next();
  std::int64_t value = 0;
  const auto [last, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range) lines_.refuse(std::string(what) + " " + quote(word) + " is too large");
  if (error != std::errc{} || last != word.data() + word.size())
    lines_.refuse(word.empty() ? std::string(what) + " is missing"
                               : std::string(what) + " " + quote(word) + " is not a whole number");
  return value;
}

double Fields::next_number(const char* what) {
  std::string_view word = next();
  if (word.empty()) lines_.refuse(std::string(what) + " is missing");
  std::string digits(word.substr(word.starts_with('+') ? 1 : 0));
  for (char& c : digits)
    if (c == 'd' || c == 'D') c = 'e';  // Fortran's double precision
  double value = 0;
  const auto [last, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || last != digits.data() + digits.size() || !std::isfinite(value))
    lines_.refuse(std::string(what) + " " + quote(word) + " is not a finite number");
  return value;
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string to_lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

std::string quote(std::string_view text) {
  std::string out = "'";
  for (const char c : text.substr(0, 60)) out += c < 0x20 || c == 0x7f ? '?' : c;
  out += '\'';
  return out;
}

std::string suggest_set(const std::string& set, const std::vector<std::string>& known) {
  constexpr std::size_t kListed = 20, kCompared = 1000;
  if (known.empty()) return "; it has none";
  const std::string asked = quote(set);
  const auto distance = [&](const std::string& name) {
    return process::count_edits(to_lower(set.substr(0, 60)), to_lower(name.substr(0, 60)));
  };
  const auto nearest =
      std::min_element(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(std::min(known.size(), kCompared)),
                       [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
  if (quote(*nearest) != asked && distance(*nearest) <= std::max<std::size_t>(2, nearest->size() / 3) &&
      distance(*nearest) < nearest->size())
    return "; did you mean " + quote(*nearest) + "?";
  std::string text = "; it has: ";
  for (std::size_t i = 0; i < std::min(known.size(), kListed); ++i) text += (i ? ", " : "") + quote(known[i]);
  return known.size() > kListed ? text + ", ..." : text;
}

}  // namespace interply::geometry
