/// What a person meant who mistyped a name.
#pragma once

#include <string>
#include <vector>

namespace interply::process {

/// Of the names the one that `word` was most likely meant to be: a third of its letters wrong at most (count_edits; one
/// letter in short names), or `word` is the beginning, three letters at least, of this name alone. Empty if none is
/// that near, or if `word` is one of them. Hyphens before a word or a name do not count.
std::string find_nearest(const std::string& word, const std::vector<std::string>& names);

}  // namespace interply::process
