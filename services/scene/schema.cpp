#include "scene/schema.hpp"

#include <yaml-cpp/yaml.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "scene.pb.h"
#include "scene/usual.hpp"

namespace interply::scene {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::FieldOptions;
using google::protobuf::Message;
using google::protobuf::Reflection;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool may_be_none(const FieldOptions& options) { return options.GetExtension(schema::none); }
bool is_message(const FieldDescriptor& field) { return field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE; }

/// Number of the whole text, or nothing. A leading '+' is YAML, though not from_chars.
template <class T>
std::optional<T> parse_number(const std::string& text) {
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.data() + text.size();
  T number{};
  const auto [last, error] = std::from_chars(begin, end, number);
  if (error != std::errc{} || last != end) return std::nullopt;
  return number;
}

std::vector<std::string> list_keys(const Descriptor& type) {
  std::vector<std::string> keys;
  for (int i = 0; i < type.field_count(); ++i) keys.push_back(type.field(i)->name());
  return keys;
}

/// One field of one message, settable or appendable.
class Reader {
 public:
  explicit Reader(Report& report) : report_(report) {}

  void read_block(const Value& value, const std::string& path, Message& message) {
    const Descriptor& type = *message.GetDescriptor();
    report_.locate(path, value.origin);
    if (is_list(type)) return read_list(value, path, message, FieldOptions::default_instance());
    if (is_word(type) && value.kind == Value::Kind::Scalar)
      return read_scalar(value, path, message, *type.field(0), type.field(0)->options());
    if (value.kind != Value::Kind::Block)
      return report_.add(path, "must be a block of keys, not " + describe(value.kind));
    for (std::size_t i = 0; i < value.keys.size(); ++i) {
      const std::string key_path = join(path, value.keys[i]);
      report_.locate(key_path, value.items[i].origin);
      if (const FieldDescriptor* field = type.FindFieldByName(value.keys[i])) {
        read_field(value.items[i], key_path, message, *field);
      } else {
        report_.add(key_path, "unknown key" + suggest(value.keys[i], list_keys(type)));
      }
    }
    check_alternatives(path, type);
    check_required(value, path, type);
  }

 private:
  void read_field(const Value& value, const std::string& path, Message& message, const FieldDescriptor& field) {
    const Reflection& reflection = *message.GetReflection();
    if (value.kind == Value::Kind::Null) return report_.add(path, "has no value");
    if (field.is_repeated()) return read_items(value, path, message, field);
    if (!is_message(field)) return read_scalar(value, path, message, field, field.options());
    if (may_be_none(field.options()) && value.kind == Value::Kind::Scalar && value.scalar == "none" &&
        !is_list(*field.message_type()))
      return;
    Message& inner = *reflection.MutableMessage(&message, &field);
    is_list(*field.message_type()) ? read_list(value, path, inner, field.options()) : read_block(value, path, inner);
  }

  /// A list of blocks, the rows of a table, or numbers.
  void read_items(const Value& value, const std::string& path, Message& message, const FieldDescriptor& field) {
    if (value.kind != Value::Kind::List) return report_.add(path, "must be a list, not " + describe(value.kind));
    if (!is_message(field)) return read_numbers(value, path, message, field);
    for (std::size_t i = 0; i < value.items.size(); ++i)
      read_block(value.items[i], join(path, i), *message.GetReflection()->AddMessage(&message, &field));
  }

  void read_numbers(const Value& value, const std::string& path, Message& message, const FieldDescriptor& field) {
    for (std::size_t i = 0; i < value.items.size(); ++i) {
      const std::string item = join(path, i), &text = value.items[i].scalar;
      report_.locate(item, value.items[i].origin);
      const std::optional<double> number = parse_number<double>(text);
      if (value.items[i].kind != Value::Kind::Scalar) {
        report_.add(item, "must be a number, not " + describe(value.items[i].kind));
      } else if (!number || !std::isfinite(*number)) {
        report_.add(item, "'" + text + "' is not a number");
      } else if (is_in_range(*number, text, item, field.options())) {
        message.GetReflection()->AddDouble(&message, &field, *number);
      }
    }
  }

