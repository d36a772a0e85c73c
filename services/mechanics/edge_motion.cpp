#include "mechanics/edge_motion.hpp"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>

namespace interply::mechanics {

namespace {

/// N_k (x) N_k as a strain (k11, k22, 2 k12).
Eigen::Vector3d compute_fold_direction(const ShellGeometry& s, int k, Eigen::Index e) {
  const double n1 = s.gradient(2 * k, e), n2 = s.gradient(2 * k + 1, e);
  return {n1 * n1, n2 * n2, 2 * n1 * n2};
}

/// B of one element: columns 0-2 own nodes, 3-5 the nodes beyond its edges, 6-8 its edges.
struct CurvatureOperator {
  Eigen::Matrix<double, 3, 9> columns = Eigen::Matrix<double, 3, 9>::Zero();
  std::array<int, 3> far{-1, -1, -1};
};

CurvatureOperator compute_curvature_operator(const ShellGeometry& s, Eigen::Index e) {
  CurvatureOperator b;
  const auto gradient = [&](int k, Eigen::Index of) {
    return Vector2(s.gradient(2 * k, of), s.gradient(2 * k + 1, of));
  };
  for (int k = 0; k < 3; ++k) {
    const double height = compute_reference_height(s, k, e);
    const Eigen::Vector3d fold = compute_fold_direction(s, k, e);
    b.columns.col(6 + k) = 2 * height * s.side(k, e) * fold;
    const int across = s.neighbour(k, e);
    if (across < 0) continue;
    const Vector2 outward = -height * gradient(k, e);
    // theta = slope of the facet across - own slope, both along `outward`; alpha = theta/2
    const double own_weight = across == e ? 2 : 1;  // the mirror image slopes the other way
    for (int i = 0; i < 3; ++i) b.columns.col(i) -= own_weight * height * gradient(i, e).dot(outward) * fold;
    if (across == e) continue;
    for (int i = 0; i < 3; ++i) {
      int slot = 3 + k;
      for (int own = 0; own < 3; ++own)
        if (s.nodes(own, e) == s.nodes(i, across)) slot = own;
      if (slot >= 3) b.far[k] = s.nodes(i, across);
      b.columns.col(slot) += height * gradient(i, across).dot(outward) * fold;
    }
  }
  return b;
}

}  // namespace

EdgeMotion::EdgeMotion(const ShellGeometry& shell, const Plate& plate)
    : inertia_(Scalars::Zero(shell.n_edges())),
      mobility_(inertia_),
      decay_(inertia_),
      angle_(inertia_),
      rate_(inertia_),
      torque_(inertia_),
      friction_(inertia_),
      kernels_(choose_shell_pass_kernels()) {
  Scalars stiffness = Scalars::Zero(shell.n_edges());
  for (Eigen::Index e = 0; e < shell.n_elements(); ++e)
    for (int k = 0; k < 3; ++k) {
      const double height = compute_reference_height(shell, k, e);
      const Eigen::Vector3d per_angle = 2 * height * compute_fold_direction(shell, k, e);
      const Eigen::Index i = shell.edge(k, e);
      inertia_(i) += plate.areal_density * shell.area(e) * height * height;  // (B7)
      stiffness(i) += shell.area(e) * per_angle.dot(plate.stiffness * per_angle);
    }
  decay_ = 2 * kEdgeDamping * (stiffness / inertia_).sqrt();
  for (Eigen::Index i = 0; i < shell.n_edges(); ++i) {
    const bool mirrored = !shell.mirror.col(i).isZero(0);
    mobility_(i) = mirrored ? 0 : 1 / inertia_(i);
  }
}

EdgeRows EdgeMotion::rows() {
  return {inertia_.data(), mobility_.data(), decay_.data(),   angle_.data(),
          rate_.data(),    torque_.data(),   friction_.data()};
}

void EdgeMotion::advance(double dt, Eigen::Index begin, Eigen::Index end) {
  if (dt != 0) kernels_.advance_edges(rows(), 0.5 * (last_dt_ + dt), dt, begin, end);
}

EdgeEnergies EdgeMotion::update_torques(const ShellRows& shell, double dt, Eigen::Index begin, Eigen::Index end) {
  return kernels_.update_torques(shell, rows(), dt, begin, end);
}

double EdgeMotion::finish(double dt, const EdgeEnergies& all) {
  const double left = all.kinetic - kinetic_ + all.friction;
  kinetic_ = all.kinetic;
  last_dt_ = dt;
  return left;
}

Scalars compute_bending_frequencies2(const ShellGeometry& shell, const Eigen::Matrix3d& stiffness, const Scalars& mass,
                                     const Scalars& inertia) {
  const Eigen::Index n = shell.n_elements();
  std::vector<CurvatureOperator> operators(static_cast<std::size_t>(n));
  // where each column of B takes its mass from: a node, or n_nodes + edge, or nowhere (free, mirrored)
  const auto find_source = [&](const CurvatureOperator& b, int slot, Eigen::Index e) -> Eigen::Index {
    if (slot < 3) return shell.nodes(slot, e);
    if (slot < 6) return b.far[static_cast<std::size_t>(slot - 3)];
    return mass.size() + shell.edge(slot - 6, e);
  };
  Scalars total = Scalars::Zero(mass.size() + inertia.size()), sources(total.size());
  sources << mass, inertia;
  for (Eigen::Index e = 0; e < n; ++e) {
    CurvatureOperator& b = operators[static_cast<std::size_t>(e)] = compute_curvature_operator(shell, e);
    for (int slot = 0; slot < 9; ++slot)
      if (const Eigen::Index i = find_source(b, slot, e); i >= 0)
        total(i) += shell.area(e) * b.columns.col(slot).squaredNorm();
  }
  const Eigen::Matrix3d root = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(stiffness).operatorSqrt();
  Scalars frequencies(n);
  for (Eigen::Index e = 0; e < n; ++e) {
    const CurvatureOperator& b = operators[static_cast<std::size_t>(e)];
    Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
    for (int slot = 0; slot < 9; ++slot) {
      const double square = b.columns.col(slot).squaredNorm();
      if (square == 0) continue;
      const Eigen::Index i = find_source(b, slot, e);
      gram += total(i) / (sources(i) * square) * b.columns.col(slot) * b.columns.col(slot).transpose();
    }
    const Eigen::Matrix3d product = root * gram * root;
    frequencies(e) = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(product, Eigen::EigenvaluesOnly).eigenvalues()(2);
  }
  return frequencies;
}

}  // namespace interply::mechanics
