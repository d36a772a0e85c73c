#include "scene/value.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "process/words.hpp"
#include "scene/read_scene.hpp"

namespace interply::scene {
namespace {

constexpr std::size_t kDeepest = 32;       // no path of the schema is deeper
constexpr std::size_t kLargest = 1 << 24;  // bytes of the tree; ends aliases that multiply

/// "scene.yaml" -> "scene.yaml:12"; an override is one line, so it stays as it is.
std::string add_line(const std::string& origin, const YAML::Mark& mark) {
  const bool has_line = !mark.is_null() && !origin.starts_with("--set ");
  return has_line ? origin + ":" + std::to_string(mark.line + 1) : origin;
}

bool is_indented_by_tab(const std::string& text, int line) {
  std::istringstream lines(text);
  std::string found;
  for (int i = 0; i <= line; ++i) std::getline(lines, found);
  return found.substr(0, found.find_first_not_of(" \t")).find('\t') != found.npos;
}

/// Bytes of a value and all that it holds, about.
std::size_t measure_size(const Value& value) {
  std::size_t size = sizeof value + value.scalar.size() + value.origin.size();
  for (const std::string& key : value.keys) size += sizeof key + key.size();
  for (const Value& item : value.items) size += measure_size(item);
  return size;
}

std::size_t measure_depth(const Value& value) {
  std::size_t depth = 0;
  for (const Value& item : value.items) depth = std::max(depth, 1 + measure_depth(item));
  return depth;
}

/// Builds the tree from the parser's events. Lists and blocks that are not closed yet wait on a stack.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(const std::string& origin, Report& report) : origin_(origin), report_(report), root_{.origin = origin} {}

  Value take_root() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(Value{.origin = locate(mark)}, anchor); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, const std::string& text) override {
    add(Value{.kind = Value::Kind::Scalar, .scalar = text, .origin = locate(mark)}, anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) throw SceneError(locate(mark) + ": an alias stands inside the value that it names");
    limit(mark, measure_depth(found->second), measure_size(found->second));
    add(found->second, 0);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, Value::Kind::List, anchor);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, Value::Kind::Block, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    Value value;
    YAML::anchor_t anchor = 0;
    bool has_key = false;  // Block: a key waits for its value
    std::string key{};     // Block: the key read last
    std::string key_origin{};
  };

  std::string locate(const YAML::Mark& mark) const { return add_line(origin_, mark); }

  void limit(const YAML::Mark& mark, std::size_t depth, std::size_t size) {
    size_ += size;
    if (open_.size() + depth > kDeepest) throw SceneError(locate(mark) + ": nested too deeply");
    if (size_ > kLargest) throw SceneError(locate(mark) + ": too many values; look for aliases of aliases");
  }

  void open(const YAML::Mark& mark, Value::Kind kind, YAML::anchor_t anchor) {
    limit(mark, 1, sizeof(Value));
    open_.push_back({.value = {.kind = kind, .origin = locate(mark)}, .anchor = anchor});
  }

  void close() {
    Open closed = std::move(open_.back());
    open_.pop_back();
    add(std::move(closed.value), closed.anchor);
  }

  void add(Value value, YAML::anchor_t anchor) {
    if (anchor) anchors_[anchor] = value;
    if (open_.empty()) {
      root_ = std::move(value);
    } else if (open_.back().value.kind == Value::Kind::List) {
      open_.back().value.items.push_back(std::move(value));
    } else if (!open_.back().has_key) {
      start_entry(open_.back(), value);
    } else {
      end_entry(open_.back(), std::move(value));
    }
  }

  void start_entry(Open& block, const Value& key) {
    block.has_key = true;
    block.key = key.scalar;
    block.key_origin = key.origin;
    if (key.kind != Value::Kind::Scalar) report_.add_at(key.origin, find_path(), "is a key that is not a word");
  }

  void end_entry(Open& block, Value value) {
    block.has_key = false;
    if (block.value.find(block.key)) return report_.add_at(block.key_origin, find_path(), "is given twice");
    value.origin = block.key_origin;  // a block is where its key is, not where its first entry is
    block.value.keys.push_back(block.key);
    block.value.items.push_back(std::move(value));
  }

  /// Of the entry that is being read.
  std::string find_path() const {
    std::string path;
    for (const Open& open : open_)
      path = open.value.kind == Value::Kind::List ? join(path, open.value.items.size()) : join(path, open.key);
    return path;
  }

  const std::string origin_;
  Report& report_;
  Value root_;
  std::vector<Open> open_;                   // outermost first
  std::map<YAML::anchor_t, Value> anchors_;  // closed values that aliases may name
  std::size_t size_ = 0;
};

}  // namespace

Value* Value::find(const std::string& key) {
  const auto found = std::find(keys.begin(), keys.end(), key);
  return found == keys.end() ? nullptr : &items[static_cast<std::size_t>(found - keys.begin())];
}

std::string describe(Value::Kind kind) {
  switch (kind) {
    case Value::Kind::Scalar:
      return "a single value";
    case Value::Kind::List:
      return "a list";
    case Value::Kind::Block:
      return "a block of keys";
    case Value::Kind::Null:
      break;
  }
  return "empty";
}

Value parse_yaml(const std::string& text, const std::string& origin, Report& report) {
  try {
    std::string lines = text;
    if (lines.find('\n') == lines.npos) std::replace(lines.begin(), lines.end(), '\r', '\n');
    std::istringstream stream(lines);
    YAML::Parser parser(stream);
    TreeBuilder first(origin, report), rest(origin, report);
    parser.HandleNextDocument(first);
    if (parser.HandleNextDocument(rest)) throw SceneError(origin + ": goes on after its first YAML document; keep one");
    return first.take_root();
  } catch (const YAML::Exception& error) {
    const std::string cause =
        is_indented_by_tab(text, error.mark.line) ? "a tab indents this line; use spaces" : error.msg;
    throw SceneError(process::to_line(add_line(origin, error.mark) + ": not valid YAML: " + cause));
  }
}

}  // namespace interply::scene
