#include "launch/inertia.hpp"

#include <cmath>
#include <numbers>

#include "coordinator/amplitude.hpp"
#include "coordinator/stack.hpp"
#include "solver_metal/hardening.hpp"

namespace interply::launch {
namespace {

/// Plastic work per volume up to a plastic strain, MPa: trapezoids.
double integrate_yield_stress(const scene::Hardening& hardening, double end) {
  constexpr int kParts = 50;
  double work = 0;
  for (int i = 0; i <= kParts; ++i)
    work += metal::compute_yield_stress(hardening, end * i / kParts).stress * (i % kParts == 0 ? 0.5 : 1);
  return work * end / kParts;
}

}  // namespace

std::optional<double> estimate_kinetic_share(const scene::Scene& scene, double flange_area, double blank_area) {
  const double opening = blank_area - flange_area, depth = scene.motion.stroke / 2;
  if (!scene.tools.punch || depth <= 0 || opening <= 0) return std::nullopt;
  const double radius = std::sqrt(opening * (scene.blank.half ? 2 : 1) / std::numbers::pi);
  const double strain = depth * depth / (2 * radius * radius);
  const double speed = coordinator::kSteepest * scene.motion.stroke / scene.motion.forming_time;
  double mass = 0, work = 0;
  for (const scene::Layer& layer : scene.layers) {
    mass += layer.thickness * layer.density * scene.time.mass_scaling * opening;
    if (layer.kind() != scene::Kind::Metal) continue;
    const auto* j2 = std::get_if<scene::J2Law>(&layer.law);
    if (!j2) return std::nullopt;
    work += layer.thickness * opening * integrate_yield_stress(j2->hardening, strain);
  }
  const double friction = coordinator::find_friction(scene, "die", scene.layers.front().name) +
                          coordinator::find_friction(scene, scene.layers.back().name, "blank_holder");
  work += friction * scene.tools.blank_holder.pressure * flange_area * depth * depth / (4 * radius);
  if (work <= 0) return std::nullopt;
  return mass * speed * speed / 12 / work;
}

}  // namespace interply::launch
