/// One step of one shell triangle, as functions of values.
///
/// Polar (Green-Naghdi) frame: with F = R U, C = U U, stress and strain increments are components in the frame R of the
/// element, so a rigid motion leaves everything alone. A fibre at height z (> 0 towards t3) has the metric
/// E_ab - z kappa_ab, and the increment of its logarithmic strain is
///
///   de(z) = Um^-1 (dE - z dkappa) Um^-1,     Cm = (C_n + C_{n+1})/2 = Um Um                             (E1)
///
/// second order in the increment. Stress resultants per reference width, work conjugate to dE and dkappa:
///
///   N =  J t U^-1 <s> U^-1,     M = -J t U^-1 <z s> U^-1                                                (E2)
///
/// with < > the thickness mean. Heights follow the current thickness t; z = t xi / 2, |xi| <= 1.
/// Where this is approximate: the volume ratio dz of fibres at z against the midsurface, 1 + O(z kappa), is dropped, as
/// in every thin-shell theory, and the change of z itself does no work.
#pragma once

#include <cmath>

#include "solver_metal/symmetric2.hpp"

namespace interply::metal {

/// Measures of one element at one instant, in the reference frame x, y.
struct ElementShape {
  Symmetric2 metric{};     ///< C = F'F
  Symmetric2 curvature{};  ///< kappa, 1/mm
  double area_ratio = 1;   ///< J = sqrt(det C)
};

/// Logarithmic strain increment of the fibre at xi: membrane + xi * bending.
struct StrainIncrement {
  Symmetric2 membrane{}, bending{};
};

/// (E1). The thickness at the middle of the step is the one of constant volume, exact for plastic flow; its elastic
/// error is a fraction of the elastic strain increment.
/// @param thickness  at `before`, mm
inline StrainIncrement compute_strain_increment(const ElementShape& before, const ElementShape& now, double thickness) {
  const Symmetric2 middle = 0.5 * (before.metric + now.metric);
  const double j = std::sqrt(middle.determinant());
  const Symmetric2 u = compute_inverse_stretch(middle, j);
  const double half_thickness = 0.5 * thickness * before.area_ratio / j;
  return {compute_congruence(u, 0.5 * (now.metric - before.metric)),
          compute_congruence(u, -half_thickness * (now.curvature - before.curvature))};  // (E1)
}

/// Membrane force N (N/mm) and moment M (N), contravariant components in the reference frame per reference width.
struct Resultants {
  Symmetric2 force{}, moment{};
};

/// (E2).
/// @param mean    <s>, MPa
/// @param moment  <xi s>, MPa
inline Resultants compute_resultants(const ElementShape& now, double thickness, const Symmetric2& mean,
                                     const Symmetric2& moment) {
  const Symmetric2 u = compute_inverse_stretch(now.metric, now.area_ratio);
  const double volume = now.area_ratio * thickness;
  return {compute_congruence(u, volume * mean), compute_congruence(u, (-0.5 * thickness * volume) * moment)};  // (E2)
}

}  // namespace interply::metal
