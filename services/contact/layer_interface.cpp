#include "contact/layer_interface.hpp"

#include <algorithm>

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
      old_force_on_upper_(force_on_upper_) {
  for (Eigen::Index i = 0; i < points_.size(); ++i)
    facing_[static_cast<std::size_t>(i)].triangle =
        search_facing(*upper_.mesh, upper_.position, at(lower_.position, i), at(lower_.normal, i));
}

void LayerInterface::update(double dt) {
  old_force_on_lower_.swap(force_on_lower_);
  old_force_on_upper_.swap(force_on_upper_);
  force_on_upper_.setZero();
  energies_.stored = 0;
  for (Eigen::Index i = 0; i < points_.size(); ++i) {
    Facing& facing = facing_[static_cast<std::size_t>(i)];
    const Vector3 x = at(lower_.position, i), n = at(lower_.normal, i);
    facing = find_facing(*upper_.mesh, upper_.position, x, n, facing.triangle);
    const double* w = facing.projection.weight;
    const auto corners = upper_.mesh->triangles.col(facing.triangle);
    PointMotion motion{.distance = facing.projection.distance,
                       .height = lower_.half_thickness(i) + w[0] * upper_.half_thickness(corners(0)) +
                                 w[1] * upper_.half_thickness(corners(1)) + w[2] * upper_.half_thickness(corners(2)),
                       .weight = facing.share,
                       .normal = n,
                       .slip = at(lower_.increment, i) - w[0] * at(upper_.increment, corners(0)) -
                               w[1] * at(upper_.increment, corners(1)) - w[2] * at(upper_.increment, corners(2)),
                       .dt = dt};
    if (dt == 0) points_.height(i) = motion.height;
    const Vector3 force = advance_point(law_, points_, i, motion, energies_);
    for (int d = 0; d < 3; ++d) force_on_lower_(d, i) = force(d);
    for (int k = 0; k < 3; ++k) add_at(force_on_upper_, corners(k), -w[k] * force);  // decided once, then negated
  }
  energies_.work += 0.5 * ((old_force_on_lower_ + force_on_lower_) * lower_.increment).sum() +
                    0.5 * ((old_force_on_upper_ + force_on_upper_) * upper_.increment).sum();
}

void LayerInterface::add_rates_to(Scalars& lower_rate, Scalars& upper_rate) const {
  const double stiffness = std::max(law_.stiffness, law_.tangential);
  for (Eigen::Index i = 0; i < points_.size(); ++i) {
    const Facing& facing = facing_[static_cast<std::size_t>(i)];
    // g = (1, -w0, -w1, -w2): |g|_1 = 2, row sum of node j = k A |g_j| |g|_1 / m_j
    const double k = 2 * stiffness * points_.area(i) * facing.share;
    lower_rate(i) += k / lower_.mass(i);
    for (int c = 0; c < 3; ++c) {
      const int j = upper_.mesh->triangles(c, facing.triangle);
      upper_rate(j) += k * facing.projection.weight[c] / upper_.mass(j);
    }
  }
}

}  // namespace interply::contact
