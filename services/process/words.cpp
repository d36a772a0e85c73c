#include "process/words.hpp"

#include <unistd.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace interply::process {

namespace {

unsigned char byte_at(std::string_view text, std::size_t i) { return static_cast<unsigned char>(text[i]); }

/// Length of the printable character that begins the text; 0: it begins with none.
std::size_t measure_character(std::string_view text) {
  const unsigned char first = byte_at(text, 0);
  if (first < 0x80) return first < 0x20 || first == 0x7f ? 0 : 1;
  const std::size_t length = first >= 0xc2 && first < 0xe0 ? 2 : first >= 0xe0 && first < 0xf0 ? 3 : first < 0xf5 ? 4 : 0;
  if (first < 0xc2 || length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte_at(text, i) & 0xc0) != 0x80) return 0;
  const bool is_control = first == 0xc2 && byte_at(text, 1) < 0xa0;
  return is_control ? 0 : length;
}

}  // namespace

std::string to_line(std::string_view text, std::size_t most) {
  static constexpr const char* kDigits = "0123456789abcdef";
  std::string line;
  line.reserve(std::min(text.size(), most));
  while (!text.empty()) {
    if (line.size() >= most) return line + "...";
    const std::size_t length = measure_character(text);
    if (length > 0) {
      line.append(text.substr(0, length));
      text.remove_prefix(length);
    } else {
      const unsigned char byte = byte_at(text, 0);
      line += {'\\', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
      text.remove_prefix(1);
    }
  }
  return line;
}

std::size_t count_edits(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1), above(row), two_above(row);  // row i: from i characters of a
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::swap(two_above, above);
    std::swap(above, row);
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      row[j + 1] = std::min({above[j] + (a[i] == b[j] ? 0 : 1), row[j] + 1, above[j + 1] + 1});
      if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j])
        row[j + 1] = std::min(row[j + 1], two_above[j - 1] + 1);
    }
  }
  return row.back();
}

std::string host_name() {
  char name[256] = {};
  ::gethostname(name, sizeof(name) - 1);
  return name;
}

}  // namespace interply::process
