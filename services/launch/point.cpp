#include "launch/point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <numbers>
#include <ostream>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "geometry/read_file.hpp"
#include "geometry/text_lines.hpp"
#include "process/exit_codes.hpp"
#include "process/words.hpp"
#include "scene/read_scene.hpp"
#include "scene/report.hpp"
#include "solve/vumat.hpp"
#include "solve/vumat_probe.hpp"
#include "solver_fabric/material_point.hpp"
#include "solver_metal/material_point.hpp"

namespace interply::launch {

const char* const kPointColumns =
    R"(Both files are CSV with a header row; the response has one row per row of the path. Numbers without unit are ratios.

path of woven and vumat, in any order:
  F11,F12,F21,F22      in-plane deformation gradient: column 1 is where a unit of warp (or rolling direction) goes,
                       column 2 the same of the direction across it
path of j2:
  strain               true (logarithmic) strain along a bar whose sides are free, in the rolling direction

response of woven:
  F11,F12,F21,F22      of the path
  I4,I8                squared stretches of warp and weft
  gamma_rad            shear angle: 90 degrees less the angle from warp to weft
  W_MPa                strain energy per reference volume
  S11_MPa,S22_MPa,S12_MPa   second Piola-Kirchhoff stress: warp, weft, shear
  min_eig_hessian_MPa  of W in the stretches of warp and weft and gamma; negative: the law is not convex there
response of j2:
  strain               of the path
  stress_MPa           Cauchy stress along the bar
  plastic_strain       equivalent plastic strain
  width_strain,thickness_strain   true strains across the bar and through its thickness
response of vumat, one second per row, along straight lines from F = 1:
  F11,F12,F21,F22      of the path
  F33                  thickness stretch
  sigma11_MPa,sigma22_MPa,sigma12_MPa   Cauchy stress in the polar frame of the warp (or rolling) direction
  state_1,state_2,...  state variables, in their own units
)";

