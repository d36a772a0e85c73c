/// A J2 or Hill48 law in the form that its update needs.
#pragma once

#include "scene/scene.hpp"

namespace interply::metal {

/// Coefficients of (R1), hill48.hpp.
struct Hill48Coefficients {
  double h = 0.5, p = 1, q = 3;
};

/// @pre all r > 0
Hill48Coefficients compute_hill48_coefficients(const scene::Hill48& r);

struct LawConstants {
  explicit LawConstants(const scene::J2Law& law);

  double young, poisson;  ///< E, MPa; nu
  double sum_modulus;     ///< E/(1-nu): s11 + s22 over e11 + e22, MPa
  double twice_shear;     ///< 2G: s11 - s22 over e11 - e22 and s12 over e12, MPa
  scene::Hardening hardening;
  bool is_hill48;

  // hill48.hpp
  Hill48Coefficients coefficients;
  double rate[3] = {};                        ///< k_i of (R4), MPa; the third is the shear
  double to_mode[2][2]{}, from_mode[2][2]{};  ///< V' C^(-1/2) and C^(1/2) V of (s11, s22)
  double shear_root = 0;                      ///< sqrt(G): s12 = shear_root y_3
};

/// Hardening of a point and the multiplier of its last increment.
template <class Real>
struct Plastic {
  Real strain;                     ///< p, equivalent plastic strain
  Real yield_stress, yield_slope;  ///< sigma_y(p) and its slope, MPa
  Real multiplier;                 ///< l of (J3), 1/MPa; 0 where the point stayed elastic
};

/// The bracketed return (return_mapping.hpp), for points at which Halley's method does not converge. It is compiled
/// once, so that its bits do not depend on the width of the packs.
/// @param square  share of each mode in s_eq^2 of the trial state, MPa2
Plastic<double> return_to_yield_surface(const LawConstants& law, const double* square, const Plastic<double>& start);

}  // namespace interply::metal
