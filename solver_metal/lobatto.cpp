#include "solver_metal/lobatto.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace interply::metal {

double ThicknessRule::second_moment() const {
  double sum = 0;
  for (int i = 0; i < size(); ++i) sum += weight[i] * point[i] * point[i];
  return sum;
}

ThicknessRule make_lobatto_rule(int n) {
  if (n < 1 || n > 15) throw std::invalid_argument("integration_points: " + std::to_string(n) + " is not in 1 to 15");
  if (n == 1) return {{0.0}, {1.0}};
  ThicknessRule rule{std::vector<double>(n), std::vector<double>(n)};
  // the points are the extrema of the Legendre polynomial P of degree m = n - 1 and the ends:
  // (1 - x^2) P' = m (P_{m-1} - x P) = 0, solved by Newton from the Chebyshev-Lobatto points
  const int m = n - 1;
  for (int i = 0; i < n; ++i) {
    double x = -std::cos(std::numbers::pi * i / m);
    double p = 1;
    for (int iteration = 0; iteration < 50; ++iteration) {
      double before = 1;
      p = x;
      for (int k = 2; k <= m; ++k) {
        const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
      }
      const double step = (x * p - before) / (n * p);
      x -= step;
      if (std::fabs(step) < 1e-16) break;
    }
    rule.point[i] = 2 * i == m ? 0.0 : x;
    rule.weight[i] = 1.0 / (m * n * p * p);  // 2/(n(n-1) P^2), halved
  }
  return rule;
}

}  // namespace interply::metal
