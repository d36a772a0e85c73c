/// Membrane laws of a woven ply as pure functions of the fibre stretches and the shear angle.
///
/// Source: "Modeling multiaxial stress states in forming simulation of woven fabrics", eq. (1)-(11)
/// (solver_fabric/THEORY.md). Fibre stretches la = sqrt(I4), lb = sqrt(I8), fibre strains e = l - 1, shear angle gamma
/// = I10. Where we differ:
/// - "exp exp(x)" of the printed text is exp(x);
/// - odd powers of I10 in eq. (8), (9) are powers of |I10|, so that W does not depend on the sign of the shear;
/// - above `strain_cap`, exp(c e_t) of eq. (5), (6) goes on along its tangent (C1).
/// W is C1 everywhere, not C2 at la = 1 and lb = 1, where the stiffness jumps from 2 d to 2 b; l <= 1 is compression.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <variant>
#include <vector>

#include "scene/scene.hpp"
#include "solver_fabric/law_parameters.hpp"

namespace interply::fabric {

/// A function of one variable: value, first and second derivative.
struct Jet {
  double f = 0, d = 0, dd = 0;
};

/// Strain energy per reference volume with its first and second derivatives in (la, lb, gamma). All in MPa.
struct Potential {
  double W = 0;
  double W_a = 0, W_b = 0, tau = 0;  ///< dW/dla, dW/dlb, dW/dgamma
  double W_aa = 0, W_bb = 0, W_gg = 0, W_ab = 0, W_ag = 0, W_bg = 0;

  /// Second derivatives in the order (la, lb, gamma). [3 x 3] MPa
  Eigen::Matrix3d hessian() const {
    Eigen::Matrix3d h;
    h << W_aa, W_ab, W_ag, W_ab, W_bb, W_bg, W_ag, W_bg, W_gg;
    return h;
  }
};

/// Smallest eigenvalue of the Hessian, MPa; negative where the law is not convex in (la, lb, gamma).
double compute_smallest_eigenvalue(const Potential& w);

/// Uniaxial energy of one fibre direction: tension eq. (4), compression eq. (7).
inline Jet compute_fibre_energy(const FibreParameters& p, double stretch) {
  const double e = stretch - 1;
  if (stretch > 1) return {(p.a * e + p.b) * e * e, (3 * p.a * e + 2 * p.b) * e, 6 * p.a * e + 2 * p.b};
  return {p.d * e * e, 2 * p.d * e, 2 * p.d};
}

/// Biaxial factor k_TC on the tension of one direction, a function of the transverse stretch: eq. (5), (6).
inline Jet compute_biaxial_factor(const FibreParameters& p, double transverse_stretch) {
  const double e = transverse_stretch - 1, capped = e < p.strain_cap ? e : p.strain_cap;
  const double q = (1 - p.p_min) * std::exp(p.c * capped);
  return {p.p_min + q * (1 + p.c * (e - capped)), q * p.c, e <= p.strain_cap ? q * p.c * p.c : 0};
}

/// Factor s_T (I - 1)^2 of the tension-shear energy, eq. (9); zero in compression.
inline Jet compute_tension_shear_factor(const FibreParameters& p, double stretch) {
  if (!(stretch > 1)) return {};
  const double u = stretch * stretch - 1;
  return {p.s_T * u * u, 4 * p.s_T * stretch * u, p.s_T * (12 * stretch * stretch - 4)};
}

/// Reduction factor k_SC of the shear energy, eq. (10); one in tension.
inline Jet compute_compression_shear_factor(const FibreParameters& p, double stretch) {
  if (stretch > 1) return {1, 0, 0};
  const double u = stretch * stretch - 1;
  const double h_d = 6 * p.s_C * stretch * u * u;  // first and second derivative of the exponent s_C u^3
  const double h_dd = 6 * p.s_C * u * u + 24 * p.s_C * stretch * stretch * u;
  const double k = std::exp(p.s_C * u * u * u);
  return {k, k * h_d, k * (h_dd + h_d * h_d)};
}

/// The invariant-based law, variants `uncoupled`, `full`, `biaxial` and `normal_shear`. A coupling that a variant does
/// not have is switched off in its parameters (c = 0, p_min = 1; s_T = s_C = 0), so there is one formula for all.
class InvariantLaw {
 public:
  explicit InvariantLaw(const scene::WovenLaw& law);

