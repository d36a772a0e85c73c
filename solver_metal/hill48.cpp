#include "solver_metal/hill48.hpp"

#include <Eigen/Eigenvalues>

namespace interply::metal {

Hill48Coefficients compute_hill48_coefficients(const scene::Hill48& r) {
  const double h = r.r0 / (1 + r.r0), scale = 1 / (r.r90 * (1 + r.r0));
  return {h, r.r0 * (1 + r.r90) * scale, (r.r0 + r.r90) * (1 + 2 * r.r45) * scale};
}

Hill48Constants::Hill48Constants(const scene::J2Law& law)
    : j2(law), coefficients(compute_hill48_coefficients(*law.hill48)) {
  // C^(1/2) of plane stress: sum and difference of s11, s22 are its own modes
  const double sum = std::sqrt(j2.sum_modulus), difference = std::sqrt(j2.twice_shear);
  Eigen::Matrix2d root, inverse, yield;
  root << sum + difference, sum - difference, sum - difference, sum + difference;
  root /= 2;
  inverse << difference + sum, difference - sum, difference - sum, difference + sum;
  inverse /= 2 * sum * difference;
  yield << 1, -coefficients.h, -coefficients.h, coefficients.p;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> modes(root * yield * root);
  const Eigen::Matrix2d to = modes.eigenvectors().transpose() * inverse, from = root * modes.eigenvectors();
  for (int i = 0; i < 2; ++i) {
    rate[static_cast<std::size_t>(i)] = modes.eigenvalues()(i);
    for (int j = 0; j < 2; ++j) {
      to_mode[i][j] = to(i, j);
      from_mode[i][j] = from(i, j);
    }
  }
  rate[2] = 0.5 * j2.twice_shear * coefficients.q;
  shear_root = std::sqrt(0.5 * j2.twice_shear);
}

double update_plastic_strain(const Hill48Constants& law, const std::array<double, 3>& square, J2Point& point) {
  constexpr double kNearlyConverged = 1e-8;  // of (R5) / yield stress: one more linear step leaves its square
  constexpr int kMaxIterations = 80;         // the bracket alone is exhausted by then
  const auto& k = law.rate;
  const double trial = std::sqrt(square[0] + square[1] + square[2]);
  // perfect plasticity with the softest of the rates returns at least this far
  double low = 0, high = (trial / point.yield.stress - 1) / std::min({k[0], k[1], k[2]});
  // first guess: exact for linear hardening where all rates are equal
  const double rate = (square[0] * k[0] + square[1] * k[1] + square[2] * k[2]) / (trial * trial);
  const double guess = (trial - point.yield.stress) / (rate + point.yield.slope);
  double l = std::clamp(guess / (trial - rate * guess), 0.0, high);
  double p = point.plastic_strain;
  YieldStress y = point.yield;
  for (int i = 0; i < kMaxIterations; ++i) {
    double sum = 0, fall = 0;
    for (int m = 0; m < 3; ++m) {
      const double shrink = 1 / (1 + k[m] * l), part = square[m] * shrink * shrink;
      sum += part;
      fall -= part * k[m] * shrink;
    }
    const double equivalent = std::sqrt(sum);  // (R4)
    fall /= equivalent;
    p = point.plastic_strain + l * equivalent;
    y = compute_yield_stress(law.j2.hardening, p);
    const double g = equivalent - y.stress;  // (R5)
    const double dp = equivalent + l * fall, step = -g / (fall - y.slope * dp);
    if (std::fabs(g) <= kNearlyConverged * y.stress) {
      l += step;
      p += dp * step;
      y.stress += y.slope * dp * step;
      break;
    }
    (g > 0 ? low : high) = l;
    l = l + step > low && l + step < high ? l + step : 0.5 * (low + high);
  }
  point.plastic_strain = p;
  point.yield = y;
  return l;
}

double update_point(const Hill48Constants& law, const Symmetric2& de, J2Point& point) {
  const double old_sum = point.stress.trace();
  const double a = law.j2.sum_modulus * de.trace(), b = law.j2.twice_shear * (de.m11 - de.m22);
  Symmetric2 s = point.stress + Symmetric2{0.5 * (a + b), 0.5 * (a - b), law.j2.twice_shear * de.m12};
  const double trial = compute_hill48(law.coefficients, s);
  double plastic = 0;
  if (trial > point.yield.stress) {
    std::array<double, 3> y{law.to_mode[0][0] * s.m11 + law.to_mode[0][1] * s.m22,
                            law.to_mode[1][0] * s.m11 + law.to_mode[1][1] * s.m22, s.m12 / law.shear_root};
    const auto& k = law.rate;
    const std::array<double, 3> square{k[0] * y[0] * y[0], k[1] * y[1] * y[1], k[2] * y[2] * y[2]};
    const double l = update_plastic_strain(law, square, point);
    for (std::size_t m = 0; m < 3; ++m) y[m] /= 1 + k[m] * l;  // (R4)
    s = {law.from_mode[0][0] * y[0] + law.from_mode[0][1] * y[1],
         law.from_mode[1][0] * y[0] + law.from_mode[1][1] * y[1], law.shear_root * y[2]};
    const auto& c = law.coefficients;
    plastic = l * ((1 - c.h) * s.m11 + (c.p - c.h) * s.m22);
  }
  point.stress = s;
  return -law.j2.poisson / law.j2.young * (s.trace() - old_sum) - plastic;
}

}  // namespace interply::metal
