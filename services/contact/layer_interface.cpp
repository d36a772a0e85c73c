#include "contact/layer_interface.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/rows.hpp"

namespace interply::contact {

LayerInterface::LayerInterface(const InterfaceLaw& law, const LayerGeometry& lower, const LayerGeometry& upper,
                               std::shared_ptr<Scratch> scratch)
    : law_(law),
      kernels_(choose_contact_kernels()),
      lower_(lower),
      upper_(upper),
      points_(mechanics::compute_tributary_areas(lower.mesh()), law.tangential),
      scratch_(std::move(scratch)),
      on_lower_(lower, scratch_->lower),
      on_upper_(upper, scratch_->upper),
      touches_(static_cast<std::size_t>(points_.size())),
      block_energies_(static_cast<std::size_t>(count_blocks(points_.size()))) {
  const FlatSearch search(upper_);
  for (Eigen::Index i = 0; i < points_.size(); ++i)
    triangle_.push_back(search.find(lower_.position(i), lower_.normal(i)));
}

void LayerInterface::update(double dt, const BlockRunner& run) {
  const PairRows pair = describe(dt);
  const Eigen::Index n = points_.size(), n_blocks = count_blocks(n), at_once = run.n_at_once();
  scratch_->points.resize(static_cast<std::size_t>(6 * kBlockSize * at_once));
  on_upper_.clear_records();
  const auto end_of = [&](Eigen::Index block) { return std::min(n, block * kBlockSize); };
  for (Eigen::Index first = 0; first < n_blocks; first += at_once) {
    const Eigen::Index count = std::min(at_once, n_blocks - first);
    const auto advance = [&](Eigen::Index i) {
      InterfaceEnergies& energies = block_energies_[static_cast<std::size_t>(first + i)];
      energies = {};
      kernels_.advance_pairs(pair, end_of(first + i), end_of(first + i + 1), forces_of(i), energies);
    };
    run(count, std::ref(advance));
    for (Eigen::Index i = 0; i < count; ++i)
      kernels_.add_upper_forces(pair, end_of(first + i), end_of(first + i + 1), forces_of(i), on_upper_.records());
  }
  energies_.stored = 0;
  for (const InterfaceEnergies& e : block_energies_) energies_.add(e);

  const bool acts = std::find(touches_.begin(), touches_.end(), 1) != touches_.end();
  double work[2] = {};  // on the lower and on the upper layer
  const auto finish = [&](Eigen::Index side) {
    const Span all{0, side == 0 ? lower_.n_nodes() : upper_.n_nodes()};
    work[side] = (side == 0 ? on_lower_ : on_upper_).finish(acts ? all : Span{});
  };
  run(2, std::ref(finish));
  energies_.work += work[0] + work[1];
}

PairRows LayerInterface::describe(double dt) {
  const auto walk = [](void* owner, std::ptrdiff_t i, double& edge) {
    return static_cast<LayerInterface*>(owner)->follow(i, edge).edge;
  };
  const mechanics::Triangles &corner = upper_.mesh().triangles, &neighbour = upper_.mesh().neighbours;
  return {.law = law_,
          .dt = dt,
          .lower = lower_.nodes(),
          .upper = upper_.nodes(),
          .corner = {&corner(0, 0), &corner(1, 0), &corner(2, 0)},
          .neighbour = {&neighbour(0, 0), &neighbour(1, 0), &neighbour(2, 0)},
          .triangle = triangle_.data(),
          .points = get_rows(points_),
          .lower_force = on_lower_.records(),
          .touches = touches_.data(),
          .owner = this,
          .walk = walk};
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
  const Vector3 x = lower_.position(i), n = lower_.normal(i);
  const Facing now = find_facing(upper_, x, n, triangle);
  const bool has_passed = points_.state(i) == static_cast<int>(State::Passed);  // its spring is off
  if (now.triangle != triangle && (now.share < 1 || points_.weight(i) < 1) && !has_passed) {
    const auto spring = [&](const Facing& facing) {
      const Approach a = approach(i, facing);
      const double depth = std::max(0.0, a.height - a.distance);
      return 0.5 * law_.stiffness * points_.area(i) * facing.share * depth * depth;
    };
    edge += spring(now) - spring(hold(upper_, x, n, triangle));
  }
  triangle = now.triangle;
  return now;
}

void LayerInterface::add_rates_to(LayerRates lower, LayerRates upper) const {
  const double most = std::max(law_.stiffness, law_.tangential);
  for (Eigen::Index i = 0; i < points_.size(); ++i) {
    const Facing facing = hold(upper_, lower_.position(i), lower_.normal(i), triangle_[static_cast<std::size_t>(i)]);
    const double* w = facing.projection.weight;
    const double offset = std::max(lower_.half_thickness(i), points_.height(i) - lower_.half_thickness(i));
    const double area = points_.area(i) * facing.share;
    const double stiffness = most * compute_turning_factor(offset, points_.area(i));
    const auto add = [&](Rates& rates, Eigen::Index node, double sum) {
      rates.stiffness(node) += stiffness * sum;
      rates.damping(node) += law_.damping * sum;
    };
    // g = (1, -w0, -w1, -w2): k A |g_j| |g_l| / m_j at j and l
    const double all = std::abs(w[0]) + std::abs(w[1]) + std::abs(w[2]), own = area / lower_.mass()(i);
    add(lower.within, i, own);
    add(lower.across, i, own * all);
    for (int c = 0; c < 3; ++c) {
      const int j = upper_.mesh().triangles(c, facing.triangle);
      const double share = area * std::abs(w[c]) / upper_.mass()(j);
      add(upper.within, j, share * all);
      add(upper.across, j, share);
    }
  }
}

}  // namespace interply::contact