  /// Eq. (11), all four branches in one:
  ///   W = N_a(la) k_a(lb) + N_b(lb) k_b(la) + [W_S(gamma) + |gamma|^3/3 (A(la) + B(lb))] K_a(la) K_b(lb)
  /// with N k eq. (2)-(7), A, B eq. (9), K eq. (10).
  Potential evaluate(double la, double lb, double gamma) const {
    const Jet na = compute_fibre_energy(p_.warp, la), nb = compute_fibre_energy(p_.weft, lb);
    const Jet ka = la > 1 ? compute_biaxial_factor(p_.warp, lb) : Jet{1, 0, 0};
    const Jet kb = lb > 1 ? compute_biaxial_factor(p_.weft, la) : Jet{1, 0, 0};
    const Jet ta = compute_tension_shear_factor(p_.warp, la), tb = compute_tension_shear_factor(p_.weft, lb);
    const Jet ca = compute_compression_shear_factor(p_.warp, la), cb = compute_compression_shear_factor(p_.weft, lb);

    const double g = std::abs(gamma), sign = gamma < 0 ? -1 : 1;
    const Jet s{g * g * (p_.s[0] / 2 + g * (p_.s[1] / 3 + g * p_.s[2] / 4)),  // eq. (8)
                sign * g * (p_.s[0] + g * (p_.s[1] + g * p_.s[2])), p_.s[0] + g * (2 * p_.s[1] + g * 3 * p_.s[2])};
    const Jet cube{g * g * g / 3, sign * g * g, 2 * g};

    const double t = ta.f + tb.f;
    const double p = s.f + cube.f * t, p_g = s.d + cube.d * t, p_gg = s.dd + cube.dd * t;
    const double p_a = cube.f * ta.d, p_b = cube.f * tb.d;
    const double q_a = p_a * ca.f + p * ca.d, q_b = p_b * cb.f + p * cb.d;

    Potential w;
    w.W = na.f * ka.f + nb.f * kb.f + p * ca.f * cb.f;
    w.W_a = na.d * ka.f + nb.f * kb.d + q_a * cb.f;
    w.W_b = na.f * ka.d + nb.d * kb.f + q_b * ca.f;
    w.tau = p_g * ca.f * cb.f;
    w.W_aa = na.dd * ka.f + nb.f * kb.dd + (cube.f * ta.dd * ca.f + 2 * p_a * ca.d + p * ca.dd) * cb.f;
    w.W_bb = na.f * ka.dd + nb.dd * kb.f + (cube.f * tb.dd * cb.f + 2 * p_b * cb.d + p * cb.dd) * ca.f;
    w.W_gg = p_gg * ca.f * cb.f;
    w.W_ab = na.d * ka.d + nb.d * kb.d + p_a * ca.f * cb.d + p_b * ca.d * cb.f + p * ca.d * cb.d;
    w.W_ag = (cube.d * ta.d * ca.f + p_g * ca.d) * cb.f;
    w.W_bg = (cube.d * tb.d * cb.f + p_g * cb.d) * ca.f;
    return w;
  }

  const InvariantParameters& parameters() const { return p_; }

  /// True where k_TC acts on a tension beyond its strain cap.
  bool is_beyond_cap(double la, double lb) const {
    return (la > 1 && lb - 1 > p_.warp.strain_cap) || (lb > 1 && la - 1 > p_.weft.strain_cap);
  }

  /// Larger of the fibre stiffnesses on both sides of l = 1, per direction, MPa.
  scene::Pair stiffness_floor() const {
    return {2 * std::max(p_.warp.b, p_.warp.d), 2 * std::max(p_.weft.b, p_.weft.d)};
  }

 private:
  InvariantParameters p_;
};

/// Piecewise linear T(x) with its exact integral from 0, straight on beyond both ends.
class PiecewiseLinear {
 public:
  /// @param table  at least two points, x strictly ascending
  /// @throws std::invalid_argument
  explicit PiecewiseLinear(const scene::Table& table);
  /// f = integral of T from 0 to x, d = T(x), dd = slope.
  Jet evaluate(double x) const;
  /// Valid while this lives.
  CurveView view() const { return {x_.data(), value_.data(), integral_.data(), static_cast<int>(x_.size())}; }

 private:
  std::size_t find_segment(double x) const;
  std::vector<double> x_, value_, integral_;
};

/// Variant `fabric`: independent tables of the work-conjugate nominal stresses T11(e_a), T22(e_b), T12(gamma), so
///   W = int T11 de_a + int T22 de_b + int T12 d|gamma|.
class TableLaw {
 public:
  explicit TableLaw(const scene::FabricTables& tables);

  Potential evaluate(double la, double lb, double gamma) const {
    const Jet na = warp_.evaluate(la - 1), nb = weft_.evaluate(lb - 1), s = shear_.evaluate(std::abs(gamma));
    Potential w;
    w.W = na.f + nb.f + s.f;
    w.W_a = na.d;
    w.W_b = nb.d;
    w.tau = gamma < 0 ? -s.d : s.d;
    w.W_aa = na.dd;
    w.W_bb = nb.dd;
    w.W_gg = s.dd;
    return w;
  }
  TableParameters parameters() const { return {warp_.view(), weft_.view(), shear_.view()}; }
  bool is_beyond_cap(double, double) const { return false; }
  scene::Pair stiffness_floor() const { return floor_; }

 private:
  PiecewiseLinear warp_, weft_, shear_;
  scene::Pair floor_;
};

/// Tables sampled from the parameters of the invariant-based law without couplings. Compression is linear and needs one
/// segment; tension is sampled evenly over e in [0, 0.25] and shear over |gamma| in [0, pi/2], with straight lines
/// beyond. The defaults (0.025 % strain, 0.1 deg) keep the stress error below 6 a h^2/8, 0.003 MPa for a = 5.5e4 MPa.
scene::FabricTables sample_tables(const scene::WovenLaw& law, int tension_segments = 1000, int shear_segments = 900);

using MembraneLaw = std::variant<InvariantLaw, TableLaw>;

/// The law of a scene, tables sampled where variant `fabric` comes without them.
MembraneLaw make_membrane_law(const scene::WovenLaw& law);

}  // namespace interply::fabric
