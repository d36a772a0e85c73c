/// Symmetric tensors of the tangent plane and the closed-form polar decomposition of its metric, over `Real`.
#pragma once

#include <cmath>

#include "simd/pack.hpp"

namespace interply::metal {

/// Symmetric 2 x 2 tensor of doubles or packs (simd/pack.hpp); the off-diagonal component is the tensor's own, not an
/// engineering shear.
template <class Real>
struct Tensor {
  Real m11, m22, m12;

  Real trace() const { return m11 + m22; }
  Real determinant() const { return m11 * m22 - m12 * m12; }

  friend Tensor operator+(const Tensor& a, const Tensor& b) { return {a.m11 + b.m11, a.m22 + b.m22, a.m12 + b.m12}; }
  friend Tensor operator-(const Tensor& a, const Tensor& b) { return {a.m11 - b.m11, a.m22 - b.m22, a.m12 - b.m12}; }
  friend Tensor operator*(const Real& s, const Tensor& a) { return {s * a.m11, s * a.m22, s * a.m12}; }
};
using Symmetric2 = Tensor<double>;

// With internal linkage, as kernel sources are compiled for different machines.
namespace {

/// a : b
template <class Real>
inline Real contract(const Tensor<Real>& a, const Tensor<Real>& b) {
  return a.m11 * b.m11 + a.m22 * b.m22 + Real(2.0) * (a.m12 * b.m12);
}

/// u x u, symmetric for symmetric u and x.
template <class Real>
inline Tensor<Real> compute_congruence(const Tensor<Real>& u, const Tensor<Real>& x) {
  const Real a11 = u.m11 * x.m11 + u.m12 * x.m12, a12 = u.m11 * x.m12 + u.m12 * x.m22;
  const Real a21 = u.m12 * x.m11 + u.m22 * x.m12, a22 = u.m12 * x.m12 + u.m22 * x.m22;
  return {a11 * u.m11 + a12 * u.m12, a21 * u.m12 + a22 * u.m22, a11 * u.m12 + a12 * u.m22};
}

/// Inverse of the right stretch U = simd::sqrt(C): by Cayley-Hamilton, with J = simd::sqrt(det C),
///
///   U = (C + J I) / simd::sqrt(tr C + 2 J),     U^-1 = adj(C + J I) / (J simd::sqrt(tr C + 2 J)) (S1)
///
/// @param c  metric C = F'F, positive definite
/// @param j  simd::sqrt(det C), the area ratio
template <class Real>
inline Tensor<Real> compute_inverse_stretch(const Tensor<Real>& c, const Real& j) {
  const Real s = Real(1.0) / (j * simd::sqrt(c.m11 + c.m22 + j + j));
  return {s * (c.m22 + j), s * (c.m11 + j), -s * c.m12};  // (S1)
}

/// Eigenvalues, the larger first.
template <class Real>
struct Principal {
  Real first, second;
};

template <class Real>
inline Principal<Real> compute_principal(const Tensor<Real>& a) {
  const Real mean = Real(0.5) * (a.m11 + a.m22), half = Real(0.5) * (a.m11 - a.m22);
  const Real radius = simd::sqrt(half * half + a.m12 * a.m12);
  return {mean + radius, mean - radius};
}

}  // namespace
}  // namespace interply::metal
