/// What the targets share: how an input is cut into parts, and what a refusal must look like.
///
/// A target may succeed or throw the documented error of its reader; everything else ends the process, which is how the
/// fuzzer and the replay test notice.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace interply::fuzz {

[[noreturn]] inline void fail(const std::string& why) {
  std::fprintf(stderr, "fuzz: %s\n", why.c_str());
  std::abort();
}

/// Parts of an input are separated by lines that hold "%%" alone.
inline std::vector<std::string> split(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  constexpr std::string_view kSeparator = "\n%%\n";
  std::vector<std::string> parts;
  for (std::size_t at = 0;;) {
    const std::size_t next = text.find(kSeparator, at);
    parts.emplace_back(text.substr(at, next == text.npos ? next : next - at));
    if (next == text.npos) return parts;
    at = next + kSeparator.size();
  }
}

/// Every line is one sentence that begins with where the problem is, and says something about it.
/// @param origins  what a sentence may begin with
inline void expect_sentences(const std::string& message, const std::vector<std::string>& origins) {
  if (message.empty()) fail("a refusal without a reason");
  for (std::size_t at = 0; at <= message.size();) {
    const std::size_t end = std::min(message.find('\n', at), message.size());
    const std::string line = message.substr(at, end - at);
    bool known = false;
    for (const std::string& origin : origins)
      known = known || (line.starts_with(origin) && line.size() > origin.size());
    if (!known) fail("a line without its origin: '" + line + "'");
    for (const unsigned char c : line)
      if (c < 0x20 || c == 0x7f) fail("a control character in: '" + line + "'");
    at = end + 1;
  }
}

/// The same for an error that is one sentence.
inline void expect_sentence(const std::string& message, const std::string& origin) {
  if (message.find('\n') != std::string::npos) fail("more than one line: '" + message + "'");
  expect_sentences(message, {origin});
}

}  // namespace interply::fuzz
