#include "contact/points.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace interply::contact {

double compute_stiffness(double reference_pressure, double fraction, double thickness) {
  return reference_pressure / (fraction * thickness);
}

double compute_damping(double fraction, double stiffness, double mass_per_area_1, double mass_per_area_2) {
  const double reduced = 1 / (1 / mass_per_area_1 + 1 / mass_per_area_2);
  return 2 * fraction * std::sqrt(stiffness * reduced);
}

Points::Points(const Scalars& areas)
    : area(areas),
      gap(Scalars::Zero(areas.size())),
      weight(Scalars::Ones(areas.size())),
      pressure(Scalars::Zero(areas.size())),
      damping(Scalars::Zero(areas.size())),
      stick(NodalVectors::Zero(3, areas.size())),
      traction(NodalVectors::Zero(3, areas.size())),
      slip(Scalars::Zero(areas.size())),
      height(Scalars::Zero(areas.size())),
      state(Eigen::ArrayXi::Zero(areas.size())) {}

Penetration measure_penetration(const Points& points) {
  std::vector<std::pair<double, double>> touching;  // penetration, area
  double total = 0;
  for (Eigen::Index i = 0; i < points.size(); ++i) {
    if (!(points.gap(i) < 0)) continue;
    const double area = points.weight(i) * points.area(i);
    touching.emplace_back(-points.gap(i), area);
    total += area;
  }
  if (touching.empty()) return {};
  std::sort(touching.begin(), touching.end());
  Penetration result{.percentile_99 = touching.back().first, .peak = touching.back().first};
  double below = 0;
  for (const auto& [depth, area] : touching) {
    below += area;
    if (below >= 0.99 * total) {
      result.percentile_99 = depth;
      break;
    }
  }
  return result;
}

}  // namespace interply::contact