  /// A message written as [x, y]; `options` are those of the field that holds it: they say unit and range of each item.
  void read_list(const Value& value, const std::string& path, Message& message, const FieldOptions& options) {
    const Descriptor& type = *message.GetDescriptor();
    if (type.field(0)->is_repeated()) return read_items(value, path, message, *type.field(0));
    const bool uniform = type.options().GetExtension(schema::uniform);
    const std::size_t count = static_cast<std::size_t>(type.field_count());
    if (uniform && value.kind == Value::Kind::Scalar) {
      for (int i = 0; i < type.field_count(); ++i) {
        if (report_.is_broken(path)) return;  // say it once
        read_scalar(value, path, message, *type.field(i), options);
      }
    } else if (value.kind == Value::Kind::List && value.items.size() == count) {
      for (std::size_t i = 0; i < count; ++i) {
        report_.locate(join(path, i), value.items[i].origin);
        read_scalar(value.items[i], join(path, i), message, *type.field(static_cast<int>(i)), options);
      }
    } else {
      report_.add(path, std::string("must be ") + (uniform ? "a single value or " : "") + "a list [" +
                            enumerate(list_keys(type)) + "]");
    }
  }

  void read_scalar(const Value& value, const std::string& path, Message& message, const FieldDescriptor& field,
                   const FieldOptions& options) {
    const Reflection& reflection = *message.GetReflection();
    const std::string& text = value.scalar;
    const auto refuse = [&](const std::string& expected) {
      const bool single = value.kind == Value::Kind::Scalar;
      report_.add(
          path, single ? "'" + text + "' is not " + expected : "must be " + expected + ", not " + describe(value.kind));
    };
    const bool single = value.kind == Value::Kind::Scalar;
    switch (field.cpp_type()) {
      case FieldDescriptor::CPPTYPE_DOUBLE: {
        const bool none = single && may_be_none(options) && text == "none";
        const std::optional<double> number = none ? kInfinity : parse_number<double>(text);
        if (!single || !number || (!none && !std::isfinite(*number)))
          return refuse(may_be_none(options) ? "a number or none" : "a number");
        if (none || is_in_range(*number, text, path, options)) reflection.SetDouble(&message, &field, *number);
        return;
      }
      case FieldDescriptor::CPPTYPE_INT32: {
        const std::optional<int> number = parse_number<int>(text);
        if (!single || !number) return refuse("a whole number");
        if (is_in_range(*number, text, path, options)) reflection.SetInt32(&message, &field, *number);
        return;
      }
      case FieldDescriptor::CPPTYPE_BOOL:
        if (!single || (text != "true" && text != "false")) return refuse("true or false");
        return reflection.SetBool(&message, &field, text == "true");
      case FieldDescriptor::CPPTYPE_ENUM: {
        std::vector<std::string> words;
        for (int i = 0; i < field.enum_type()->value_count(); ++i) words.push_back(field.enum_type()->value(i)->name());
        const auto* word = single ? field.enum_type()->FindValueByName(text) : nullptr;
        if (!word) return refuse("one of " + enumerate(words) + (single ? suggest_word(text, words) : ""));
        return reflection.SetEnum(&message, &field, word);
      }
      default:
        if (!single) return refuse("a word");
        reflection.SetString(&message, &field, text);
    }
  }

  /// The list of words is already in the sentence, so only a near one is worth adding.
  static std::string suggest_word(const std::string& text, const std::vector<std::string>& words) {
    const std::string suggestion = suggest(text, words);
    return suggestion.starts_with("; known") ? "" : suggestion;
  }

  bool is_in_range(double number, const std::string& text, const std::string& path, const FieldOptions& options) {
    const std::string range = options.GetExtension(schema::range), unit = options.GetExtension(schema::unit);
    if (contains(range, number)) return true;
    report_.add(path, text + " is not in " + range + (unit.empty() ? "" : " " + unit) + suggest_unit(number, options));
    return false;
  }

  void check_required(const Value& value, const std::string& path, const Descriptor& type) {
    for (int i = 0; i < type.field_count(); ++i) {
      const FieldDescriptor& field = *type.field(i);
      if (field.options().GetExtension(schema::required) && !report_.is_given(join(path, field.name())))
        report_.add_at(value.origin, join(path, field.name()), "is required and has no default");
    }
  }

