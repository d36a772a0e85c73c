/// `interply point`: the material-point driver as a person uses it, files in and CSV out.
#include "launch/point.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "solver_fabric/material_point.hpp"
#include "support/fabric_cases.hpp"
#include "support/vumat_laws.hpp"

namespace interply {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kLopsided =
    "law: {woven: {variant: full, a: [7.1e3, 4.3e3], b: [130, 75], c: [22, 31], p_min: [0.75, 0.6], d: [90, 140], "
    "s: [0.17, -0.53, 0.63], s_T: [260, 150], s_C: [700, 1300], strain_cap: [0.055, 0.07]}}\n";
constexpr const char* kSteel =
    "law: {j2: {young: 210e3, poisson: 0.3, hardening: {swift: {K: 530, e0: 0.0065, n: 0.23}}}}\n";

struct Outcome {
  int code;
  std::string out, err;
};

class Point : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("interply_point_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Outcome run(const std::string& law, const std::string& path, const std::vector<std::string>& overrides = {}) {
    std::ofstream(folder_ / "law.yaml") << law;
    std::ofstream(folder_ / "path.csv", std::ios::binary) << path;
    std::ostringstream out, err;
    const int code = launch::run_point(folder_ / "law.yaml", folder_ / "path.csv", out, err, overrides);
    return {code, out.str(), err.str()};
  }

  std::filesystem::path folder_;
};

/// CSV text as rows of name -> value.
std::vector<std::map<std::string, double>> read_csv(const std::string& text) {
  std::istringstream in(text);
  std::string line, cell;
  std::vector<std::string> names;
  std::getline(in, line);
  for (std::istringstream cells(line); std::getline(cells, cell, ',');) names.push_back(cell);
  std::vector<std::map<std::string, double>> rows;
  while (std::getline(in, line)) {
    rows.emplace_back();
    std::size_t i = 0;
    for (std::istringstream cells(line); std::getline(cells, cell, ',');)
      rows.back()[names.at(i++)] = std::strtod(cell.c_str(), nullptr);
  }
  return rows;
}

TEST_F(Point, WritesTheResponseOfAWovenLawToTheLastBit) {
  const Outcome o = run(kLopsided, "F11,F12,F21,F22\n1,0,0,1\n1.02,0.1,0,0.99\n0.98,-0.3,0.1,1.04\n");
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.err, IsEmpty());
  EXPECT_THAT(o.out, testing::StartsWith(
                         "F11,F12,F21,F22,I4,I8,gamma_rad,W_MPa,S11_MPa,S22_MPa,S12_MPa,min_eig_hessian_MPa\n"));
  std::vector<mechanics::Matrix2> path(3);
  path[0] << 1, 0, 0, 1;
  path[1] << 1.02, 0.1, 0, 0.99;
  path[2] << 0.98, -0.3, 0.1, 1.04;
  const auto expected = fabric::follow_path(fabric_cases::lopsided(), path);
  const auto rows = read_csv(o.out);
  ASSERT_EQ(rows.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    auto row = rows[i];
    EXPECT_EQ(row["F12"], path[i](0, 1));
    EXPECT_EQ(row["F21"], path[i](1, 0));
    EXPECT_EQ(row["I4"], expected[i].I4);
    EXPECT_EQ(row["I8"], expected[i].I8);
    EXPECT_EQ(row["gamma_rad"], expected[i].gamma);
    EXPECT_EQ(row["W_MPa"], expected[i].W);
    EXPECT_EQ(row["S11_MPa"], expected[i].S11);
    EXPECT_EQ(row["S22_MPa"], expected[i].S22);
    EXPECT_EQ(row["S12_MPa"], expected[i].S12);
    EXPECT_EQ(row["min_eig_hessian_MPa"], expected[i].smallest_eigenvalue);
  }
  auto sheared = rows[2];
  // f_a = (F11, F21), f_b = (F12, F22)
  EXPECT_NEAR(sheared["I4"], 0.98 * 0.98 + 0.1 * 0.1, 1e-14);
  EXPECT_NEAR(sheared["I8"], 0.3 * 0.3 + 1.04 * 1.04, 1e-14);
  EXPECT_NEAR(std::sin(sheared["gamma_rad"]), (-0.98 * 0.3 + 0.1 * 1.04) / std::sqrt(sheared["I4"] * sheared["I8"]),
              1e-14);
}

