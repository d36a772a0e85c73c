/// Symmetric tensors of the tangent plane and the closed-form polar decomposition of its metric.
#pragma once

#include <cmath>

namespace interply::metal {

/// Symmetric 2 x 2 tensor; the off-diagonal component is the tensor's own, not an engineering shear.
struct Symmetric2 {
  double m11 = 0, m22 = 0, m12 = 0;

  double trace() const { return m11 + m22; }
  double determinant() const { return m11 * m22 - m12 * m12; }
};

inline Symmetric2 operator+(const Symmetric2& a, const Symmetric2& b) {
  return {a.m11 + b.m11, a.m22 + b.m22, a.m12 + b.m12};
}
inline Symmetric2 operator-(const Symmetric2& a, const Symmetric2& b) {
  return {a.m11 - b.m11, a.m22 - b.m22, a.m12 - b.m12};
}
inline Symmetric2 operator*(double s, const Symmetric2& a) { return {s * a.m11, s * a.m22, s * a.m12}; }

/// a : b
inline double contract(const Symmetric2& a, const Symmetric2& b) {
  return a.m11 * b.m11 + a.m22 * b.m22 + 2 * a.m12 * b.m12;
}

/// u x u, symmetric for symmetric u and x.
inline Symmetric2 compute_congruence(const Symmetric2& u, const Symmetric2& x) {
  const double a11 = u.m11 * x.m11 + u.m12 * x.m12, a12 = u.m11 * x.m12 + u.m12 * x.m22;
  const double a21 = u.m12 * x.m11 + u.m22 * x.m12, a22 = u.m12 * x.m12 + u.m22 * x.m22;
  return {a11 * u.m11 + a12 * u.m12, a21 * u.m12 + a22 * u.m22, a11 * u.m12 + a12 * u.m22};
}

/// Inverse of the right stretch U = sqrt(C): by Cayley-Hamilton, with J = sqrt(det C),
///
///   U = (C + J I) / sqrt(tr C + 2 J),     U^-1 = adj(C + J I) / (J sqrt(tr C + 2 J))                    (S1)
///
/// @param c  metric C = F'F, positive definite
/// @param j  sqrt(det C), the area ratio
inline Symmetric2 compute_inverse_stretch(const Symmetric2& c, double j) {
  const double s = 1 / (j * std::sqrt(c.trace() + 2 * j));
  return {s * (c.m22 + j), s * (c.m11 + j), -s * c.m12};  // (S1)
}

/// Eigenvalues, the larger first.
struct Principal {
  double first = 0, second = 0;
};

inline Principal compute_principal(const Symmetric2& a) {
  const double mean = 0.5 * a.trace(), half = 0.5 * (a.m11 - a.m22);
  const double radius = std::sqrt(half * half + a.m12 * a.m12);
  return {mean + radius, mean - radius};
}

}  // namespace interply::metal
