/// Columns of /history: which member of a HistoryRow, its name, unit and meaning. Internal to record.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "observe/frames.hpp"

namespace interply::record {

struct ScalarColumn {
  const char* name;
  const char* unit;
  const char* description;
  double observe::HistoryRow::*value;
};

/// One value per layer or per interface.
struct ListColumn {
  const char* name;
  const char* unit;
  const char* description;
  std::vector<double> observe::HistoryRow::*values;
  bool per_interface = false;
};

std::span<const ScalarColumn> scalar_columns();
std::span<const ListColumn> list_columns();

}  // namespace interply::record
