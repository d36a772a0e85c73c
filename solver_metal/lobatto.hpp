/// Gauss-Lobatto rule through the thickness.
#pragma once

#include <vector>

namespace interply::metal {

/// Points xi in [-1, 1], ascending, faces included, and weights that sum to 1 (so that sums are thickness means).
/// Exact for polynomials up to degree 2n - 3. One point is the midsurface: a membrane.
struct ThicknessRule {
  std::vector<double> point, weight;

  int size() const { return static_cast<int>(point.size()); }
  /// sum w xi^2: 1/3 from three points on, 1 for two (its bending stiffness is three times too large), 0 for one.
  double second_moment() const;
};

/// @param n  number of points, 1 to 15
/// @throws std::invalid_argument
ThicknessRule make_lobatto_rule(int n);

}  // namespace interply::metal
