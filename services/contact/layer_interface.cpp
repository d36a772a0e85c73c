#include "contact/layer_interface.hpp"

#include <algorithm>

namespace interply::contact {

using mechanics::add_at;
using mechanics::at;

namespace {

/// The smooth surface above one facet, (C1).
struct Rise {
  double value = 0;          ///< r, mm
  Vector3 by_corner[3];      ///< dr/dx_i at fixed weights and normals
  Vector3 by_normal[3];      ///< dr/dn_i, mm
  double by_weight[3] = {};  ///< dr/dw_i, mm
};

template <typename Corners>
Rise compute_rise(const LayerGeometry& layer, const Corners& corner, const double w[3]) {
  Rise rise;
  for (int k = 0; k < 3; ++k) {
    rise.by_corner[k].setZero();
    rise.by_normal[k].setZero();
  }
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const Vector3 side = at(layer.position, corner(j)) - at(layer.position, corner(i));
    const Vector3 turn = at(layer.normal, corner(j)) - at(layer.normal, corner(i));
    const double sagitta = 0.5 * side.dot(turn), both = 0.5 * w[i] * w[j];
    rise.value += w[i] * w[j] * sagitta;
    rise.by_weight[i] += w[j] * sagitta;
    rise.by_weight[j] += w[i] * sagitta;
    rise.by_corner[i] -= both * turn;
    rise.by_corner[j] += both * turn;
    rise.by_normal[i] -= both * side;
    rise.by_normal[j] += both * side;
  }
  return rise;
}

/// Slope of the rise along its facet: sum_i dr/dw_i grad w_i, mm/mm.
template <typename Corners>
Vector3 compute_slope(const LayerGeometry& layer, const Corners& corner, const Rise& rise) {
  const Vector3 u = at(layer.position, corner(1)) - at(layer.position, corner(0));
  const Vector3 v = at(layer.position, corner(2)) - at(layer.position, corner(0));
  const Vector3 area = u.cross(v);
  const double inv = 1 / area.squaredNorm();
  return ((rise.by_weight[1] - rise.by_weight[0]) * v.cross(area) +
          (rise.by_weight[2] - rise.by_weight[0]) * area.cross(u)) *
         inv;
}

}  // namespace

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
  force_on_upper_.setZero();
  pull_on_upper_.setZero();
  energies_.stored = 0;
  for (Eigen::Index i = 0; i < points_.size(); ++i) {
    Facing& facing = facing_[static_cast<std::size_t>(i)];
    const Vector3 x = at(lower_.position, i), n = at(lower_.normal, i);
    facing = find_facing(*upper_.mesh, upper_.position, x, n, facing.triangle);
    const Projection& facet = facing.projection;
    const double* w = facet.weight;
    const auto corners = upper_.mesh->triangles.col(facing.triangle);
    const Rise rise = compute_rise(upper_, corners, w);
    const Vector3 slope = compute_slope(upper_, corners, rise);
    PointMotion motion{.distance = facet.distance + rise.value,
                       .height = lower_.half_thickness(i) + w[0] * upper_.half_thickness(corners(0)) +
                                 w[1] * upper_.half_thickness(corners(1)) + w[2] * upper_.half_thickness(corners(2)),
                       .weight = facing.share,
                       .normal = n,
                       .push = (1 + slope.dot(n)) * facet.facet_normal - slope,
                       .slip = at(lower_.increment, i) - w[0] * at(upper_.increment, corners(0)) -
                               w[1] * at(upper_.increment, corners(1)) - w[2] * at(upper_.increment, corners(2)),
                       .dt = dt};
    if (dt == 0) points_.height(i) = motion.height;
    const Vector3 force = advance_point(law_, points_, i, motion, energies_);
    const double pressing = elastic_force(points_, i);
    for (int d = 0; d < 3; ++d) {
      force_on_lower_(d, i) = force(d);
      pull_on_lower_(d, i) = -pressing * facet.distance * (motion.push(d) - n(d));
    }
    for (int k = 0; k < 3; ++k) {
      add_at(force_on_upper_, corners(k), pressing * rise.by_corner[k] - w[k] * force);
      add_at(pull_on_upper_, corners(k), pressing * rise.by_normal[k]);
    }
  }
  lower_.normals->add_forces_to(lower_.position, lower_.normal, pull_on_lower_, force_on_lower_);
  upper_.normals->add_forces_to(upper_.position, upper_.normal, pull_on_upper_, force_on_upper_);
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
