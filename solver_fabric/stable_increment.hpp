/// Upper bounds of the eigenfrequencies of a ply from its current tangent. [derived here; checked in the tests against
/// the exact eigenvalues of the assembled M^-1 K]
///
/// Each corner of a triangle carries rho A t/3, and node masses are sums of these, so the largest eigenvalue of M^-1 K
/// is at most the largest of any single element. With q = (la, lb, gamma) and element energy A t W(q),
///
///   K_el = A t [ B^T H B + sum_q W_q grad^2 q ],      omega_el^2 <= (3/rho) lambda_max(K_el/(A t))            (T1)
///
/// where H is the Hessian of W and the rows of B are, over the nodes k, with N,1 = dN_k/da, N,2 = dN_k/db,
///   grad la = a_hat N,1     grad lb = b_hat N,2     grad gamma = b_perp N,1/la + a_perp N,2/lb                   (T2)
/// (b_perp the in-plane unit vector normal to a_hat towards b). Bending adds its own largest frequency, that of
/// the flat reference (mechanics/edge_motion.hpp): shear and stretch change it by a few tens of per cent, but bending
/// is a few per cent of the membrane's squared frequency on any reasonable mesh, so the safety factor of the step
/// covers that.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "mechanics/edge_shell.hpp"
#include "solver_fabric/membrane.hpp"

namespace interply::fabric {

/// G_ab = sum_k dN_k,a dN_k,b of element `e`. [2 x 2] 1/mm2
inline mechanics::Matrix2 compute_gradient_products(const mechanics::ShellGeometry& shell, Eigen::Index e) {
  mechanics::Matrix2 g = mechanics::Matrix2::Zero();
  for (int k = 0; k < 3; ++k) {
    const mechanics::Vector2 n(shell.gradient(2 * k, e), shell.gradient(2 * k + 1, e));
    g += n * n.transpose();
  }
  return g;
}

/// Q = B B^T, the products of the rows (T2) summed over the nodes. [3 x 3] 1/mm2
inline Eigen::Matrix3d compute_kinematic_products(const FibreState& s, const mechanics::Matrix2& g) {
  Eigen::Matrix3d q;
  q(0, 0) = g(0, 0);
  q(1, 1) = g(1, 1);
  q(2, 2) = g(0, 0) / s.I4 + g(1, 1) / s.I8 - 2 * s.sin_gamma * g(0, 1) / (s.la * s.lb);
  q(0, 1) = q(1, 0) = s.sin_gamma * g(0, 1);
  q(0, 2) = q(2, 0) = s.cos_gamma * g(0, 1) / s.lb;
  q(1, 2) = q(2, 1) = s.cos_gamma * g(0, 1) / s.la;
  return q;
}

/// Largest eigenvalue of the product of two symmetric 2 x 2 matrices, one of them positive definite.
inline double compute_largest_eigenvalue(const mechanics::Matrix2& product) {
  const double half = product.trace() / 2;
  return half + std::sqrt(std::max(0.0, half * half - product.determinant()));
}

/// Bound of lambda_max(K_el/(A t)) in (T1), MPa/mm2. In-plane and normal motions of a flat triangle do not mix:
/// - in plane: lambda_max(H Q), Q = B B^T, plus the largest geometric term: W_a/la and W_b/lb act across the fibres
///   (dropped when compressive), and grad^2 gamma has the eigenvalues +-1/la^2, +-1/lb^2;
/// - normal: exactly the largest eigenvalue of S G.
/// H_11 and H_22 are raised to the stiffness at l = 1 of either side, so that slack or just straightened fibres, whose
/// stiffness jumps there, do not vote for a large increment.
inline double compute_membrane_eigenvalue_bound(const Potential& w, const FibreState& s, const mechanics::Matrix2& g,
                                                const scene::Pair& stiffness_floor) {
  Eigen::Matrix3d h = w.hessian();
  h(0, 0) = std::max(h(0, 0), stiffness_floor.warp);
  h(1, 1) = std::max(h(1, 1), stiffness_floor.weft);

  const Eigen::Matrix3d q = compute_kinematic_products(s, g);
  const Eigen::Matrix3d l = q.llt().matrixL();  // lambda(H Q) = lambda(L^T H L)
  const Eigen::Matrix3d product = l.transpose() * h * l;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(product, Eigen::EigenvaluesOnly);

  mechanics::Matrix2 scaled = g;  // sum over nodes of (N,1/la, N,2/lb) (x) itself
  scaled(0, 0) /= s.I4;
  scaled(1, 1) /= s.I8;
  scaled(0, 1) = scaled(1, 0) = g(0, 1) / (s.la * s.lb);
  const double across = std::max({0.0, w.W_a / s.la, w.W_b / s.lb});
  const double in_plane = std::max(0.0, solver.eigenvalues()(2)) + across * compute_largest_eigenvalue(g) +
                          std::abs(w.tau) * compute_largest_eigenvalue(scaled);

  const MembraneStress S = compute_membrane_stress(w, s);
  mechanics::Matrix2 stress;
  stress << S.S11, S.S12, S.S12, S.S22;
  return std::max(in_plane, compute_largest_eigenvalue(stress * g));
}

}  // namespace interply::fabric
