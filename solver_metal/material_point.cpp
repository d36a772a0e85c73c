#include "solver_metal/material_point.hpp"

#include <cmath>
#include <limits>

#include "solver_metal/hill48.hpp"
#include "solver_metal/j2_law.hpp"
#include "solver_metal/return_mapping.hpp"

namespace interply::metal {

namespace {

constexpr double kLargestIncrement = 1e-3;

template <class Law>
double update(const LawConstants& constants, const Symmetric2& de, J2Point& point) {
  const Law law(constants);
  const double old_trace = point.stress.trace();
  Return<Law::kModes, double> r;
  point.stress = law.compute_trial(point.stress, de, r.square);
  double trial2 = 0, plastic = 0;
  for (const double square : r.square) trial2 += square;
  r.left = trial2 > point.yield.stress * point.yield.stress;
  if (r.left) {
    r.start = {point.plastic_strain, point.yield.stress, point.yield.slope, 0};
    with_curve(constants.hardening, [&](const auto& curve) { return_packs(constants, curve, law.rate, 1, &r); });
    plastic = law.shrink(r.end.multiplier, point.stress);
    point.plastic_strain = r.end.strain;
    point.yield = {r.end.yield_stress, r.end.yield_slope, 0};
  }
  return -constants.poisson / constants.young * (point.stress.trace() - old_trace) - plastic;
}

struct Advance {
  J2Point point;
  double width = 0, thickness = 0;  ///< strain increments
};

Advance try_width(const LawConstants& law, const J2Point& start, double de, double width) {
  Advance a{start, width, 0};
  a.thickness = update_point(law, {de, width, 0}, a.point);
  return a;
}

/// Width increment that leaves no stress across the bar: s22 rises with it, and the response contracts by 0 to 1/2 of
/// `de` if it is isotropic, r0/(1 + r0) < 1 if it is rolled, so [-lowest de, 0.1 de] brackets the root. Regula falsi,
/// Illinois variant.
Advance pull(const LawConstants& law, double lowest, const J2Point& start, double de) {
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

std::vector<MetalPoint> follow(const LawConstants& law, double lowest, J2Point point,
                               const std::vector<double>& strain) {
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

YieldStress<double> compute_yield_stress(const scene::Hardening& hardening, double p) {
  return with_curve(hardening, [p](const auto& curve) {
    YieldStress<double> y = curve(p);
    if (std::isnan(y.slope)) y.slope = curve(std::numeric_limits<double>::min()).slope;  // infinite at p = 0
    return y;
  });
}

Plastic<double> return_to_yield_surface(const LawConstants& law, const double* square, const Plastic<double>& start) {
  return with_curve(law.hardening, [&](const auto& curve) {
    if (!law.is_hill48) return return_bracketed(curve, J2<double>(law).rate, {square[0], square[1]}, start);
    return return_bracketed(curve, Hill48<double>(law).rate, {square[0], square[1], square[2]}, start);
  });
}

double update_point(const LawConstants& law, const Symmetric2& de, J2Point& point) {
  return law.is_hill48 ? update<Hill48<double>>(law, de, point) : update<J2<double>>(law, de, point);
}

std::vector<MetalPoint> follow_uniaxial_path(const scene::J2Law& law, const std::vector<double>& strain) {
  const J2Point start{{}, 0, compute_yield_stress(law.hardening, 0)};
  return follow(LawConstants(law), law.hill48 ? 1.1 : 0.6, start, strain);
}

}  // namespace interply::metal
