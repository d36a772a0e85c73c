/// What the parts of `interply bench` share.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace interply::launch {

/// Folder for sockets, records and logs; removed with this object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  /// A folder of this name in it, empty again.
  std::filesystem::path make_empty(const std::string& name) const;

 private:
  std::filesystem::path path_;
};

/// @pre not empty
double find_median(std::vector<double> values);
/// Median of ours / reference, pair by pair: what was measured side by side met the same noise.
double find_ratio(const std::vector<double>& ours, const std::vector<double>& reference);

}  // namespace interply::launch