TEST_F(Point, ColumnsMayComeInAnyOrderAndWithBlanks) {
  const std::string a = run(kLopsided, "F11,F12,F21,F22\n1.02,0.1,0,0.99\n").out;
  EXPECT_EQ(run(kLopsided, "F22, F21 ,F11,F12\r\n0.99, 0, +1.02, 1e-1\r\n\r\n").out, a);
  EXPECT_EQ(run(kLopsided,
                "\xEF\xBB\xBF"
                "F11,F12,F21,F22\n1.02,0.1,0,0.99")
                .out,
            a);
  EXPECT_EQ(run(kLopsided, "F11,F12,F21,F22\r1.02,0.1,0,0.99\r").out, a);
}

TEST_F(Point, BadRowsAreRefusedWithFileAndLineAndNothingIsWritten) {
  const struct {
    const char *row, *why;
  } cases[] = {{"1,0,0", "3 columns"},
               {"1,0,0,1,2", "5 columns"},
               {"1,0,zero,1", "F21 is 'zero'"},
               {"1,0,,1", "F21 is ''"},
               {"1,0,0,1.0x", "F22 is '1.0x'"},
               {"nan,0,0,1", "F11 is 'nan'"},
               {"1,inf,0,1", "F12 is 'inf'"},
               {"1,1e999,0,1", "F12 is '1e999'"},
               {"1,0,0,-1", "det F"},
               {"1,1,1,1", "det F"},
               {"0,0,0,0", "det F"},
               {"1,1e30,0,1e-10", "90 deg"},
               {"1e200,0,0,1", "not finite"},
               {"50,0,0,1.2", ""}};
  for (const auto& [row, why] : cases) {
    const Outcome o = run(kLopsided, "F11,F12,F21,F22\n1,0,0,1\n\n" + std::string(row) + "\n1,0,0,1\n");
    if (std::string(why).empty()) {  // far, but finite: capped
      EXPECT_EQ(o.code, 0) << o.err;
      continue;
    }
    EXPECT_EQ(o.code, 2) << row;
    EXPECT_THAT(o.out, IsEmpty()) << row;
    EXPECT_THAT(o.err, AllOf(HasSubstr("path.csv:4: "), HasSubstr(why))) << row;
  }
}

TEST_F(Point, BadHeadersAndEmptyFilesAreRefused) {
  for (const char* header : {"F11,F12,F21\n1,0,0\n", "F11,F12,F21,F21\n1,0,0,1\n", "F11,F12,F21,F22,F33\n1,0,0,1,1\n",
                             "1,0,0,1\n1,0,0,1\n", "strain\n0.1\n"}) {
    const Outcome o = run(kLopsided, header);
    EXPECT_EQ(o.code, 2) << header;
    EXPECT_THAT(o.err, AllOf(HasSubstr("path.csv:1: "), HasSubstr("F11,F12,F21,F22"))) << header;
    EXPECT_THAT(o.out, IsEmpty());
  }
  EXPECT_THAT(run(kLopsided, "").err, HasSubstr("no header"));
  EXPECT_THAT(run(kLopsided, "F11,F12,F21,F22\n").err, HasSubstr("no rows"));
}

