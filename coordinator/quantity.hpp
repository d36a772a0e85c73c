/// Numbers with their units, for what is printed and written as JSON alike.
#pragma once

#include <google/protobuf/message.h>

#include <string>

#include "summary.pb.h"

namespace interply::coordinator {

inline void set(summary::Quantity* to, double value, const std::string& unit) {
  to->set_value(value);
  to->set_unit(unit);
}

/// Every field of a message, keys as in proto/.
std::string format_json(const google::protobuf::Message& message);

}  // namespace interply::coordinator
