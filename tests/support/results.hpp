/// One row of the verification table: the number that mechanics gives, ours, and the test that compares them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

namespace interply::test {

/// `ours` lies within `tolerance` of `reference`; with `absolute`, in the unit of the row, else relative.
struct Result {
  std::string row;       ///< id of the verification table, "V10"
  std::string quantity;  ///< "tip deflection of the cantilever, 45 deg of tip rotation"
  std::string source;    ///< of the reference: "elastica, shooting in the test"
  double reference = 0;
  double ours = 0;
  std::string unit;  ///< "mm"; empty: dimensionless
  double tolerance = 0.01;
  bool absolute = false;
  std::string mesh;                                         ///< finest mesh or step of the case, "3 mm, unstructured"
  double order = std::numeric_limits<double>::quiet_NaN();  ///< observed convergence order; NaN: exact or not a series
};

/// Order p of error ~ h^p from the two finest of a series, h descending.
inline double compute_order(const std::vector<double>& h, const std::vector<double>& error) {
  const std::size_t n = h.size();
  return std::log(std::abs(error[n - 2]) / std::abs(error[n - 1])) / std::log(h[n - 2] / h[n - 1]);
}

/// Fails the test where ours is outside its tolerance, and appends the row, tab separated, to the file that the
/// environment names in INTERPLY_RESULTS (tests/verification/RESULTS.md is made from it).
inline void expect_result(const Result& r) {
  const double error = r.ours - r.reference;
  const double allowed = r.absolute ? r.tolerance : r.tolerance * std::abs(r.reference);
  EXPECT_LE(std::abs(error), allowed) << r.row << ", " << r.quantity << ": " << r.ours << " against " << r.reference
                                      << " " << r.unit << " (" << r.source << ")";
  const char* file = std::getenv("INTERPLY_RESULTS");
  if (!file) return;
  std::ofstream out(file, std::ios::app);
  out.precision(6);
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  out << r.row << '\t' << r.quantity << '\t' << r.source << '\t' << r.reference << '\t' << r.ours << '\t' << r.unit
      << '\t' << error << '\t' << allowed << '\t' << r.mesh << '\t' << r.order << '\t' << test->test_suite_name() << '.'
      << test->name() << '\n';
}

}  // namespace interply::test
