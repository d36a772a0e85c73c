#include "launch/point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <numbers>
#include <ostream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "scene/read_scene.hpp"
#include "solver_fabric/material_point.hpp"
#include "solver_metal/material_point.hpp"

namespace interply::launch {

namespace {

constexpr double kLargestTrueStrain = 5;  ///< a bar drawn to 150 times its length; beyond it a row is a slip of the pen

/// A path file that cannot be used; what() is one sentence with file and line.
class PathError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

[[noreturn]] void refuse(const std::filesystem::path& file, int line, const std::string& why) {
  throw PathError(fmt::format("{}:{}: {}", file.string(), line, why));
}

/// One row of a path: its values in the order of the wanted columns, and where it stands.
struct Row {
  int line = 0;
  std::vector<double> values;
};

std::string_view trim(std::string_view s) {
  const auto first = s.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const auto comma = line.find(',');
    cells.push_back(trim(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

/// Position of each wanted column in the header. Every wanted column must be there once, and no other.
std::vector<std::size_t> find_columns(const std::filesystem::path& file, int line, std::string_view header,
                                      const std::vector<std::string>& wanted) {
  const std::vector<std::string_view> cells = split(header);
  std::vector<std::size_t> columns;
  for (const std::string& name : wanted) {
    if (std::count(cells.begin(), cells.end(), name) != 1 || cells.size() != wanted.size())
      refuse(file, line,
             fmt::format("the header is '{}' but must name the columns {}, each once, in any order", header,
                         fmt::join(wanted, ",")));
    columns.push_back(static_cast<std::size_t>(std::find(cells.begin(), cells.end(), name) - cells.begin()));
  }
  return columns;
}

double read_number(const std::filesystem::path& file, int line, const std::string& column, std::string_view cell) {
  std::string_view digits = cell;
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value))
    refuse(file, line, fmt::format("{} is '{}', not a finite number", column, cell));
  return value;
}

/// All rows of a CSV file with exactly the columns `wanted`; empty lines are passed over.
std::vector<Row> read_path(const std::filesystem::path& file, const std::vector<std::string>& wanted) {
  std::ifstream in(file);
  if (!in) throw PathError(fmt::format("{}: cannot be read; give a CSV file with --path", file.string()));
  std::vector<std::size_t> columns;
  std::vector<Row> rows;
  std::string text;
  for (int line = 1; std::getline(in, text); ++line) {
    std::string_view content = text;
    if (line == 1 && content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);  // byte order mark
    content = trim(content);
    if (content.empty()) continue;
    if (columns.empty()) {
      columns = find_columns(file, line, content, wanted);
      continue;
    }
    const std::vector<std::string_view> cells = split(content);
    if (cells.size() != wanted.size())
      refuse(file, line, fmt::format("has {} columns where the header has {}", cells.size(), wanted.size()));
    Row row{line, {}};
    for (std::size_t i = 0; i < wanted.size(); ++i)
      row.values.push_back(read_number(file, line, wanted[i], cells[columns[i]]));
    rows.push_back(row);
  }
  if (in.bad()) throw PathError(fmt::format("{}: cannot be read to its end", file.string()));
  if (columns.empty())
    throw PathError(fmt::format("{}: has no header; its first line must be {}", file.string(), fmt::join(wanted, ",")));
  if (rows.empty()) throw PathError(fmt::format("{}: has no rows after its header", file.string()));
  return rows;
}

void check_finite(const std::filesystem::path& file, const Row& row, std::initializer_list<double> response) {
  for (const double value : response)
    if (!std::isfinite(value))
      refuse(file, row.line, "the response of the law is not finite here; the deformation is too large for it");
}

void add_line(std::string& text, std::initializer_list<double> values) {
  const char* separator = "";
  for (const double value : values) {
    text += fmt::format("{}{:.17g}", separator, value);
    separator = ",";
  }
  text += '\n';
}

std::string follow(const scene::WovenLaw& law, const std::filesystem::path& file) {
  const std::vector<Row> rows = read_path(file, {"F11", "F12", "F21", "F22"});
  std::vector<mechanics::Matrix2> path;
  for (const Row& row : rows) {
    mechanics::Matrix2 F;
    F << row.values[0], row.values[1], row.values[2], row.values[3];
    if (!(F.determinant() > 0))
      refuse(file, row.line, fmt::format("det F is {:.6g}, not > 0: the element would be folded", F.determinant()));
    const double dot = F.col(0).dot(F.col(1));
    if (!(std::abs(std::atan2(dot, F.determinant())) < std::numbers::pi / 2))
      refuse(file, row.line, "the shear angle is 90 deg or more: the fibres lie on each other");
    path.push_back(F);
  }
  const std::vector<fabric::FabricPoint> points = fabric::follow_path(law, path);
  std::string text = "F11,F12,F21,F22,I4,I8,gamma_rad,W_MPa,S11_MPa,S22_MPa,S12_MPa,min_eig_hessian_MPa\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    const fabric::FabricPoint& p = points[i];
    check_finite(file, rows[i], {p.I4, p.I8, p.gamma, p.W, p.S11, p.S22, p.S12, p.smallest_eigenvalue});
    const std::vector<double>& F = rows[i].values;
    add_line(text, {F[0], F[1], F[2], F[3], p.I4, p.I8, p.gamma, p.W, p.S11, p.S22, p.S12, p.smallest_eigenvalue});
  }
  return text;
}

std::string follow(const scene::J2Law& law, const std::filesystem::path& file) {
  const std::vector<Row> rows = read_path(file, {"strain"});
  std::vector<double> strain;
  for (const Row& row : rows) {
    if (std::abs(row.values[0]) > kLargestTrueStrain)
      refuse(file, row.line,
             fmt::format("strain is {:.6g}, not in [{}, {}]; it is the true strain, not per cent", row.values[0],
                         -kLargestTrueStrain, kLargestTrueStrain));
    strain.push_back(row.values[0]);
  }
  const std::vector<metal::MetalPoint> points = metal::follow_uniaxial_path(law, strain);
  std::string text = "strain,stress_MPa,plastic_strain,width_strain,thickness_strain\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    const metal::MetalPoint& p = points[i];
    check_finite(file, rows[i], {p.stress, p.plastic_strain, p.width_strain, p.thickness_strain});
    add_line(text, {p.strain, p.stress, p.plastic_strain, p.width_strain, p.thickness_strain});
  }
  return text;
}

}  // namespace

int run_point(const std::filesystem::path& law, const std::filesystem::path& path_csv, std::ostream& out,
              std::ostream& err) {
  try {
    out << std::visit([&](const auto& l) { return follow(l, path_csv); }, scene::read_law(law));
    return 0;
  } catch (const scene::SceneError& e) {
    err << e.what() << '\n';
  } catch (const PathError& e) {
    err << e.what() << '\n';
  }
  return 2;
}

}  // namespace interply::launch
