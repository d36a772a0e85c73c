/// A J2 or Hill48 law as plain numbers, for kernels (metal_kernels.hpp).
#pragma once

namespace interply::metal {

struct J2Constants;
struct Hill48Constants;

/// Formulas of hardening.hpp.
enum class Curve { Swift, Voce, HockettSherby, Table };

/// Constants of a hardening curve; those that its formula does not have stay 0.
struct CurveConstants {
  Curve curve = Curve::Swift;
  double strength = 0;             ///< K or s_inf, MPa
  double start = 0;                ///< s0, MPa
  double offset = 0;               ///< e0
  double rate = 0;                 ///< rate
  double exponent = 0;             ///< n
  const double* points = nullptr;  ///< of the table: strain, stress (MPa), strain, stress, ...
  int n_points = 0;
};

/// Constants of j2_law.hpp and hill48.hpp.
struct LawConstants {
  double young = 0, poisson = 0;            ///< E, MPa; nu
  double sum_modulus = 0, twice_shear = 0;  ///< MPa
  CurveConstants curve;
  const J2Constants* j2 = nullptr;          ///< what these are made of
  const Hill48Constants* hill48 = nullptr;  ///< null for J2

  // Hill48
  double h = 0, p = 0, q = 0;  ///< of (R1)
  double rate[3] = {};         ///< k_i of (R4), MPa
  double to_mode[2][2] = {}, from_mode[2][2] = {}, shear_root = 0;
};

/// What is given outlives the constants. @param hill48  null for J2
LawConstants make_law_constants(const J2Constants& j2, const Hill48Constants* hill48);

/// Hardening of a point and the multiplier of its last increment.
struct PlasticPoint {
  double plastic_strain = 0, yield_stress = 0, yield_slope = 0;  ///< p, sigma_y(p) and its slope, MPa
  double multiplier = 0;                                         ///< l of (J3) or (R5), 1/MPa
};

/// The return by the reference code, for points at which a kernel does not converge.
/// @param square  k_i y_i*^2 of each mode: its share in s_eq^2 of the trial state, MPa2; of J2 a*^2/4 and the rest
PlasticPoint return_to_yield_surface(const LawConstants& law, const double* square, PlasticPoint point);

}  // namespace interply::metal
