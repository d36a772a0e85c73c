#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/alignment.hpp"
#include "scene/convert.hpp"
#include "scene/meshes.hpp"
#include "scene/read_scene.hpp"
#include "scene/report.hpp"
#include "scene/usual.hpp"

namespace interply::scene {
namespace {

constexpr double kFastPunch = 30e3;  ///< mm/s; three times what is common where time is scaled

bool has_biaxial_coupling(const WovenLaw& law) {
  return law.variant == Variant::Full || law.variant == Variant::Biaxial;
}

bool has_normal_shear_coupling(const WovenLaw& law) {
  return law.variant == Variant::Full || law.variant == Variant::NormalShear;
}

/// Shear energy density W_S (paper eq. 8) + W_ST (eq. 9) at a shear angle (rad), where the fibre that is not compressed
/// is stretched by 1 %, MPa. The stretch is ours: W_ST vanishes without one, and 1 % is common in forming.
double compute_shear_energy(const WovenLaw& law, double s_T, double g) {
  const double excess = 1.01 * 1.01 - 1;
  return law.s[0] * g * g / 2 + law.s[1] * g * g * g / 3 + law.s[2] * g * g * g * g / 4 +
         g * g * g / 3 * s_T * excess * excess;
}

/// Smallest whole angle below 60 deg at which compression d loses convexity, 2 d <= 8.6 s_C^(2/3) (W_S + W_ST)
/// (solver_fabric/THEORY.md); 60 if there is none.
int find_compression_limit(const WovenLaw& law, double d, double s_C, double s_T) {
  int degrees = 0;
  while (degrees < 60 &&
         2 * d > 8.6 * std::cbrt(s_C * s_C) * compute_shear_energy(law, s_T, degrees * std::numbers::pi / 180))
    ++degrees;
  return degrees;
}

void warn_of_woven(const WovenLaw& law, const std::string& path, std::vector<std::string>& warnings) {
  if (has_normal_shear_coupling(law)) {
    // The shear energy that a compressed warp reduces is raised by a stretched weft, and the other way round.
    const int warp = find_compression_limit(law, law.d.warp, law.s_C.warp, law.s_T.weft);
    const int weft = find_compression_limit(law, law.d.weft, law.s_C.weft, law.s_T.warp);
    if (std::min(warp, weft) < 60)
      warnings.push_back(path + ": a compressed " + (warp <= weft ? "warp" : "weft") + " is unstable from a shear of " +
                         std::to_string(std::min(warp, weft)) + " deg, where 2 d > 8.6 s_C^(2/3) (W_S + W_ST) fails; " +
                         "raise d or lower s_C");
  }
  const double c =
      std::max(std::isinf(law.strain_cap.warp) ? law.c.warp : 0, std::isinf(law.strain_cap.weft) ? law.c.weft : 0);
  if (has_biaxial_coupling(law) && c * 0.05 > 2.08)
    warnings.push_back(path + ".c: " + to_text(c) + " makes equibiaxial tension unstable from a strain of " +
                       to_rounded(2.08 / c) + "; lower c or set strain_cap");
}

/// Of the blank in whose mesh the layer lies, mm.
double measure_smaller_side(const Scene& scene, const std::optional<geometry::FlatMesh>& mesh) {
  return mesh ? measure_extent(*mesh) : std::min(scene.blank.length, scene.blank.width);
}

void warn_of_sizes(const Scene& scene, std::vector<std::string>& warnings) {
  const auto mesh = read_mesh_of(scene, 0);
  const double side = measure_smaller_side(scene, mesh), stroke = scene.motion.stroke;
  if (mesh && side < kSmallBlank)
    warnings.push_back(
        fmt::format("blank.mesh: is only {:.3g} mm large: if it was drawn in metres, scale it by 1000", side));
  else if (stroke > side / 2)
    warnings.push_back(fmt::format(
        "motion.stroke: {:g} mm is more than half the blank of {:.4g} mm: is that the way of the punch from "
        "where it touches the stack?",
        stroke, side));
  const double speed = 15.0 / 8 * stroke / scene.motion.forming_time;  // of the smooth step, at its middle
  if (scene.tools.punch && speed > kFastPunch)
    warnings.push_back(fmt::format(
        "motion.forming_time: the punch moves at up to {:.4g} m/s, beyond {:g} m/s inertia forms the blank: "
        "is the time in s, the stroke in mm?",
        1e-3 * speed, 1e-3 * kFastPunch));
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    const Layer& layer = scene.layers[i];
    const double h = layer.mesh_size.value_or(scene.blank.mesh_size);
    if (scene.blank.mesh || layer.mesh || h >= layer.thickness / 2) continue;
    warnings.push_back(
        fmt::format("{}: a mesh of {:g} mm is finer than half the thickness of {:g} mm: a shell says nothing at that "
                    "scale, and half the size takes eight times the time",
                    layer.mesh_size ? join(join("layers", i), "mesh_size") : "blank.mesh_size", h, layer.thickness));
    break;  // say it once
  }
}

/// Share of a layer's area in triangles without sides along both fibres.
double compute_misaligned_share(const Scene& scene, std::size_t layer) {
  const double orientation = scene.layers[layer].orientation_deg * std::numbers::pi / 180;
  static const geometry::FlatMesh kLegsAlongTheAxes{.points = {{0, 0}, {1, 0}, {0, 1}}, .triangles = {{0, 1, 2}}};
  return geometry::compute_misaligned_share(read_mesh_of(scene, layer).value_or(kLegsAlongTheAxes), orientation);
}

/// The numbers are those of tests/verification/fabric_locking_test.cpp.
void warn_of_alignment(const Scene& scene, std::size_t layer, std::vector<std::string>& warnings) {
  const double share = compute_misaligned_share(scene, layer);
  if (share < 0.1) return;
  warnings.push_back(join("layers", layer) + ".orientation: " + to_rounded(std::round(100 * share)) +
                     " % of the mesh has no sides along both fibres and locks: uneven shear costs 2 to 12 times its "
                     "energy (fabric set "
                     "soft, 4 mm mesh; set stiff 4 to 49 times; V6); mesh with sides along warp and weft");
}

}  // namespace

std::vector<std::string> find_warnings(const Scene& scene) {
  std::vector<std::string> warnings = find_unusual(to_message(scene));
  warn_of_sizes(scene, warnings);
  bool fabric_only = true;
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    const Layer& layer = scene.layers[i];
    const std::string path = join("layers", i);
    fabric_only = fabric_only && layer.kind() == Kind::Fabric;
    if (layer.kind() != Kind::Fabric) continue;
    if (const auto* woven = std::get_if<WovenLaw>(&layer.law)) warn_of_woven(*woven, path + ".law.woven", warnings);
    warn_of_alignment(scene, i, warnings);
  }
  if (fabric_only && scene.time.mass_scaling >= 10)
    warnings.push_back("time.mass_scaling: " + to_text(scene.time.mass_scaling) +
                       " is too much for a stack without metal: inertia takes over a tenth of the energy from 10 on");
  return warnings;
}

}  // namespace interply::scene
