#include "solver_metal/law_constants.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace interply::metal {

Hill48Coefficients compute_hill48_coefficients(const scene::Hill48& r) {
  const double h = r.r0 / (1 + r.r0), scale = 1 / (r.r90 * (1 + r.r0));
  return {h, r.r0 * (1 + r.r90) * scale, (r.r0 + r.r90) * (1 + 2 * r.r45) * scale};
}

LawConstants::LawConstants(const scene::J2Law& law)
    : young(law.young),
      poisson(law.poisson),
      sum_modulus(law.young / (1 - law.poisson)),
      twice_shear(law.young / (1 + law.poisson)),
      hardening(law.hardening),
      is_hill48(law.hill48.has_value()) {
  if (!is_hill48) return;
  coefficients = compute_hill48_coefficients(*law.hill48);
  // C^(1/2) of plane stress: sum and difference of s11, s22 are its own modes
  const double sum = std::sqrt(sum_modulus), difference = std::sqrt(twice_shear);
  Eigen::Matrix2d root, inverse, yield;
  root << sum + difference, sum - difference, sum - difference, sum + difference;
  root /= 2;
  inverse << difference + sum, difference - sum, difference - sum, difference + sum;
  inverse /= 2 * sum * difference;
  yield << 1, -coefficients.h, -coefficients.h, coefficients.p;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> modes(root * yield * root);
  const Eigen::Matrix2d to = modes.eigenvectors().transpose() * inverse, from = root * modes.eigenvectors();
  for (int i = 0; i < 2; ++i) {
    rate[i] = modes.eigenvalues()(i);
    for (int j = 0; j < 2; ++j) {
      to_mode[i][j] = to(i, j);
      from_mode[i][j] = from(i, j);
    }
  }
  rate[2] = 0.5 * twice_shear * coefficients.q;
  shear_root = std::sqrt(0.5 * twice_shear);
}

}  // namespace interply::metal
