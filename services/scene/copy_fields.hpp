/// Copies between the messages of proto/scene.proto and plain structs by the names of their fields. For convert.cpp,
/// which says what has which fields.
#pragma once

#include <google/protobuf/message.h>

#include <stdexcept>
#include <string>
#include <type_traits>

#include "scene/scene.hpp"

namespace interply::scene {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

template <class T>
constexpr bool kIsScalar = std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, std::string>;

const FieldDescriptor* find_field(const Message& message, const char* key) {
  const FieldDescriptor* field = message.GetDescriptor()->FindFieldByName(key);
  if (!field) throw std::logic_error("proto/scene.proto: " + message.GetTypeName() + " has no field " + key);
  return field;
}

/// The two directions of a copy share their verbs, so that each struct is described once, by `map` below:
///     io(key, member)                    a number, word or nested struct
///     io.block(key, body)                a nested block without a struct of its own
///     io.items(key, vector)              a repeated field of blocks
///     io.numbers(key, vector)            a repeated field of numbers
///     io.may_be_absent(key, optional)    a nested struct
///     io.alternative<T>(key, variant)    a member of a oneof
struct FromMessage {
  static constexpr bool kReading = true;
  const Message& message;

  template <class T>
  void operator()(const char* key, T& x) {
    if (!has(key)) return;
    if constexpr (kIsScalar<T>) {
      copy_scalar(find_field(message, key), x);
    } else {
      block(key, [&x](auto& inner) { map(inner, x); });
    }
  }

  template <class Body>
  void block(const char* key, Body body) {
    if (!has(key)) return;
    FromMessage inner{message.GetReflection()->GetMessage(message, find_field(message, key))};
    body(inner);
  }

  template <class T>
  void items(const char* key, std::vector<T>& x) {
    const FieldDescriptor* field = find_field(message, key);
    for (int i = 0; i < message.GetReflection()->FieldSize(message, field); ++i) {
      FromMessage inner{message.GetReflection()->GetRepeatedMessage(message, field, i)};
      map(inner, x.emplace_back());
    }
  }

  void numbers(const char* key, std::vector<double>& x) {
    const FieldDescriptor* field = find_field(message, key);
    for (int i = 0; i < message.GetReflection()->FieldSize(message, field); ++i)
      x.push_back(message.GetReflection()->GetRepeatedDouble(message, field, i));
  }

  template <class T>
  void may_be_absent(const char* key, std::optional<T>& x) {
    if (has(key)) (*this)(key, x.emplace());
  }

  template <class T, class Variant>
  void alternative(const char* key, Variant& x) {
    if (has(key)) (*this)(key, x.template emplace<T>());
  }

 private:
  bool has(const char* key) const { return message.GetReflection()->HasField(message, find_field(message, key)); }

  template <class T>
  void copy_scalar(const FieldDescriptor* field, T& x) const {
    const auto& reflection = *message.GetReflection();
    if constexpr (std::is_same_v<T, std::string>) {
      x = reflection.GetString(message, field);
    } else if constexpr (std::is_same_v<T, double>) {
      x = reflection.GetDouble(message, field);
    } else if constexpr (std::is_same_v<T, int>) {
      x = reflection.GetInt32(message, field);
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_BOOL) {
      x = static_cast<T>(reflection.GetBool(message, field));
    } else {
      x = static_cast<T>(reflection.GetEnumValue(message, field));
    }
  }
};

struct ToMessage {
  static constexpr bool kReading = false;
  Message& message;

  template <class T>
  void operator()(const char* key, T& x) {
    if constexpr (kIsScalar<T>) {
      copy_scalar(find_field(message, key), x);
    } else {
      block(key, [&x](auto& inner) { map(inner, x); });
    }
  }

  template <class Body>
  void block(const char* key, Body body) {
    ToMessage inner{*message.GetReflection()->MutableMessage(&message, find_field(message, key))};
    body(inner);
  }

  template <class T>
  void items(const char* key, std::vector<T>& x) {
    for (T& item : x) {
      ToMessage inner{*message.GetReflection()->AddMessage(&message, find_field(message, key))};
      map(inner, item);
    }
  }

  void numbers(const char* key, std::vector<double>& x) {
    for (const double number : x) message.GetReflection()->AddDouble(&message, find_field(message, key), number);
  }

  template <class T>
  void may_be_absent(const char* key, std::optional<T>& x) {
    if (x) (*this)(key, *x);
  }

  template <class T, class Variant>
  void alternative(const char* key, Variant& x) {
    if (T* held = std::get_if<T>(&x)) (*this)(key, *held);
  }

 private:
  template <class T>
  void copy_scalar(const FieldDescriptor* field, const T& x) {
    const auto& reflection = *message.GetReflection();
    if constexpr (std::is_same_v<T, std::string>) {
      reflection.SetString(&message, field, x);
    } else if constexpr (std::is_same_v<T, double>) {
      reflection.SetDouble(&message, field, x);
    } else if constexpr (std::is_same_v<T, int>) {
      reflection.SetInt32(&message, field, x);
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_BOOL) {
      reflection.SetBool(&message, field, static_cast<bool>(x));
    } else {
      reflection.SetEnumValue(&message, field, static_cast<int>(x));
    }
  }
};

}  // namespace
}  // namespace interply::scene
