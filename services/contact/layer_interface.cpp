#include "contact/layer_interface.hpp"

#include <algorithm>
#include <cmath>

namespace interply::contact {

using mechanics::add_at;
using mechanics::at;

LayerInterface::LayerInterface(const InterfaceLaw& law, const LayerGeometry& lower, const LayerGeometry& upper)
    : law_(law),
      lower_(lower),
      upper_(upper),
      points_(mechanics::compute_tributary_areas(*lower.mesh)),
      facing_(static_cast<std::size_t>(lower.mesh->n_nodes())),
      force_on_lower_(NodalVectors::Zero(3, lower.mesh->n_nodes())),
      force_on_upper_(NodalVectors::Zero(3, upper.mesh->n_nodes())),
      old_force_on_lower_(force_on_lower_),
      old_force_on_upper_(force_on_upper_),
      pull_on_lower_(force_on_lower_),
      pull_on_upper_(force_on_upper_) {
  for (Eigen::Index i = 0; i < points_.size(); ++i)
    facing_[static_cast<std::size_t>(i)].triangle =
        search_facing(*upper_.mesh, upper_.position, at(lower_.position, i), at(lower_.normal, i));
}

void LayerInterface::update(double dt) {
  old_force_on_lower_.swap(force_on_lower_);
  old_force_on_upper_.swap(force_on_upper_);
  force_on_lower_.setZero();
  force_on_upper_.setZero();
  pull_on_lower_.setZero();
  pull_on_upper_.setZero();
  energies_.stored = 0;
  for (Eigen::Index i = 0; i < points_.size(); ++i) update_point(i, dt);
  lower_.normals->add_forces_to(lower_.position, lower_.normal, pull_on_lower_, force_on_lower_);
  upper_.normals->add_forces_to(upper_.position, upper_.normal, pull_on_upper_, force_on_upper_);
  energies_.work += 0.5 * ((old_force_on_lower_ + force_on_lower_) * lower_.increment).sum() +
                    0.5 * ((old_force_on_upper_ + force_on_upper_) * upper_.increment).sum();
}

LayerInterface::Approach LayerInterface::approach(Eigen::Index i, const Facing& facing) const {
  const double* w = facing.projection.weight;
  const SmoothFacet facet(upper_, facing.triangle);
  const Rise rise = compute_rise(facet, w);
  double height = lower_.half_thickness(i);
  for (int k = 0; k < 3; ++k) height += w[k] * upper_.half_thickness(facet.node[k]);
  return {facing, facet, rise, facing.projection.distance + rise.value, height};
}

void LayerInterface::book_change_of_triangle(Eigen::Index i, int before, const Approach& now) {
  const auto spring = [&](const Approach& a) {
    const double depth = std::max(0.0, a.height - a.distance);
    return 0.5 * law_.stiffness * points_.area(i) * a.facing.share * depth * depth;
  };
  const Facing held = hold(*upper_.mesh, upper_.position, at(lower_.position, i), at(lower_.normal, i), before);
  energies_.edge += spring(now) - spring(approach(i, held));
}

void LayerInterface::update_point(Eigen::Index i, double dt) {
  Facing& facing = facing_[static_cast<std::size_t>(i)];
  const Vector3 x = at(lower_.position, i), n = at(lower_.normal, i);
  const int before = facing.triangle;
  facing = find_facing(*upper_.mesh, upper_.position, x, n, before);
  const Approach now = approach(i, facing);
  const double* w = facing.projection.weight;
  if (dt == 0) points_.height(i) = now.height;
  if (facing.triangle != before && (facing.share < 1 || points_.weight(i) < 1)) book_change_of_triangle(i, before, now);
  if (stays_open(points_, i, now.distance - now.height, now.height, facing.share)) return;

  // friction and damper at the common point (C4)
  const double below = now.distance * lower_.half_thickness(i) / now.height;  // a
  const CommonPoint common(now.facet, w, x + below * n);
  const PointMotion motion{
      .distance = now.distance,
      .height = now.height,
      .weight = facing.share,
      .normal = n,
      .stick = carry_along(now.facet, upper_.increment, at(points_.stick, i)),
      .slip = at(lower_.increment, i) + below * at(lower_.turn, i) - common.compute_increment(now.facet, upper_),
      .dt = dt};
  const PointForce force = advance_point(law_, points_, i, motion, energies_);

  // (C2), (C3): minus the gradient of the penalty energy
  const Vector3& along = facing.projection.facet_normal;  // N/(n.N)
  const Vector3& slope = now.rise.slope;
  Vector3 push = force.pressing * ((1 + slope.dot(n)) * along - slope);
  if (facing.share > 0 && facing.share < 1) {
    const Vector3 g2 = now.facet.gradient_2(), g3 = now.facet.gradient_3();
    const Vector3 gradient = facing.edge == 0 ? Vector3(-g2 - g3) : facing.edge == 1 ? g2 : g3;
    const double depth = std::max(0.0, now.height - now.distance);
    push += 0.5 * law_.stiffness * points_.area(i) * depth * depth / kEdgeMargin * (gradient - gradient.dot(n) * along);
  }
  add_at(force_on_lower_, i, force.drag - push);
  add_at(pull_on_lower_, i, below * force.drag - facing.projection.distance * push);
  for (int k = 0; k < 3; ++k) {
    add_at(force_on_upper_, now.facet.node[k],
           w[k] * push + force.pressing * now.rise.by_corner[k] - common.by_corner[k] * force.drag);
    add_at(pull_on_upper_, now.facet.node[k],
           force.pressing * now.rise.by_normal[k] - common.by_normal[k] * force.drag);
  }
}

void LayerInterface::add_rates_to(Scalars& lower_rate, Scalars& upper_rate) const {
  const double stiffness = std::max(law_.stiffness, law_.tangential);
  for (Eigen::Index i = 0; i < points_.size(); ++i) {
    const Facing& facing = facing_[static_cast<std::size_t>(i)];
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
