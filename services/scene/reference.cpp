#include "scene/reference.hpp"

#include <fmt/format.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>
#include <vector>

#include "scene.pb.h"
#include "scene/convert.hpp"
#include "scene/read_scene.hpp"
#include "scene/report.hpp"
#include "scene/schema.hpp"

namespace interply::scene {

extern const std::array<std::string_view, 1> kSchemaFiles;  // descriptors of scene.proto with its comments

namespace {

using google::protobuf::Descriptor;
using google::protobuf::DescriptorPool;
using google::protobuf::EnumDescriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

constexpr std::size_t kColumn = 34;  ///< of the remarks
constexpr std::size_t kWidth = 100;  ///< of a line

/// The schema once more, this time with its comments.
const DescriptorPool& commented_schema() {
  static const DescriptorPool* pool = [] {
    google::protobuf::FileDescriptorSet files;
    files.ParseFromArray(kSchemaFiles[0].data(), static_cast<int>(kSchemaFiles[0].size()));
    auto* made = new DescriptorPool;
    for (const auto& file : files.file()) made->BuildFile(file);
    return made;
  }();
  return *pool;
}

/// What stands before or behind a definition in the schema, as one line.
template <class Definition>
std::string find_comment(const Definition* definition) {
  google::protobuf::SourceLocation location;
  if (!definition || !definition->GetSourceLocation(&location)) return "";
  std::istringstream words(location.trailing_comments.empty() ? location.leading_comments : location.trailing_comments);
  std::string line;
  for (std::string word; words >> word;) line += (line.empty() ? "" : " ") + word;
  return line;
}

std::string find_comment(const FieldDescriptor& field) {
  return find_comment(commented_schema().FindFieldByName(field.full_name()));
}

std::string find_comment(const Descriptor& type) {
  return find_comment(commented_schema().FindMessageTypeByName(type.full_name()));
}

/// A scene that holds every block that has defaults: punch, laws of each kind.
const schema::Scene& make_sample() {
  static const schema::Scene sample = [] {
    Scene scene;
    scene.name = "...";
    scene.tools.punch = Punch{};
    Layer ply, sheet, own;
    ply.law = WovenLaw{}, sheet.law = J2Law{}, own.law = VumatLaw{};
    scene.layers = {ply, sheet, own};
    schema::Scene message = to_message(scene);
    for (schema::Layer& layer : *message.mutable_layers()) layer.clear_name();
    return message;
  }();
  return sample;
}

/// The first message in a tree that has this field, or null.
const Message* find_holder(const Message& message, const FieldDescriptor& field) {
  const auto& reflection = *message.GetReflection();
  if (message.GetDescriptor() == field.containing_type() &&
      (field.is_repeated() ? reflection.FieldSize(message, &field) > 0 : reflection.HasField(message, &field)))
    return &message;
  std::vector<const FieldDescriptor*> set;
  reflection.ListFields(message, &set);
  for (const FieldDescriptor* inner : set) {
    if (!inner->message_type()) continue;
    const int n = inner->is_repeated() ? reflection.FieldSize(message, inner) : 1;
    for (int i = 0; i < n; ++i) {
      const Message& child = inner->is_repeated() ? reflection.GetRepeatedMessage(message, inner, i)
                                                  : reflection.GetMessage(message, inner);
      if (const Message* found = find_holder(child, field)) return found;
    }
  }
  return nullptr;
}

/// The default as it is written, or nothing.
std::string find_default(const FieldDescriptor& field) {
  if (field.options().GetExtension(schema::required)) return "";
  const Message* holder = find_holder(make_sample(), field);
  if (!holder) return field.options().GetExtension(schema::none) ? "none" : "";
  return write_value(*holder, field);
}

std::string list_words(const EnumDescriptor& type) {
  std::string words;
  for (int i = 0; i < type.value_count(); ++i) words += (i ? " | " : "") + type.value(i)->name();
  return words;
}

/// Unit, range and meaning of a key that holds a value.
std::string describe_value(const FieldDescriptor& field) {
  const auto& options = field.options();
  std::vector<std::string> parts;
  const auto add = [&](const std::string& part) {
    if (!part.empty()) parts.push_back(part);
  };
  add(options.GetExtension(schema::unit));
  if (field.enum_type()) add(list_words(*field.enum_type()));
  if (field.message_type() && is_list(*field.message_type()) &&
      field.message_type()->options().GetExtension(schema::uniform))
    add("one value or [warp, weft]");
  if (const std::string range = options.GetExtension(schema::range); !range.empty())
    add((field.cpp_type() == FieldDescriptor::CPPTYPE_INT32 ? "whole, in " : "in ") + range);
  if (const std::string usual = options.GetExtension(schema::usual); !usual.empty()) add("usually " + usual);
  if (options.GetExtension(schema::required)) add("required");
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  std::string meaning = find_comment(field);
  if (meaning.empty() && field.message_type()) meaning = find_comment(*field.message_type());
  if (meaning.empty()) return text;
  return text.empty() ? meaning : text + "; " + meaning;
}

class Writer {
 public:
  std::string take() { return std::move(text_); }

