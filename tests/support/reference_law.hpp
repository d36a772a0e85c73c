/// The law of a sheet once more, from the textbook and slowly: an oracle that shares no line with solver_metal.
#pragma once

#include <Eigen/LU>
#include <cmath>

#include "scene/scene.hpp"

namespace interply::metal::test {

/// sigma_y(p), MPa, by the C++ library's functions.
inline double compute_reference_yield(const scene::Hardening& hardening, double p) {
  if (const auto* h = std::get_if<scene::Swift>(&hardening)) return h->K * std::pow(h->e0 + p, h->n);
  if (const auto* h = std::get_if<scene::Voce>(&hardening))
    return h->s0 - (h->s_inf - h->s0) * std::expm1(-h->rate * p);
  if (const auto* h = std::get_if<scene::HockettSherby>(&hardening))
    return h->s0 - (h->s_inf - h->s0) * std::expm1(-h->rate * std::pow(p, h->n));
  const auto& t = std::get<scene::HardeningTable>(hardening).points;
  if (p <= t.front()[0]) return t.front()[1];
  for (std::size_t i = 1; i < t.size(); ++i)
    if (p < t[i][0]) return std::lerp(t[i - 1][1], t[i][1], (p - t[i - 1][0]) / (t[i][0] - t[i - 1][0]));
  return t.back()[1];
}

/// J2 or Hill's F, G, H, N in plane stress with matrices: stress (s11, s22, s12), MPa; strain (e11, e22, 2 e12).
struct ReferenceLaw {
  struct Point {
    Eigen::Vector3d stress = Eigen::Vector3d::Zero();
    double plastic_strain = 0;
  };

  explicit ReferenceLaw(const scene::J2Law& l) : law(l) {
    const double nu = law.poisson;
    elasticity << 1, nu, 0, nu, 1, 0, 0, 0, (1 - nu) / 2;
    elasticity *= law.young / (1 - nu * nu);
    const auto [r0, r45, r90] = law.hill48.value_or(scene::Hill48{});
    const double F = r0 / (r90 * (1 + r0)), G = 1 / (1 + r0), H = r0 * G, N = (F + G) * (0.5 + r45);
    yield << G + H, -H, 0, -H, F + H, 0, 0, 0, 2 * N;
  }

  double compute_equivalent(const Eigen::Vector3d& s) const { return std::sqrt(s.dot(yield * s)); }
  double compute_yield(double p) const { return compute_reference_yield(law.hardening, p); }

  /// Backward Euler: (1 + l C P) s = s* with l > 0 where the yield condition holds, found by bisection to the last bit.
  /// @return thickness strain increment
  double advance(const Eigen::Vector3d& de, Point& point) const {
    const Eigen::Vector3d old = point.stress, trial = old + elasticity * de;
    const double p0 = point.plastic_strain;
    point.stress = trial;
    if (compute_equivalent(trial) > compute_yield(p0)) {
      const Eigen::Matrix3d flow = elasticity * yield;
      const auto is_outside = [&](double l) {
        point.stress = (Eigen::Matrix3d::Identity() + l * flow).inverse() * trial;
        const double equivalent = compute_equivalent(point.stress);
        point.plastic_strain = p0 + l * equivalent;
        return equivalent > compute_yield(point.plastic_strain);
      };
      double low = 0, high = 1e-3 / law.young;
      while (is_outside(high)) high *= 2;
      for (double l = 0.5 * high; l > low && l < high; l = 0.5 * (low + high)) (is_outside(l) ? low : high) = l;
      is_outside(high);
    }
    return compute_thickness_strain(de, point.stress - old);
  }

  /// Rate equations by forward Euler with the continuum tangent, slope of the curve by differences.
  void integrate_rates(const Eigen::Vector3d& e, int steps, Point& point) const {
    for (int i = 0; i < steps; ++i) {
      const Eigen::Vector3d trial = elasticity * e / steps;
      const double equivalent = compute_equivalent(point.stress), p = point.plastic_strain;
      if (equivalent < compute_yield(p)) {
        point.stress += trial;
        continue;
      }
      const Eigen::Vector3d normal = yield * point.stress / equivalent;  // plastic strain per dp
      const double slope = (compute_yield(p + 2e-8) - compute_yield(p + 1e-8)) / 1e-8;
      const double dp = std::max(0.0, normal.dot(trial) / (normal.dot(elasticity * normal) + slope));
      point.stress += trial - dp * elasticity * normal;
      point.plastic_strain += dp;
    }
  }

  scene::J2Law law;
  Eigen::Matrix3d elasticity, yield;  ///< C, MPa; P: s_eq^2 = s' P s

 private:
  /// Plastic flow is incompressible.
  double compute_thickness_strain(const Eigen::Vector3d& de, const Eigen::Vector3d& ds) const {
    const Eigen::Vector3d plastic = de - elasticity.inverse() * ds;
    return -law.poisson / law.young * (ds(0) + ds(1)) - plastic(0) - plastic(1);
  }
};

}  // namespace interply::metal::test
