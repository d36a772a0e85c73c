/// Deformation of the fibres and stress of the constant-strain membrane triangle in the fibre frame, over `Real` as in
/// woven_law.hpp. The forces S gives are those of mechanics/edge_shell.hpp,
///   f_i = A t [ (S11 f_a + S12 f_b) dN_i/da + (S12 f_a + S22 f_b) dN_i/db ].
#pragma once

#include "mechanics/shell_kernels.hpp"
#include "solver_fabric/woven_law.hpp"

namespace interply::fabric {
namespace {

/// What the laws need of a deformation gradient with the columns f_a = F a0, f_b = F b0.
template <class Real>
struct FibreState {
  Real la, lb;                              ///< stretches, -
  Real inverse_a, inverse_b, inverse_area;  ///< 1/la, 1/lb, 1/J
  Real product;                             ///< f_a . f_b = la lb sin gamma
  Real gamma;                               ///< shear angle, positive where the fibres close in on each other, rad
  Real cosine;                              ///< of gamma
};

/// gamma from its tangent f_a.f_b/J: exact at zero, odd, and accurate up to folding, where asin of the sine is not.
/// @param f  f_a, f_b and J = |f_a x f_b|; its normal is not used. @pre J > 0
template <class Real>
FibreState<Real> compute_fibre_state(const mechanics::Facet<Real>& f) {
  FibreState<Real> s;
  s.la = sqrt(dot(f.f1, f.f1));
  s.lb = sqrt(dot(f.f2, f.f2));
  s.product = dot(f.f1, f.f2);
  s.inverse_a = Real(1.0) / s.la;
  s.inverse_b = Real(1.0) / s.lb;
  s.inverse_area = Real(1.0) / f.area_ratio;
  s.gamma = simd::atan(s.product * s.inverse_area);
  s.cosine = f.area_ratio * s.inverse_a * s.inverse_b;
  return s;
}

/// Second Piola-Kirchhoff stress in the fibre frame, MPa.
template <class Real>
struct MembraneStress {
  Real S11, S22, S12;
};

/// solver_fabric/THEORY.md: S11 = 2 W4 = W_a/la - tau tan(gamma)/I4, S22 = 2 W8 alike, S12 = Wab = tau/(cos(gamma) la
/// lb), where cos(gamma) = J/(la lb). @pre |gamma| < 90 deg, stretches > 0
template <class Real>
MembraneStress<Real> compute_membrane_stress(const Potential<Real>& w, const FibreState<Real>& s) {
  const Real S12 = w.tau * s.inverse_area, turned = S12 * s.product;
  return {(w.W_a - turned * s.inverse_a) * s.inverse_a, (w.W_b - turned * s.inverse_b) * s.inverse_b, S12};
}

}  // namespace
}  // namespace interply::fabric