namespace {

constexpr double kPointDensity = 1e-9;    ///< t/mm3, of a point with a law of the user's own
constexpr double kLargestTrueStrain = 5;  ///< a bar drawn to 150 times its length; beyond it a row is a slip of the pen

[[noreturn]] void refuse(const std::string& origin, int line, const std::string& why) {
  throw PathError(process::to_line(fmt::format("{}:{}: {}", origin, line, why)));
}

/// One row of a path: its values in the order of the wanted columns, and where it stands.
struct Row {
  int line = 0;
  std::vector<double> values;
};

std::string_view open_csv(std::string_view content, const std::string& origin) {
  try {
    return geometry::open_text(content, origin);
  } catch (const geometry::Unreadable& error) {
    throw PathError(error.what());
  }
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const auto comma = line.find(',');
    cells.push_back(geometry::trim(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

/// Position of each wanted column in the header. Every wanted column must be there once, and no other.
std::vector<std::size_t> find_columns(const std::string& origin, int line, std::string_view header,
                                      const std::vector<std::string>& wanted) {
  const std::vector<std::string_view> cells = split(header);
  std::vector<std::size_t> columns;
  for (const std::string& name : wanted) {
    if (std::count(cells.begin(), cells.end(), name) != 1 || cells.size() != wanted.size())
      refuse(origin, line,
             fmt::format("the header is '{}' but must name the columns {}, each once, in any order", header,
                         fmt::join(wanted, ",")));
    columns.push_back(static_cast<std::size_t>(std::find(cells.begin(), cells.end(), name) - cells.begin()));
  }
  return columns;
}

double read_number(const std::string& origin, int line, const std::string& column, std::string_view cell) {
  std::string_view digits = cell;
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value))
    refuse(origin, line, fmt::format("{} is '{}', not a finite number", column, cell));
  return value;
}

/// All rows of a CSV text with exactly the columns `wanted`; empty lines are passed over.
std::vector<Row> parse_path(const std::string& csv, const std::string& origin, const std::vector<std::string>& wanted) {
  std::vector<std::size_t> columns;
  std::vector<Row> rows;
  geometry::Lines lines(open_csv(csv, origin), origin);
  while (lines.next()) {
    const int line = static_cast<int>(lines.number());
    const std::string_view content = lines.line();
    if (content.empty()) continue;
    if (columns.empty()) {
      columns = find_columns(origin, line, content, wanted);
      continue;
    }
    const std::vector<std::string_view> cells = split(content);
    if (cells.size() != wanted.size())
      refuse(origin, line, fmt::format("has {} columns where the header has {}", cells.size(), wanted.size()));
    Row row{line, {}};
    for (std::size_t i = 0; i < wanted.size(); ++i)
      row.values.push_back(read_number(origin, line, wanted[i], cells[columns[i]]));
    rows.push_back(row);
  }
  if (columns.empty())
    throw PathError(fmt::format("{}: has no header; its first line must be {}", origin, fmt::join(wanted, ",")));
  if (rows.empty()) throw PathError(fmt::format("{}: has no rows after its header", origin));
  return rows;
}

void check_finite(const std::string& origin, const Row& row, std::initializer_list<double> response) {
  for (const double value : response)
    if (!std::isfinite(value))
      refuse(origin, row.line, "the response of the law is not finite here; the deformation is too large for it");
}

void add_line(std::string& text, const std::vector<double>& values) {
  const char* separator = "";
  for (const double value : values) {
    text += fmt::format("{}{}", separator, value);  // shortest that reads back to the same
    separator = ",";
  }
  text += '\n';
}

/// In-plane deformation gradients of a path. @param rows  columns F11, F12, F21, F22
std::vector<mechanics::Matrix2> read_gradients(const std::vector<Row>& rows, const std::string& origin) {
  std::vector<mechanics::Matrix2> path;
  for (const Row& row : rows) {
    mechanics::Matrix2 F;
    F << row.values[0], row.values[1], row.values[2], row.values[3];
    if (!(F.determinant() > 0))
      refuse(origin, row.line, fmt::format("det F is {:.6g}, not > 0: the element would be folded", F.determinant()));
    const double dot = F.col(0).dot(F.col(1));
    if (!(std::abs(std::atan2(dot, F.determinant())) < std::numbers::pi / 2))
      refuse(origin, row.line, "the shear angle is 90 deg or more: the fibres lie on each other");
    path.push_back(F);
  }
  return path;
}

std::string follow(const scene::WovenLaw& law, const std::string& csv, const std::string& origin) {
  const std::vector<Row> rows = parse_path(csv, origin, {"F11", "F12", "F21", "F22"});
  const std::vector<mechanics::Matrix2> path = read_gradients(rows, origin);
  const std::vector<fabric::FabricPoint> points = fabric::follow_path(law, path);
  std::string text = "F11,F12,F21,F22,I4,I8,gamma_rad,W_MPa,S11_MPa,S22_MPa,S12_MPa,min_eig_hessian_MPa\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    const fabric::FabricPoint& p = points[i];
    check_finite(origin, rows[i], {p.I4, p.I8, p.gamma, p.W, p.S11, p.S22, p.S12, p.smallest_eigenvalue});
    const std::vector<double>& F = rows[i].values;
    add_line(text, {F[0], F[1], F[2], F[3], p.I4, p.I8, p.gamma, p.W, p.S11, p.S22, p.S12, p.smallest_eigenvalue});
  }
  return text;
}

std::string follow(const scene::J2Law& law, const std::string& csv, const std::string& origin) {
  const std::vector<Row> rows = parse_path(csv, origin, {"strain"});
  std::vector<double> strain;
  for (const Row& row : rows) {
    if (std::abs(row.values[0]) > kLargestTrueStrain)
      refuse(origin, row.line,
             fmt::format("strain is {:.6g}, not in [{}, {}]; it is the true strain, not per cent", row.values[0],
                         -kLargestTrueStrain, kLargestTrueStrain));
    strain.push_back(row.values[0]);
  }
  const std::vector<metal::MetalPoint> points = metal::follow_uniaxial_path(law, strain);
  std::string text = "strain,stress_MPa,plastic_strain,width_strain,thickness_strain\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    const metal::MetalPoint& p = points[i];
    check_finite(origin, rows[i], {p.stress, p.plastic_strain, p.width_strain, p.thickness_strain});
    add_line(text, {p.strain, p.stress, p.plastic_strain, p.width_strain, p.thickness_strain});
  }
  return text;
}

