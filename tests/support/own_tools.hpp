/// The default tools as STL files, for scenes with the default analytic ones.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "support/tool_surfaces.hpp"

namespace interply::test {

/// A folder with punch.stl, die.stl and blank_holder.stl, m facets per rounding; removed with this object.
class OwnTools {
 public:
  explicit OwnTools(int m, bool closed = true) {
    static int count = 0;
    folder_ = std::filesystem::temp_directory_path() /
              ("interply_tools_" + std::to_string(getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directory(folder_);
    write("punch", make_punch(100, 50, 15, 60, m));
    const Soup plate = make_plate(100, 22, 10, 80, 160, m, closed);
    write("die", plate);
    write("blank_holder", turn_over(plate));
  }
  ~OwnTools() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  OwnTools(const OwnTools&) = delete;

  std::string path(const std::string& tool) const { return (folder_ / (tool + ".stl")).string(); }
  void write(const std::string& tool, const Soup& soup) const { write_file(path(tool), to_binary_stl(soup)); }

  /// Overrides that put the files in place of the analytic tools.
  std::vector<std::string> overrides(const std::vector<std::string>& tools = {"punch", "die", "blank_holder"}) const {
    std::vector<std::string> all;
    for (const std::string& tool : tools) {
      const std::string more = tool == "blank_holder" ? ", pressure: 2, ramp: 0.2e-3" : "";
      all.push_back("tools." + tool + "={stl: " + path(tool) + more + "}");
    }
    return all;
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace interply::test
