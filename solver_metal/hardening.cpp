#include "solver_metal/hardening.hpp"

#include <algorithm>
#include <cmath>

namespace interply::metal {

namespace {

YieldStress evaluate(const scene::Swift& h, double p) {
  const double stress = h.K * std::pow(h.e0 + p, h.n);  // (H1)
  return {stress, h.n * stress / (h.e0 + p)};
}

YieldStress evaluate(const scene::Voce& h, double p) {
  const double missing = (h.s_inf - h.s0) * std::exp(-h.rate * p);
  return {h.s_inf - missing, h.rate * missing};  // (H2)
}

YieldStress evaluate(const scene::HockettSherby& h, double p) {
  const double missing = (h.s_inf - h.s0) * std::exp(-h.rate * std::pow(p, h.n));
  return {h.s_inf - missing, missing * h.rate * h.n * std::pow(p, h.n - 1)};  // (H3)
}

YieldStress evaluate(const scene::HardeningTable& h, double p) {
  const auto& t = h.points;
  const auto right = std::upper_bound(t.begin(), t.end(), p, [](double value, const auto& x) { return value < x[0]; });
  if (right == t.begin()) return {t.front()[1], 0};
  if (right == t.end()) return {t.back()[1], 0};
  const auto& left = *(right - 1);
  const double slope = ((*right)[1] - left[1]) / ((*right)[0] - left[0]);
  return {left[1] + slope * (p - left[0]), slope};
}

}  // namespace

YieldStress compute_yield_stress(const scene::Hardening& hardening, double p) {
  return std::visit([p](const auto& h) { return evaluate(h, p); }, hardening);
}

}  // namespace interply::metal