/// From F = 1 along straight lines from row to row, one second each, in increments of at most kLargestStep.
std::string follow(const scene::VumatLaw& law, const std::string& csv, const std::string& origin) {
  constexpr double kLargestStep = 1e-3;
  const std::vector<Row> rows = parse_path(csv, origin, {"F11", "F12", "F21", "F22"});
  const std::vector<mechanics::Matrix2> path = read_gradients(rows, origin);
  solve::VumatPoints point(law, "point", kPointDensity, 1);
  std::string text = "F11,F12,F21,F22,F33,sigma11_MPa,sigma22_MPa,sigma12_MPa";
  for (int i = 0; i < point.n_state(); ++i) text += fmt::format(",state_{}", i + 1);
  text += '\n';
  mechanics::Matrix2 from = mechanics::Matrix2::Identity();
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const mechanics::Matrix2 way = path[row] - from;
    const int parts = std::max(1, static_cast<int>(std::ceil(way.cwiseAbs().maxCoeff() / kLargestStep)));
    for (int i = 1; i <= parts; ++i) {
      const mechanics::Matrix2 F = i == parts ? path[row] : from + way * i / parts;
      if (!(F.determinant() > 0))
        refuse(origin, rows[row].line, "the straight way from the row before folds the element");
      const auto increment = solve::compute_vumat_increment(point.stretch(0), F.transpose() * F);
      point.advance(0, 1, &increment, {.time = static_cast<double>(row) + 1.0 * i / parts, .dt = 1.0 / parts});
    }
    const auto [sigma, thickness] = point.response(0);
    check_finite(origin, rows[row], {sigma(0, 0), sigma(1, 1), sigma(0, 1), thickness});
    const std::vector<double>& F = rows[row].values;
    std::vector<double> line{F[0], F[1], F[2], F[3], thickness, sigma(0, 0), sigma(1, 1), sigma(0, 1)};
    for (int i = 0; i < point.n_state(); ++i) line.push_back(point.state(i, 0));
    add_line(text, line);
    from = path[row];
  }
  return text;
}

std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in || in.bad()) throw PathError(fmt::format("{}: cannot be read; give a CSV file with --path", file.string()));
  return text;
}

}  // namespace

std::string follow_path(const scene::Law& law, const std::string& csv, const std::string& origin) {
  return std::visit([&](const auto& l) { return follow(l, csv, origin); }, law);
}

int run_point(const std::filesystem::path& law, const std::filesystem::path& path_csv, std::ostream& out,
              std::ostream& err, const std::vector<std::string>& overrides) {
  try {
    const scene::Law read = scene::read_law(law, overrides);
    if (const auto* own = std::get_if<scene::VumatLaw>(&read))
      for (const auto& warning : solve::probe_vumat(*own, "point", kPointDensity))
        err << "warning: " << warning << '\n';
    out << follow_path(read, read_text(path_csv), path_csv.string());
    return process::kDone;
  } catch (const scene::SceneError& e) {
    err << e.what() << '\n';
  } catch (const PathError& e) {
    err << e.what() << '\n';
  } catch (const mechanics::Divergence& e) {
    err << e.what() << '\n';
    return process::kDiverged;
  }
  return process::kRefused;
}

}  // namespace interply::launch
