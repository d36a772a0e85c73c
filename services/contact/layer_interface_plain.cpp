/// The update of an interface point by point, in the plain form of the equations.
#include <algorithm>

#include "contact/layer_interface.hpp"

namespace interply::contact {

using mechanics::at;

namespace {

void add(Quad& to, const Vector3& a) {
  to.x += a.x();
  to.y += a.y();
  to.z += a.z();
}

}  // namespace

void LayerInterface::update_plainly(double dt) {
  on_lower_.clear_records();
  on_upper_.clear_records();
  energies_.stored = 0;
  for (Eigen::Index i = 0; i < points_.size(); ++i) update_point(i, dt);
  energies_.work += on_lower_.finish({0, lower_.n_nodes()}) + on_upper_.finish({0, upper_.n_nodes()});
}

void LayerInterface::update_point(Eigen::Index i, double dt) {
  const Vector3 n = lower_.normal(i);
  const bool had_passed = points_.state(i) == static_cast<int>(State::Passed);
  Approach now = approach(i, follow(i, energies_.edge));
  const double gap = now.distance - now.height;
  const bool passed = gap < 0 && (had_passed || (now.facing.share <= 0 && gap < -kPassedDepth * now.height));
  if (passed) now.facing.share = 0;
  const double* w = now.facing.projection.weight;
  if (dt == 0) points_.height(i) = now.height;
  if (stays_open(points_, i, gap, now.height, now.facing.share)) return;

  // friction and damper at the common point (C4)
  const double below = now.distance * lower_.half_thickness(i) / now.height;  // a
  const CommonPoint common(now.facet, w, lower_.position(i) + below * n);
  const PointMotion motion{
      .distance = now.distance,
      .height = now.height,
      .weight = now.facing.share,
      .normal = n,
      .stick = carry_along(now.facet, upper_, at(points_.stick, i)),
      .slip = lower_.increment(i) + below * lower_.turn(i) - common.compute_increment(now.facet, upper_),
      .dt = dt};
  const PointForce force = advance_point(law_, points_, i, motion, energies_);
  if (passed) points_.state(i) = static_cast<int>(State::Passed);

  // (C2), (C3): minus the gradient of the penalty energy
  const Vector3& along = now.facing.projection.facet_normal;  // N/(n.N)
  const Vector3& slope = now.rise.slope;
  Vector3 push = force.pressing * ((1 + slope.dot(n)) * along - slope);
  if (now.facing.share > 0 && now.facing.share < 1) {
    const Vector3 g2 = now.facet.gradient_2(), g3 = now.facet.gradient_3();
    const Vector3 gradient = now.facing.edge == 0 ? Vector3(-g2 - g3) : now.facing.edge == 1 ? g2 : g3;
    const double depth = std::max(0.0, now.height - now.distance);
    push += 0.5 * law_.stiffness * points_.area(i) * depth * depth / kEdgeMargin * (gradient - gradient.dot(n) * along);
  }
  Quad* const lower = on_lower_.records() + 2 * i;
  add(lower[0], force.drag - push);
  add(lower[1], below * force.drag - now.facing.projection.distance * push);
  for (int k = 0; k < 3; ++k) {
    Quad* const upper = on_upper_.records() + 2 * now.facet.node[k];
    add(upper[0], w[k] * push + force.pressing * now.rise.by_corner[k] - common.by_corner[k] * force.drag);
    add(upper[1], force.pressing * now.rise.by_normal[k] - common.by_normal[k] * force.drag);
  }
}

}  // namespace interply::contact
