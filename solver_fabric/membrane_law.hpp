/// Parameters of the woven laws of a ply, made from those of the scene. The laws themselves are in woven_law.hpp.
#pragma once

#include <variant>
#include <vector>

#include "scene/scene.hpp"

namespace interply::fabric {

/// Parameters of one fibre direction (scene::WovenLaw).
struct FibreParameters {
  double a = 0, b = 0, c = 0, p_min = 1, d = 0, s_T = 0, s_C = 0, strain_cap = 0;
};

/// The invariant-based law, variants `uncoupled`, `full`, `biaxial` and `normal_shear`. A coupling that a variant does
/// not have is switched off in its parameters (c = 0, p_min = 1; s_T = s_C = 0), so there is one formula for all.
struct InvariantLaw {
  FibreParameters warp, weft;
  double s[3] = {};  ///< MPa
  /// Larger of the fibre stiffnesses on both sides of l = 1, of warp and weft, MPa.
  double stiffness_floor[2] = {};
};

/// A piecewise linear curve and its integral from 0 at its points, x strictly ascending, straight on beyond both ends.
struct Curve {
  std::vector<double> x, value, integral;
};

/// Variant `fabric`: independent tables of the work-conjugate nominal stresses T11(e_a), T22(e_b), T12(gamma).
struct TableLaw {
  Curve warp, weft, shear;
  double stiffness_floor[2] = {};  ///< as of InvariantLaw
};

using MembraneLaw = std::variant<InvariantLaw, TableLaw>;

/// f(law) for the one it holds. std::visit would leave code of its own, compiled for AVX-512, where others may pick it.
template <class F>
auto visit_law(const MembraneLaw& law, const F& f) {
  if (const auto* l = std::get_if<InvariantLaw>(&law)) return f(*l);
  return f(*std::get_if<TableLaw>(&law));
}

/// The law of a scene, tables sampled where variant `fabric` comes without them.
/// @throws std::invalid_argument for a table of fewer than two points, or whose first column does not ascend strictly
MembraneLaw make_membrane_law(const scene::WovenLaw& law);

/// Tables sampled from the parameters of the invariant-based law without couplings. Compression is linear and needs one
/// segment; tension is sampled evenly over e in [0, 0.25] and shear over |gamma| in [0, pi/2], with straight lines
/// beyond. The defaults (0.025 % strain, 0.1 deg) keep the stress error below 6 a h^2/8, 0.003 MPa for a = 5.5e4 MPa.
scene::FabricTables sample_tables(const scene::WovenLaw& law, int tension_segments = 1000, int shear_segments = 900);

/// True where k_TC acts on a tension beyond its strain cap. @param la,lb  stretches of warp and weft
bool is_beyond_cap(const MembraneLaw& law, double la, double lb);

}  // namespace interply::fabric
