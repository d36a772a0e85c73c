#include "contact/tool_interface.hpp"

#include <algorithm>

namespace interply::contact {

using mechanics::at;

ToolInterface::ToolInterface(const InterfaceLaw& law, const LayerGeometry& layer, Tool& tool)
    : law_(law),
      layer_(layer),
      tool_(tool),
      points_(mechanics::compute_tributary_areas(*layer.mesh)),
      slack_(Scalars::Zero(layer.mesh->n_nodes())),
      near_(layer.half_thickness.maxCoeff()),
      force_on_layer_(NodalVectors::Zero(3, layer.mesh->n_nodes())),
      old_force_on_layer_(force_on_layer_) {}

void ToolInterface::update(double dt) {
  old_force_on_layer_.swap(force_on_layer_);
  force_on_layer_.setZero();
  old_tool_force_ = tool_.force;
  tool_.force.setZero();
  energies_.stored = 0;
  const Vector3 tool_increment(0, 0, tool_.increment);
  for (Eigen::Index i = 0; i < points_.size(); ++i) {
    const Vector3 slip = at(layer_.increment, i) - tool_increment;
    slack_(i) -= slip.norm();
    if (slack_(i) > 0) continue;
    const Distance d = tool_.shape->evaluate(at(layer_.position, i) - Vector3(0, 0, tool_.z));
    PointMotion motion{.distance = d.value,
                       .height = layer_.half_thickness(i),
                       .weight = 1,
                       .normal = -d.gradient,
                       .push = -d.gradient,
                       .slip = slip,
                       .dt = dt};
    if (dt == 0) points_.height(i) = motion.height;
    const Vector3 force = advance_point(law_, points_, i, motion, energies_);
    slack_(i) = points_.gap(i) - 0.5 * near_;  // thickness changes are far smaller than this margin
    for (int k = 0; k < 3; ++k) force_on_layer_(k, i) = force(k);
    tool_.force -= force;
  }
  energies_.work += 0.5 * ((old_force_on_layer_ + force_on_layer_) * layer_.increment).sum() +
                    0.5 * (old_tool_force_ + tool_.force).z() * tool_.increment;
}

void ToolInterface::add_rates_to(Scalars& rate) const {
  const double stiffness = std::max(law_.stiffness, law_.tangential);
  for (Eigen::Index i = 0; i < points_.size(); ++i)
    if (is_near(i)) rate(i) += stiffness * points_.area(i) / layer_.mass(i);
}

double ToolInterface::total_stiffness() const {
  double sum = 0;
  for (Eigen::Index i = 0; i < points_.size(); ++i)
    if (is_near(i)) sum += law_.stiffness * points_.area(i);
  return sum;
}

}  // namespace interply::contact
