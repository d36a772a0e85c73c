#include "contact/layer_interface.hpp"

#include <algorithm>
#include <cmath>

#include "contact/rows.hpp"

namespace interply::contact {

using mechanics::at;

LayerInterface::LayerInterface(const InterfaceLaw& law, const LayerGeometry& lower, const LayerGeometry& upper)
    : law_(law),
      kernels_(choose_contact_kernels()),
      lower_(lower),
      upper_(upper),
      points_(mechanics::compute_tributary_areas(*lower.mesh)),
      on_lower_(lower),
      on_upper_(upper),
      upper_force_(static_cast<std::size_t>(6 * points_.size())),
      touches_(static_cast<std::size_t>(points_.size())),
      block_energies_(static_cast<std::size_t>(count_blocks(points_.size()))) {
  for (Eigen::Index i = 0; i < points_.size(); ++i)
    triangle_.push_back(search_facing(*upper_.mesh, upper_.position, at(lower_.position, i), at(lower_.normal, i)));
}

void LayerInterface::update(double dt, const BlockRunner& run) {
  const PairRows pair = describe(dt);
  for_each_block(run, points_.size(), [&](Eigen::Index block, Eigen::Index begin, Eigen::Index end) {
    InterfaceEnergies& energies = block_energies_[static_cast<std::size_t>(block)];
    energies = {};
    kernels_.advance_pairs(pair, begin, end, energies);
  });
  energies_.stored = 0;
  for (const InterfaceEnergies& e : block_energies_) energies_.add(e);

  const bool acts = std::find(touches_.begin(), touches_.end(), 1) != touches_.end();
  double work[2] = {};  // on the lower and on the upper layer
  const auto finish = [&](Eigen::Index side) {
    if (side == 1 && acts) add_upper_forces();
    FaceForces& face = side == 0 ? on_lower_ : on_upper_;
    work[side] = acts ? face.finish() : face.finish_without_forces();
  };
  run(2, std::ref(finish));
  energies_.work += work[0] + work[1];
}

PairRows LayerInterface::describe(double dt) {
  const auto walk = [](void* owner, std::ptrdiff_t i, double& edge) {
    return static_cast<LayerInterface*>(owner)->follow(i, edge).edge;
  };
  return {.law = law_,
          .dt = dt,
          .lower = get_rows(lower_),
          .upper = get_rows(upper_),
          .corner = {&upper_.mesh->triangles(0, 0), &upper_.mesh->triangles(1, 0), &upper_.mesh->triangles(2, 0)},
          .triangle = triangle_.data(),
          .points = get_rows(points_),
          .lower_force = on_lower_.records(),
          .upper_force = upper_force_.data(),
          .touches = touches_.data(),
          .owner = this,
          .walk = walk};
}

/// In the order of the points: which corners they add to changes as they slide.
void LayerInterface::add_upper_forces() {
  on_upper_.clear_records();
  Quad* records = on_upper_.records();
  const mechanics::Triangles& corners = upper_.mesh->triangles;
  for (std::size_t i = 0; i < triangle_.size(); ++i) {
    if (!touches_[i]) continue;
    const Quad* from = &upper_force_[6 * i];
    for (int k = 0; k < 3; ++k) {
      Quad* to = records + 2 * corners(k, triangle_[i]);
      add_to(to[0], load(from[2 * k]));
      add_to(to[1], load(from[2 * k + 1]));
    }
  }
}

LayerInterface::Approach LayerInterface::approach(Eigen::Index i, const Facing& facing) const {
  const double* w = facing.projection.weight;
  const SmoothFacet facet(upper_, facing.triangle);
  const Rise rise = compute_rise(facet, w);
  double height = lower_.half_thickness(i);
  for (int k = 0; k < 3; ++k) height += w[k] * upper_.half_thickness(facet.node[k]);
  return {facing, facet, rise, facing.projection.distance + rise.value, height};
}

Facing LayerInterface::follow(Eigen::Index i, double& edge) {
  int& triangle = triangle_[static_cast<std::size_t>(i)];
  const Vector3 x = at(lower_.position, i), n = at(lower_.normal, i);
  const Facing now = find_facing(*upper_.mesh, upper_.position, x, n, triangle);
  const bool has_passed = points_.state(i) == static_cast<int>(State::Passed);  // its spring is off
  if (now.triangle != triangle && (now.share < 1 || points_.weight(i) < 1) && !has_passed) {
    const auto spring = [&](const Facing& facing) {
      const Approach a = approach(i, facing);
      const double depth = std::max(0.0, a.height - a.distance);
      return 0.5 * law_.stiffness * points_.area(i) * facing.share * depth * depth;
    };
    edge += spring(now) - spring(hold(*upper_.mesh, upper_.position, x, n, triangle));
  }
  triangle = now.triangle;
  return now;
}

void LayerInterface::add_rates_to(Scalars& lower_rate, Scalars& upper_rate) const {
  const double stiffness = std::max(law_.stiffness, law_.tangential);
  for (Eigen::Index i = 0; i < points_.size(); ++i) {
    const Facing facing = hold(*upper_.mesh, upper_.position, at(lower_.position, i), at(lower_.normal, i),
                               triangle_[static_cast<std::size_t>(i)]);
    // g = (1, -w0, -w1, -w2): |g|_1 = 2 inside, row sum of node j = k A |g_j| |g|_1 / m_j
    const double* w = facing.projection.weight;
    const double offset = std::max(lower_.half_thickness(i), points_.height(i) - lower_.half_thickness(i));
    const double k = stiffness * points_.area(i) * facing.share * compute_turning_factor(offset, points_.area(i)) *
                     (1 + std::abs(w[0]) + std::abs(w[1]) + std::abs(w[2]));
    lower_rate(i) += k / lower_.mass(i);
    for (int c = 0; c < 3; ++c) {
      const int j = upper_.mesh->triangles(c, facing.triangle);
      upper_rate(j) += k * std::abs(w[c]) / upper_.mass(j);
    }
  }
}

}  // namespace interply::contact
