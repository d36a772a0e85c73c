#include "contact/points.hpp"

#include <algorithm>
#include <cmath>

namespace interply::contact {

double compute_stiffness(double reference_pressure, double fraction, double thickness) {
  return reference_pressure / (fraction * thickness);
}

double compute_damping(double fraction, double stiffness, double mass_per_area_1, double mass_per_area_2) {
  const double reduced = 1 / (1 / mass_per_area_1 + 1 / mass_per_area_2);
  return 2 * fraction * std::sqrt(stiffness * reduced);
}

Points::Points(const Scalars& areas, double tangential_stiffness)
    : area(areas),
      gap(Scalars::Zero(areas.size())),
      weight(Scalars::Ones(areas.size())),
      pressure(Scalars::Zero(areas.size())),
      stick(NodalVectors::Zero(3, areas.size())),
      slip(Scalars::Zero(areas.size())),
      friction_work(Scalars::Zero(areas.size())),
      height(Scalars::Zero(areas.size())),
      state(Eigen::ArrayXi::Zero(areas.size())),
      tangential(tangential_stiffness) {}

NodalVectors Points::acting_traction() const {
  NodalVectors traction(3, size());
  for (int d = 0; d < 3; ++d) traction.row(d) = -tangential * weight.transpose() * stick.row(d);
  return traction;
}

void PenetrationSample::add(const Points& points, double thickness) {
  for (Eigen::Index i = 0; i < points.size(); ++i) {
    const double area = points.weight(i) * points.area(i);
    if (!(points.gap(i) < 0) || area == 0) continue;
    depth_and_area_.emplace_back(-points.gap(i) / thickness, area);
    peak_ = std::max(peak_, -points.gap(i) / thickness);
  }
}

double PenetrationSample::compute_percentile(double fraction) {
  std::sort(depth_and_area_.begin(), depth_and_area_.end());
  double total = 0, below = 0;
  for (const auto& [depth, area] : depth_and_area_) total += area;
  for (const auto& [depth, area] : depth_and_area_) {
    below += area;
    if (below >= fraction * total) return depth;
  }
  return peak_;
}

}  // namespace interply::contact
