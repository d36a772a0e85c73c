/// A file that a command writes for a person.
#pragma once

#include <filesystem>
#include <string>

namespace interply::launch {

/// @throws BadArgument if there is such a file, whose last words are the cure  @param cure  e.g. "give another name"
void check_is_new(const std::filesystem::path& file, const std::string& cure);

/// Writes all of a file. One that is there stays unless `overwrite`; what is no file, such as a pipe, is written to.
/// @throws BadArgument as above; std::runtime_error if it cannot be written
void write_new_file(const std::filesystem::path& file, const std::string& text, bool overwrite,
                    const std::string& cure);

}  // namespace interply::launch
