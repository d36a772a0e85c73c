#include "geometry/abaqus_text.hpp"

#include <algorithm>
#include <filesystem>

#include "geometry/read_file.hpp"

namespace interply::geometry {
namespace {

namespace fs = std::filesystem;

/// Keywords with a meaning for a mesh.
constexpr std::string_view kKeywords[] = {"node",        "element",  "elset",       "nset",    "part",   "endpart",
                                          "assembly",    "instance", "endinstance", "include", "system", "endassembly"};

std::string remove_blanks(std::string_view text) {
  std::string rest = to_lower(text);
  std::erase_if(rest, [](char c) { return c == ' ' || c == '\t'; });
  return rest;
}

std::string unquote(std::string_view text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  return std::string(text);
}

/// Up to the next comma that is not in quotes; taken off the text.
std::string_view take_field(std::string_view& text) {
  bool in_quotes = false;
  const auto end = std::find_if(text.begin(), text.end(), [&](char c) {
    in_quotes ^= c == '"';
    return c == ',' && !in_quotes;
  });
  const auto size = static_cast<std::size_t>(end - text.begin());
  const std::string_view field = trim(text.substr(0, size));
  text.remove_prefix(std::min(size + 1, text.size()));
  return field;
}

class Includer {
 public:
  explicit Includer(const std::function<std::string(const std::string&)>& read) : read_(read) {}

  void add(const std::string& content, const std::string& path) {
    constexpr std::size_t kLargest = std::size_t{1} << 30, kMost = 10000;
    const std::string_view text = open_text(content, path);
    size_ += text.size();
    if (size_ > kLargest || pieces.size() > kMost)
      throw Unreadable(path + ": is more than 1 GiB or 10000 files with all that is included");
    open_.push_back(path);
    Lines lines(text, path);
    std::size_t begin = 0;
    std::int64_t first = 1;
    const auto cut = [&](std::size_t end) {
      if (end > begin || begin == 0) pieces.push_back({path, first, std::string(text.substr(begin, end - begin))});
      begin = lines.offset();
      first = lines.number() + 1;
    };
    for (std::size_t before = 0; lines.next(); before = lines.offset()) {
      if (!is_keyword(lines.line())) continue;
      const Keyword keyword = parse_keyword(lines);
      const std::string* input = keyword.find("input");
      const bool is_include = keyword.name == "include";
      if (is_include && !input) lines.refuse("*INCLUDE has no INPUT=");
      const auto is_read_here = {"include", "node", "element", "nset", "elset"};
      if (!input || std::find(is_read_here.begin(), is_read_here.end(), keyword.name) == is_read_here.end()) continue;
      cut(is_include ? before : lines.offset());
      include(*input, lines);
    }
    cut(text.size());
    open_.pop_back();
  }

  Pieces pieces;

 private:
  void include(std::string name, const Lines& from) {
    constexpr std::size_t kDeepest = 16;
    std::replace(name.begin(), name.end(), '\\', '/');
    std::string refusal;
    for (const std::string& start : {open_.back(), open_.front()}) {
      const std::string path = (fs::path(start).parent_path() / name).lexically_normal().string();
      if (std::find(open_.begin(), open_.end(), path) != open_.end() || open_.size() > kDeepest)
        from.refuse("includes " + quote(name) + ", which includes this file again");
      std::string content;
      try {
        content = read_(path);
      } catch (const Unreadable& error) {
        if (refusal.empty()) refusal = error.what();
        continue;
      }
      return add(content, path);
    }
    from.refuse("includes " + quote(name) + ", but " + refusal);
  }

  const std::function<std::string(const std::string&)>& read_;
  std::vector<std::string> open_;  ///< files from the first to the one that is being read
  std::size_t size_ = 0;
};

}  // namespace

const std::string* Keyword::find(std::string_view key) const {
  for (const auto& [given, value] : parameters)
    if (key.starts_with(given) && given.size() >= std::min<std::size_t>(3, key.size())) return &value;
  return nullptr;
}

Keyword parse_keyword(Lines& lines) {
  std::string text(lines.line().substr(1));
  while (text.ends_with(',') && lines.next()) text += lines.line();  // continuation
  std::string_view rest = text;
  Keyword keyword{.name = remove_blanks(take_field(rest)), .parameters = {}};
  for (const std::string_view known : kKeywords)
    if (keyword.name.size() >= 4 && known.starts_with(keyword.name)) keyword.name = known;
  while (!rest.empty()) {
    const std::string_view field = take_field(rest);
    const std::size_t equals = std::min(field.find('='), field.size());
    keyword.parameters.emplace_back(remove_blanks(field.substr(0, equals)),
                                    unquote(trim(field.substr(std::min(equals + 1, field.size())))));
  }
  return keyword;
}

Pieces follow_includes(const std::string& content, const std::string& path,
                       const std::function<std::string(const std::string& path)>& read) {
  Includer includer(read);
  includer.add(content, path);
  return std::move(includer.pieces);
}

}  // namespace interply::geometry
