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
///
/// Over `Real` as in woven_law.hpp.
#pragma once

#include "mechanics/shell_kernels.hpp"
#include "solver_fabric/membrane.hpp"

namespace interply::fabric {
namespace {

/// Symmetric 2 x 2 matrix.
template <class Real>
struct Symmetric {
  Real m11, m22, m12;
};

/// Symmetric 3 x 3 matrix in the order 11, 22, 33, 12, 13, 23.
template <class Real>
struct Symmetric3 {
  Real m[6];
};

/// Of the product of two symmetric matrices, one of them positive definite.
template <class Real>
Real compute_largest_eigenvalue(const Symmetric<Real>& a, const Symmetric<Real>& b) {
  const Real half = Real(0.5) * (a.m11 * b.m11 + a.m22 * b.m22) + a.m12 * b.m12;
  const Real determinant = (a.m11 * a.m22 - a.m12 * a.m12) * (b.m11 * b.m22 - b.m12 * b.m12);
  return half + sqrt(max(Real(0.0), half * half - determinant));
}

/// Of H Q, H symmetric and Q positive definite, both 3 x 3: from the right end of the interval that holds the roots of
/// the characteristic polynomial, m + 2 p, Newton's method comes down to the largest one and never below it. Eight
/// steps leave at most p/256 (a double root), else round-off.
template <class Real>
Real compute_largest_eigenvalue(const Symmetric3<Real>& H, const Symmetric3<Real>& Q) {
  const Real(&h)[6] = H.m, (&q)[6] = Q.m;
  const auto determinant = [](const Real(&a)[6]) {
    return a[0] * (a[1] * a[2] - a[5] * a[5]) - a[3] * (a[3] * a[2] - a[5] * a[4]) + a[4] * (a[3] * a[5] - a[1] * a[4]);
  };
  const Real m00 = h[0] * q[0] + h[3] * q[3] + h[4] * q[4], m01 = h[0] * q[3] + h[3] * q[1] + h[4] * q[5];
  const Real m02 = h[0] * q[4] + h[3] * q[5] + h[4] * q[2], m10 = h[3] * q[0] + h[1] * q[3] + h[5] * q[4];
  const Real m11 = h[3] * q[3] + h[1] * q[1] + h[5] * q[5], m12 = h[3] * q[4] + h[1] * q[5] + h[5] * q[2];
  const Real m20 = h[4] * q[0] + h[5] * q[3] + h[2] * q[4], m21 = h[4] * q[3] + h[5] * q[1] + h[2] * q[5];
  const Real m22 = h[4] * q[4] + h[5] * q[5] + h[2] * q[2];
  const Real trace = m00 + m11 + m22, product = determinant(h) * determinant(q);
  const Real minors = m00 * m11 - m01 * m10 + m00 * m22 - m02 * m20 + m11 * m22 - m12 * m21;
  const Real mean = Real(1.0 / 3) * trace, p = sqrt(max(Real(0.0), mean * mean - Real(1.0 / 3) * minors));
  Real root = mean + Real(2.0) * p;
  for (int i = 0; i < 8; ++i) {
    const Real value = ((root - trace) * root + minors) * root - product;
    const Real slope = (Real(3.0) * root - Real(2.0) * trace) * root + minors;
    root = select(value > Real(0.0) && slope > Real(0.0), root - value / slope, root);
  }
  return root;
}

/// G_ab = sum_k dN_k,a dN_k,b, 1/mm2.
template <class Real>
Symmetric<Real> compute_gradient_products(const mechanics::Gradient<Real>& n) {
  Symmetric<Real> g{Real(0.0), Real(0.0), Real(0.0)};
  for (int k = 0; k < 3; ++k) {
    g.m11 += n.n1[k] * n.n1[k];
    g.m22 += n.n2[k] * n.n2[k];
    g.m12 += n.n1[k] * n.n2[k];
  }
  return g;
}

/// sum over the nodes of (N,1/la, N,2/lb) (x) itself, 1/mm2.
template <class Real>
Symmetric<Real> compute_scaled_products(const FibreState<Real>& s, const Symmetric<Real>& g) {
  return {g.m11 * s.inverse_a * s.inverse_a, g.m22 * s.inverse_b * s.inverse_b, g.m12 * (s.inverse_a * s.inverse_b)};
}

/// Q = B B^T, the products of the rows (T2) summed over the nodes, 1/mm2.
template <class Real>
Symmetric3<Real> compute_kinematic_products(const FibreState<Real>& s, const Symmetric<Real>& g) {
  const Symmetric<Real> scaled = compute_scaled_products(s, g);
  const Real sine = s.product * (s.inverse_a * s.inverse_b);
  return {{g.m11, g.m22, scaled.m11 + scaled.m22 - Real(2.0) * sine * scaled.m12, sine * g.m12,
           s.cosine * g.m12 * s.inverse_b, s.cosine * g.m12 * s.inverse_a}};
}

/// Bound of lambda_max(K_el/(A t)) in (T1), MPa/mm2. In-plane and normal motions of a flat triangle do not mix:
/// - in plane: lambda_max(H Q), Q = B B^T, plus the largest geometric term: W_a/la and W_b/lb act across the fibres
///   (dropped when compressive), and grad^2 gamma has the eigenvalues +-1/la^2, +-1/lb^2;
/// - normal: exactly the largest eigenvalue of S G.
/// H_11 and H_22 are raised to the stiffness at l = 1 of either side, so that slack or just straightened fibres, whose
/// stiffness jumps there, do not vote for a large increment.
/// @param stiffness_floor  of warp and weft, MPa
template <class Real>
[[gnu::always_inline]] inline Real compute_membrane_eigenvalue_bound(const Potential<Real>& w,
                                                                     const FibreState<Real>& s,
                                                                     const Symmetric<Real>& g,
                                                                     const double (&stiffness_floor)[2]) {
  const MembraneStress<Real> S = compute_membrane_stress(w, s);
  const Symmetric<Real> scaled = compute_scaled_products(s, g);
  const Symmetric3<Real> h{
      {max(w.W_aa, Real(stiffness_floor[0])), max(w.W_bb, Real(stiffness_floor[1])), w.W_gg, w.W_ab, w.W_ag, w.W_bg}};
  const Real zero(0.0), one(1.0);
  const Symmetric<Real> identity{one, one, zero};
  const Real across = max(zero, max(w.W_a * s.inverse_a, w.W_b * s.inverse_b));
  const Real in_plane = max(zero, compute_largest_eigenvalue(h, compute_kinematic_products(s, g))) +
                        across * compute_largest_eigenvalue(identity, g) +
                        abs(w.tau) * compute_largest_eigenvalue(identity, scaled);
  return max(in_plane, compute_largest_eigenvalue(Symmetric<Real>{S.S11, S.S22, S.S12}, g));
}

}  // namespace
}  // namespace interply::fabric
