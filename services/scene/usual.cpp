#include "scene/usual.hpp"

#include <fmt/format.h>

#include <map>

#include "scene.pb.h"
#include "scene/report.hpp"
#include "scene/schema.hpp"

namespace interply::scene {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::FieldOptions;
using google::protobuf::Message;

struct Unit {
  const char* name;
  double factor;  ///< of one, in the unit of the schema
};

/// What else people write, by the unit of the schema.
const std::map<std::string, std::vector<Unit>> kOtherUnits{
    {"t/mm3", {{"kg/m3", 1e-12}, {"g/cm3", 1e-9}, {"kg/mm3", 1e-3}, {"t/m3", 1e-9}}},
    {"MPa", {{"Pa", 1e-6}, {"GPa", 1e3}, {"kPa", 1e-3}, {"bar", 0.1}}},
    {"mm", {{"m", 1e3}, {"um", 1e-3}, {"cm", 10}}},
    {"s", {{"ms", 1e-3}, {"us", 1e-6}}},
    {"N mm", {{"N m", 1e3}}},
    {"", {{"per cent", 0.01}}}};

class Finder {
 public:
  void look_at(const Message& message, const std::string& path) {
    const auto& type = *message.GetDescriptor();
    for (int i = 0; i < type.field_count(); ++i) {
      const FieldDescriptor& field = *type.field(i);
      look_at_field(message, field, join(path, field.name()), field.options());
    }
  }
  std::vector<std::string> sentences;

 private:
  /// @param options  that say what is usual: for the numbers of a list those of the field that holds it
  void look_at_field(const Message& message, const FieldDescriptor& field, const std::string& path,
                     const FieldOptions& options) {
    const auto& reflection = *message.GetReflection();
    const bool is_number = field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE;
    if (is_number && !field.is_repeated() && reflection.HasField(message, &field))
      look_at_number(reflection.GetDouble(message, &field), path, options);
    if (field.cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) return;
    if (field.is_repeated()) {
      for (int k = 0; k < reflection.FieldSize(message, &field); ++k)
        look_at(reflection.GetRepeatedMessage(message, &field, k), join(path, static_cast<std::size_t>(k)));
    } else if (reflection.HasField(message, &field)) {
      const Message& inner = reflection.GetMessage(message, &field);
      if (!is_list(*inner.GetDescriptor())) return look_at(inner, path);
      const std::size_t so_far = sentences.size();
      for (int k = 0; k < inner.GetDescriptor()->field_count() && sentences.size() == so_far; ++k)  // say it once
        look_at_field(inner, *inner.GetDescriptor()->field(k), path, options);
    }
  }

  void look_at_number(double value, const std::string& path, const FieldOptions& options) {
    const std::string usual = options.GetExtension(schema::usual), unit = options.GetExtension(schema::unit);
    if (value == 0 || contains(usual, value)) return;
    sentences.push_back(fmt::format("{}: {}{} is unusual, common is {}{}", path, value, unit.empty() ? "" : " " + unit,
                                    usual, suggest_unit(value, options)));
  }
};

}  // namespace

std::vector<std::string> find_unusual(const Message& message) {
  Finder finder;
  finder.look_at(message, "");
  return finder.sentences;
}

std::string suggest_unit(double value, const FieldOptions& options) {
  const std::string usual = options.GetExtension(schema::usual), unit = options.GetExtension(schema::unit);
  const auto others = kOtherUnits.find(unit);
  if (usual.empty() || others == kOtherUnits.end()) return "";
  for (const Unit& other : others->second)
    if (contains(usual, value * other.factor))
      return fmt::format("; in {} it would be {}{}", other.name, to_rounded(value * other.factor),
                         unit.empty() ? "" : " " + unit);
  return "";
}

}  // namespace interply::scene
