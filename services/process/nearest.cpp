#include "process/nearest.hpp"

#include <algorithm>
#include <string_view>

#include "process/words.hpp"

namespace interply::process {
namespace {

constexpr std::size_t kLongest = 100;  ///< no name is longer; comparing takes as long as the product of both lengths
constexpr std::size_t kBeginning = 3;  ///< letters that say enough

std::string_view without_hyphens(std::string_view name) {
  name.remove_prefix(std::min(name.find_first_not_of('-'), name.size()));
  return name;
}

}  // namespace

std::string find_nearest(const std::string& word, const std::vector<std::string>& names) {
  if (word.size() > kLongest || std::find(names.begin(), names.end(), word) != names.end()) return "";
  const std::string_view letters = without_hyphens(word);
  const std::string* nearest = nullptr;
  const std::string* continued = nullptr;
  std::size_t fewest = 0, continuations = 0;
  for (const std::string& name : names) {
    const std::string_view known = without_hyphens(name);
    const std::size_t edits = count_edits(letters, known);
    const bool is_near = edits <= std::max<std::size_t>(1, known.size() / 3) && edits < known.size();
    if (is_near && (!nearest || edits < fewest)) nearest = &name, fewest = edits;
    if (letters.size() >= kBeginning && known.starts_with(letters)) continued = &name, ++continuations;
  }
  if (nearest) return *nearest;
  return continuations == 1 ? *continued : "";
}

}  // namespace interply::process
