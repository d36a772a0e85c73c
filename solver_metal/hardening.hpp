/// Isotropic hardening curves: yield stress over equivalent plastic strain.
#pragma once

#include "scene/scene.hpp"

namespace interply::metal {

/// sigma_y(p) and its slope.
struct YieldStress {
  double stress = 0;  ///< MPa
  double slope = 0;   ///< d sigma_y / dp, MPa; may be infinite at p = 0 (Hockett-Sherby, n < 1)
};

/// Swift         K (e0 + p)^n                                  (H1)   @pre e0 > 0
/// Voce          s_inf - (s_inf - s0) exp(-rate p)             (H2)
/// Hockett-Sherby  s_inf - (s_inf - s0) exp(-rate p^n)         (H3)
/// table         piecewise linear, constant before its first and beyond its last point
/// @param p  equivalent plastic strain, >= 0
YieldStress compute_yield_stress(const scene::Hardening& hardening, double p);

}  // namespace interply::metal