  void write_keys(const Descriptor& type, std::size_t indent) {
    for (int i = 0; i < type.field_count(); ++i) {
      const FieldDescriptor& field = *type.field(i);
      if (const auto* oneof = field.real_containing_oneof(); oneof && oneof->field(0) == &field)
        write_line("", indent, "one of:");
      write_key(field, indent);
    }
  }

  void write_key(const FieldDescriptor& field, std::size_t indent) {
    const Descriptor* type = field.message_type();
    if (!type || is_list(*type) || is_word(*type)) {
      const std::string value = find_default(field);
      write_line(fmt::format("{}:{}{}", field.name(), value.empty() ? "" : " ", value), indent, describe_value(field));
      return;
    }
    write_line(field.name() + ":", indent, describe_block(field));
    if (!field.is_repeated()) return write_keys(*type, indent + 2);
    const std::size_t first = text_.size();
    write_keys(*type, indent + 4);
    text_.replace(first + indent + 2, 1, "-");
  }

 private:
  std::string describe_block(const FieldDescriptor& field) {
    std::string text = find_comment(field);
    if (text.empty()) text = find_comment(*field.message_type());
    if (field.options().GetExtension(schema::none)) text += text.find("none") == text.npos ? "; none by default" : "";
    return text;
  }

  /// Remarks that do not fit behind the key go on below it.
  void write_line(const std::string& key, std::size_t indent, const std::string& remark) {
    std::string line = std::string(indent, ' ') + key;
    std::istringstream words(remark);
    bool begun = false;
    for (std::string word; words >> word;) {
      if (!begun || line.size() + 1 + word.size() > kWidth) {
        if (begun) text_ += line + "\n", line.clear();
        line.resize(std::max(line.size() + (line.empty() ? 0 : 2), kColumn), ' ');
        line += "#";
        begun = true;
      }
      line += " " + word;
    }
    text_ += line + "\n";
  }

  std::string text_;
};

std::vector<std::string> list_names(const Descriptor& type) {
  std::vector<std::string> names;
  for (int i = 0; i < type.field_count(); ++i) names.push_back(type.field(i)->name());
  return names;
}

}  // namespace

std::string describe_keys(const std::string& path) {
  Writer writer;
  const Descriptor* type = schema::Scene::descriptor();
  const FieldDescriptor* field = nullptr;
  std::string done;
  std::istringstream parts(path);
  for (std::string part; std::getline(parts, part, '.');) {
    part = part.substr(0, part.find('['));  // layers[0] is layers
    field = type ? type->FindFieldByName(part) : nullptr;
    if (!field)
      throw SceneError(type ? join(done, part) + ": unknown key" + suggest(part, list_names(*type))
                            : done + ": has no keys of its own");
    done = join(done, part);
    type = field->message_type();
    if (type && (is_list(*type) || is_word(*type))) type = nullptr;
  }
  if (field)
    writer.write_key(*field, 0);
  else
    writer.write_keys(*type, 0);
  return writer.take();
}

}  // namespace interply::scene
