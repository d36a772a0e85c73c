#include "solver_metal/stable_increment.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace interply::metal {

namespace {

/// Columns: derivatives of (k11, k22, 2 k12) of the flat patch by the normal displacement of its six slots, 1/mm2.
Eigen::Matrix<double, 3, 6> compute_curvature_operator(const mechanics::ShellPatches& p, Eigen::Index e) {
  mechanics::Curvature flat;
  for (int side = 0; side < 3; ++side) {
    const bool is_free = p.side_gradient.block(6 * side, e, 6, 1).isZero(0);
    flat.rho[side] = is_free ? mechanics::Matrix2::Zero().eval() : mechanics::Matrix2::Identity().eval();
  }
  Eigen::Matrix<double, 3, 6> operator_;
  for (int c = 0; c < 3; ++c) {
    double force[6];
    mechanics::compute_bending_forces(p, e, flat, c == 0, c == 1, c == 2, force);
    for (int slot = 0; slot < 6; ++slot) operator_(c, slot) = force[slot] / p.area(e);
  }
  return operator_;
}

}  // namespace

double bound_membrane_frequency2(const Symmetric2& gram, double young, double poisson, double stress) {
  const auto [g1, g2] = compute_principal(gram);
  const double d11 = young / (1 - poisson * poisson), d12 = poisson * d11, shear = 0.5 * young / (1 + poisson);
  // block [[d11 g1, d12 g2], [d12 g1, d11 g2]]
  const double half = 0.5 * d11 * (g1 - g2);
  const double normal = 0.5 * d11 * (g1 + g2) + std::sqrt(half * half + d12 * d12 * g1 * g2);
  return std::max(normal, shear * (g1 + g2)) + 3 * stress * g1;  // (T2)
}

mechanics::Scalars compute_bending_compliance(const mechanics::ShellPatches& p, const mechanics::Scalars& mass,
                                              double poisson) {
  mechanics::Scalars stiffness = mechanics::Scalars::Zero(mass.size());  // q of each node, as in (T2)
  for (Eigen::Index e = 0; e < p.n_elements(); ++e) {
    const auto b = compute_curvature_operator(p, e);
    for (int slot = 0; slot < 6; ++slot) stiffness(p.nodes(slot, e)) += p.area(e) * b.col(slot).squaredNorm();
  }
  Eigen::Matrix3d d;
  d << 1, poisson, 0, poisson, 1, 0, 0, 0, 0.5 * (1 - poisson);
  const Eigen::Matrix3d root = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(d).operatorSqrt();

  mechanics::Scalars compliance(p.n_elements());
  for (Eigen::Index e = 0; e < p.n_elements(); ++e) {
    const auto b = compute_curvature_operator(p, e);
    Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
    for (int slot = 0; slot < 6; ++slot) {
      const double square = b.col(slot).squaredNorm();
      if (square == 0) continue;  // free side
      const int node = p.nodes(slot, e);
      gram += (stiffness(node) / (mass(node) * square)) * b.col(slot) * b.col(slot).transpose();
    }
    const Eigen::Matrix3d product = root * gram * root;
    compliance(e) = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(product, Eigen::EigenvaluesOnly).eigenvalues()(2);
  }
  return compliance;
}

}  // namespace interply::metal
