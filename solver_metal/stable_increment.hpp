/// Bounds of the highest frequency of a sheet from its current elastic tangent (for J2 the elastic modulus is the upper
/// bound of the tangent). However the lumped mass of a node is divided among its elements, the highest frequency of the
/// mesh is at most that of any single element on its shares; and membrane and bending stiffness add up:
///
///   dt = 2 / w,   w^2 <= max over elements of (w_membrane^2 + w_bending^2)                               (T1)
///
/// Dividing the mass in proportion to the stiffness at the node, not evenly, keeps a badly shaped element from deciding
/// alone. That of bending is mechanics::compute_bending_frequencies2(). All here is derived and checked in the tests
/// against the largest eigenvalue of the assembled M^-1 K. Over `Real`,
/// one double or a pack (simd/pack.hpp).
#pragma once

#include "solver_metal/symmetric2.hpp"

namespace interply::metal {
namespace {

/// Largest w^2 of a constant-strain triangle on its shares of the nodal masses, 1/s2. With g_k = U^-1 dN_k/dX and the
/// current volume v, corner k gets the share v |g_k|^2 / q_k of its node's mass m_k, q_k = sum of v |g_k|^2 over the
/// elements of the node, and
///
///   w^2 = lambda_max(D B M^-1 B') v,     G = sum_k (q_k / m_k) g_k g_k' / |g_k|^2                        (T2)
///
/// In the principal axes of G (eigenvalues G1, G2) the 3 x 3 problem falls apart into shear G12 and a 2 x 2 block:
/// closed form, exact for the element. The stress adds at most |s| G1 by its geometric stiffness and 2 |s| G1 by the
/// change of U^-1 and of the volume, with |s| the largest principal stress.
/// @param gram    G of (T2), mm/t
/// @param stress  bound of |s|, MPa
template <class Real>
inline Real bound_membrane_frequency2(const Tensor<Real>& gram, double young, double poisson, const Real& stress) {
  const auto [g1, g2] = compute_principal(gram);
  const double d11 = young / (1 - poisson * poisson), d12 = poisson * d11, shear = 0.5 * young / (1 + poisson);
  // block [[d11 g1, d12 g2], [d12 g1, d11 g2]]
  const Real half = Real(0.5 * d11) * (g1 - g2);
  const Real normal = Real(0.5 * d11) * (g1 + g2) + simd::sqrt(half * half + Real(d12 * d12) * g1 * g2);
  return simd::max(normal, Real(shear) * (g1 + g2)) + Real(3.0) * stress * g1;  // (T2)
}

/// w_bending^2 against that of the flat sheet. Physical curvature is U^-1 kappa U^-1, and the columns of the edges grow
/// like the heights: with C1 >= C2 the eigenvalues of the metric and t the current thickness over the initial one,
///
///   J t^3 max(1, C1) / C2^2                                                                              (T3)
///
/// @param j  J, the area ratio
template <class Real>
inline Real compute_bending_growth(const Tensor<Real>& metric, const Real& j, const Real& t) {
  const auto [most, least] = compute_principal(metric);
  return j * t * t * t / (least * least) * simd::max(Real(1.0), most);  // (T3)
}

}  // namespace

}  // namespace interply::metal
