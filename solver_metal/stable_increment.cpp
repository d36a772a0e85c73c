#include "solver_metal/stable_increment.hpp"

#include <algorithm>
#include <cmath>

namespace interply::metal {

double bound_membrane_frequency2(const Symmetric2& gram, double young, double poisson, double stress) {
  const auto [g1, g2] = compute_principal(gram);
  const double d11 = young / (1 - poisson * poisson), d12 = poisson * d11, shear = 0.5 * young / (1 + poisson);
  // block [[d11 g1, d12 g2], [d12 g1, d11 g2]]
  const double half = 0.5 * d11 * (g1 - g2);
  const double normal = 0.5 * d11 * (g1 + g2) + std::sqrt(half * half + d12 * d12 * g1 * g2);
  return std::max(normal, shear * (g1 + g2)) + 3 * stress * g1;  // (T2)
}

double compute_bending_growth(const Symmetric2& metric, double t) {
  const auto [most, least] = compute_principal(metric);
  return std::sqrt(metric.determinant()) * t * t * t / (least * least) * std::max(1.0, most);  // (T3)
}

}  // namespace interply::metal
