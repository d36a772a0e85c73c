#include "solve/trust.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace interply::solve {

TrustBook::TrustBook(std::vector<TrustLimit> limits, const mechanics::TriangleMesh& mesh)
    : limits_(std::move(limits)),
      mesh_(mesh),
      area_share_(mechanics::compute_areas(mesh) / mechanics::compute_areas(mesh).sum()),
      mask_(static_cast<std::size_t>(mesh.n_elements())) {
  for (const TrustLimit& l : limits_)
    passed_.push_back({.quantity = l.quantity, .unit = l.unit, .meaning = l.meaning, .limit = l.limit});
}

void TrustBook::note(double time, const Eigen::ArrayXXd& quantities) {
  std::fill(mask_.begin(), mask_.end(), 0.0);
  for (std::size_t i = 0; i < limits_.size(); ++i) {
    const mechanics::Scalars values = quantities.row(static_cast<Eigen::Index>(i));
    double share = 0;
    for (Eigen::Index e = 0; e < values.size(); ++e) {
      if (!(values(e) > limits_[i].limit)) continue;
      share += area_share_(e);
      mask_[static_cast<std::size_t>(e)] += static_cast<double>(1 << i);
    }
    if (share == 0) continue;
    exchange::OutsideTrust& passed = passed_[i];
    Eigen::Index worst = 0;
    const double value = values.maxCoeff(&worst);
    if (passed.share == 0) passed.first_time = time;
    if (passed.share == 0 || value > passed.worst) {
      mechanics::Vector3 centre = mechanics::Vector3::Zero();
      for (int k = 0; k < 3; ++k) centre += mechanics::at(mesh_.reference, mesh_.triangles(k, worst)) / 3;
      passed.worst = value, passed.x = centre.x(), passed.y = centre.y();
    }
    passed.share = std::max(passed.share, share);
  }
}

observe::Field TrustBook::describe() const {
  std::string limits = "0 inside every limit, else the sum of";
  for (std::size_t i = 0; i < limits_.size(); ++i)
    limits += fmt::format("{} {} where {} is beyond {:g} {}", i == 0 ? "" : ",", 1 << i, limits_[i].quantity,
                          limits_[i].limit, limits_[i].unit);
  return {.name = "outside_trust", .unit = "-", .description = limits, .values = mask_};
}

std::vector<exchange::OutsideTrust> TrustBook::list_passed() const {
  std::vector<exchange::OutsideTrust> list;
  std::copy_if(passed_.begin(), passed_.end(), std::back_inserter(list), [](const auto& p) { return p.share > 0; });
  return list;
}

}  // namespace interply::solve
