/// YAML <-> Protobuf by walking descriptors: the one place that knows how a message of proto/scene.proto looks in YAML.
///
///     block          keys are the field names
///     (list)         [x, y]: the fields in order, or the items of the only, repeated field
///     (uniform)      a single value stands for all fields of a (list)
///     (none)         the word `none`: an infinite number, or an absent block
///     oneof          exactly one of its keys
#pragma once

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <string>

#include "scene/report.hpp"
#include "scene/value.hpp"

namespace interply::scene {

/// Whether a message is written [x, y, ...], or as one word.
bool is_list(const google::protobuf::Descriptor& type);
bool is_word(const google::protobuf::Descriptor& type);

/// Whether an interval of the schema, such as "(0, inf)" or "[0, 1]", holds a number; an empty text holds every one.
bool contains(const std::string& interval, double value);

/// Copies a YAML tree into a message. Unknown keys, wrong types, values out of range and missing keys go to the report;
/// what is wrong stays unset. @param path of `value` in the scene, e.g. "layers[2].law"; "" for all of it
void read_message(const Value& value, const std::string& path, google::protobuf::Message& message, Report& report);

/// The message as YAML, fields in the order of the schema, numbers as the shortest text that reads back to the same
/// bits.
std::string write_message(const google::protobuf::Message& message);

/// The value of one field as it is written there.
std::string write_value(const google::protobuf::Message& message, const google::protobuf::FieldDescriptor& field);

}  // namespace interply::scene