  void check_alternatives(const std::string& path, const Descriptor& type) {
    for (int i = 0; i < type.real_oneof_decl_count(); ++i) {
      std::vector<std::string> keys, given;
      for (int k = 0; k < type.oneof_decl(i)->field_count(); ++k) {
        keys.push_back(type.oneof_decl(i)->field(k)->name());
        if (report_.is_given(join(path, keys.back()))) given.push_back(keys.back());
      }
      if (given.empty() && !report_.is_broken(path)) report_.add(path, "needs one of " + enumerate(keys));
      if (given.size() > 1) report_.add(path, "holds " + enumerate(given) + "; keep one of them");
    }
  }

  Report& report_;
};

std::string to_word(const Message& message, const FieldDescriptor& field) {
  const Reflection& reflection = *message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE: {
      const double number = reflection.GetDouble(message, &field);
      return std::isinf(number) ? "none" : to_text(number);
    }
    case FieldDescriptor::CPPTYPE_INT32:
      return std::to_string(reflection.GetInt32(message, &field));
    case FieldDescriptor::CPPTYPE_BOOL:
      return reflection.GetBool(message, &field) ? "true" : "false";
    case FieldDescriptor::CPPTYPE_ENUM:
      return reflection.GetEnum(message, &field)->name();
    default:
      return reflection.GetString(message, &field);
  }
}

void write_block(const Message& message, YAML::Emitter& out);

void write_field(const Message& message, const FieldDescriptor& field, YAML::Emitter& out) {
  const Reflection& reflection = *message.GetReflection();
  if (field.is_repeated() && !is_message(field)) {
    out << YAML::Flow << YAML::BeginSeq;
    for (int i = 0; i < reflection.FieldSize(message, &field); ++i)
      out << to_text(reflection.GetRepeatedDouble(message, &field, i));
    out << YAML::EndSeq;
  } else if (field.is_repeated()) {
    if (is_list(*field.message_type()) || reflection.FieldSize(message, &field) == 0) out << YAML::Flow;
    out << YAML::BeginSeq;
    for (int i = 0; i < reflection.FieldSize(message, &field); ++i)
      write_block(reflection.GetRepeatedMessage(message, &field, i), out);
    out << YAML::EndSeq;
  } else if (!is_message(field)) {
    out << to_word(message, field);
  } else {
    write_block(reflection.GetMessage(message, &field), out);
  }
}

void write_block(const Message& message, YAML::Emitter& out) {
  const Descriptor& type = *message.GetDescriptor();
  const Reflection& reflection = *message.GetReflection();
  if (is_list(type)) {
    if (type.field(0)->is_repeated()) return write_field(message, *type.field(0), out);
    out << YAML::Flow << YAML::BeginSeq;
    for (int i = 0; i < type.field_count(); ++i) write_field(message, *type.field(i), out);
    out << YAML::EndSeq;
    return;
  }
  out << YAML::BeginMap;
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    const bool absent = !field.is_repeated() && !reflection.HasField(message, &field);
    if (absent && !may_be_none(field.options())) continue;
    out << YAML::Key << field.name() << YAML::Value;
    absent ? void(out << "none") : write_field(message, field, out);
  }
  out << YAML::EndMap;
}

}  // namespace

bool contains(const std::string& interval, double value) {
  if (interval.empty()) return true;
  const std::size_t comma = interval.find(", ");
  const double low = *parse_number<double>(interval.substr(1, comma - 1));
  const double high = *parse_number<double>(interval.substr(comma + 2, interval.size() - comma - 3));
  return (interval.front() == '[' ? value >= low : value > low) &&
         (interval.back() == ']' ? value <= high : value < high);
}

bool is_list(const Descriptor& type) { return type.options().GetExtension(schema::list); }
bool is_word(const Descriptor& type) { return type.options().GetExtension(schema::word); }

void read_message(const Value& value, const std::string& path, Message& message, Report& report) {
  Reader(report).read_block(value, path, message);
}

std::string write_message(const Message& message) {
  YAML::Emitter out;
  write_block(message, out);
  return std::string(out.c_str()) + "\n";
}

std::string write_value(const Message& message, const FieldDescriptor& field) {
  YAML::Emitter out;
  write_field(message, field, out);
  return out.c_str();
}

}  // namespace interply::scene
