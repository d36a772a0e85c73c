#include "solver_metal/material_point.hpp"

#include <cmath>

#include "solver_metal/hill48.hpp"

namespace interply::metal {

namespace {

constexpr double kLargestIncrement = 1e-3;

struct Advance {
  J2Point point;
  double width = 0, thickness = 0;  ///< strain increments
};

template <class Law>
Advance try_width(const Law& law, const J2Point& start, double de, double width) {
  Advance a{start, width, 0};
  a.thickness = update_point(law, {de, width, 0}, a.point);
  return a;
}

/// Width increment that leaves no stress across the bar: s22 rises with it, and the response contracts by 0 to 1/2 of
/// `de` if it is isotropic, r0/(1 + r0) < 1 if it is rolled, so [-lowest de, 0.1 de] brackets the root. Regula falsi,
/// Illinois variant.
template <class Law>
Advance pull(const Law& law, double lowest, const J2Point& start, double de) {
  double a = -lowest * de, b = 0.1 * de;
  double fa = try_width(law, start, de, a).point.stress.m22, fb = try_width(law, start, de, b).point.stress.m22;
  Advance best;
  for (int i = 0; i < 100; ++i) {
    const double width = (a * fb - b * fa) / (fb - fa);
    best = try_width(law, start, de, width);
    const double f = best.point.stress.m22;
    if (std::fabs(f) <= 1e-13 * best.point.yield.stress || width == a || width == b) break;
    if ((f > 0) == (fb > 0)) {
      b = width;
      fb = f;
      fa *= 0.5;
    } else {
      a = b;
      fa = fb;
      b = width;
      fb = f;
    }
  }
  return best;
}

template <class Law>
std::vector<MetalPoint> follow(const Law& law, double lowest, J2Point point, const std::vector<double>& strain) {
  MetalPoint now;
  std::vector<MetalPoint> path;
  path.reserve(strain.size());
  for (const double target : strain) {
    const double start = now.strain;
    const int parts = static_cast<int>(std::ceil(std::fabs(target - start) / kLargestIncrement));
    for (int i = 1; i <= parts; ++i) {
      const double next = i == parts ? target : start + (target - start) * i / parts;
      const Advance step = pull(law, lowest, point, next - now.strain);
      point = step.point;
      now.strain = next;
      now.width_strain += step.width;
      now.thickness_strain += step.thickness;
    }
    now.stress = point.stress.m11;
    now.plastic_strain = point.plastic_strain;
    path.push_back(now);
  }
  return path;
}

}  // namespace

std::vector<MetalPoint> follow_uniaxial_path(const scene::J2Law& law, const std::vector<double>& strain) {
  const J2Point start{{}, 0, compute_yield_stress(law.hardening, 0)};
  if (law.hill48) return follow(Hill48Constants(law), 1.1, start, strain);
  return follow(J2Constants(law), 0.6, start, strain);
}

}  // namespace interply::metal
