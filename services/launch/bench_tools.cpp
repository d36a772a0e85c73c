#include "launch/bench_tools.hpp"

#include <stdlib.h>

#include <algorithm>

namespace interply::launch {
namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder() {
  std::string path = (fs::temp_directory_path() / "interply-bench-XXXXXX").string();
  if (::mkdtemp(path.data()) == nullptr) throw std::runtime_error("cannot create " + path);
  path_ = path;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

fs::path TemporaryFolder::make_empty(const std::string& name) const {
  fs::remove_all(path_ / name);
  fs::create_directories(path_ / name);
  return path_ / name;
}

double find_median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

double find_ratio(const std::vector<double>& ours, const std::vector<double>& reference) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(ours.size(), reference.size()); ++i) ratios.push_back(ours[i] / reference[i]);
  return find_median(ratios);
}

}  // namespace interply::launch