TEST_F(Point, MissingPathAndBadLawAreRefused) {
  std::ostringstream out, err;
  std::ofstream(folder_ / "law.yaml") << kLopsided;
  EXPECT_EQ(launch::run_point(folder_ / "law.yaml", folder_ / "absent.csv", out, err), 2);
  EXPECT_THAT(err.str(), HasSubstr("absent.csv"));
  const Outcome o = run("law: {woven: {p_min: 1.4}}\n", "F11,F12,F21,F22\n1,0,0,1\n");
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, AllOf(HasSubstr("p_min"), HasSubstr("1.4"), HasSubstr("law.yaml")));
  EXPECT_THAT(o.out, IsEmpty());
}

/// --set means what the same words in the file mean.
TEST_F(Point, OverridesKeysOfTheLaw) {
  const std::string path = "F11,F12,F21,F22\n1.02,0.1,0,0.99\n";
  std::string biaxial = kLopsided;
  biaxial.replace(biaxial.find("full"), 4, "biaxial");
  const Outcome written = run(biaxial, path), set = run(kLopsided, path, {"woven.variant=biaxial"});
  EXPECT_EQ(set.code, 0) << set.err;
  EXPECT_EQ(set.out, written.out);
  EXPECT_NE(set.out, run(kLopsided, path).out);
  const std::string unwrapped = std::string(kLopsided).substr(5);  // without `law: `
  EXPECT_EQ(run(unwrapped, path, {"woven.variant=full", "woven.variant=biaxial"}).out, written.out);
  const Outcome refused = run(kLopsided, path, {"woven.varant=biaxial"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_EQ(refused.err, "--set woven.varant=biaxial: law.woven.varant: unknown key; did you mean 'variant'?\n");
  EXPECT_THAT(run(kLopsided, path, {"woven.p_min=1.4"}).err, HasSubstr("p_min"));
  EXPECT_THAT(run(kLopsided, path, {"woven"}).err, HasSubstr("is not of the form path=value"));
}

/// `interply point --help` explains every column of every law, and of its path.
TEST_F(Point, ColumnsAreDocumented) {
  const auto header = [](const std::string& csv) { return csv.substr(0, csv.find('\n')); };
  const std::string vumat = header(launch::follow_path(test::make_vumat("woven", std::vector<double>(21, 1.0), 1),
                                                       "F11,F12,F21,F22\n1,0,0,1\n", "path.csv"));
  for (const std::string& names :
       {header(run(kLopsided, "F11,F12,F21,F22\n1,0,0,1\n").out), header(run(kSteel, "strain\n0\n").out), vumat}) {
    std::istringstream cells(names);
    for (std::string cell; std::getline(cells, cell, ',');)
      EXPECT_THAT(launch::kPointColumns, testing::ContainsRegex("[ ,]" + cell + "[ ,]"));
  }
}

TEST_F(Point, FollowsAMetalBarAlongItsTrueStrain) {
  const Outcome o = run(kSteel, "strain\n0\n0.0005\n0.1\n");
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, testing::StartsWith("strain,stress_MPa,plastic_strain,width_strain,thickness_strain\n"));
  const auto rows = read_csv(o.out);
  ASSERT_EQ(rows.size(), 3u);
  auto elastic = rows[1], plastic = rows[2];
  EXPECT_NEAR(elastic["stress_MPa"], 105, 1e-6);
  EXPECT_EQ(elastic["plastic_strain"], 0);
  EXPECT_NEAR(plastic["plastic_strain"], 0.1 - plastic["stress_MPa"] / 210e3, 1e-6);
  EXPECT_NEAR(plastic["stress_MPa"], 530 * std::pow(0.0065 + plastic["plastic_strain"], 0.23), 0.01);
  for (const char* row : {"0.1,0.2", "x", "nan", "1e9"}) {
    const Outcome bad = run(kSteel, std::string("strain\n0\n") + row + "\n");
    EXPECT_EQ(bad.code, 2) << row;
    EXPECT_THAT(bad.err, HasSubstr("path.csv:3: ")) << row;
    EXPECT_THAT(bad.out, IsEmpty());
  }
}

}  // namespace
}  // namespace interply
