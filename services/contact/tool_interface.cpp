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
      old_force_on_layer_(force_on_layer_),
      pull_on_layer_(force_on_layer_) {}

void ToolInterface::update(double dt) {
  old_force_on_layer_.swap(force_on_layer_);
  force_on_layer_.setZero();
  pull_on_layer_.setZero();
  old_tool_force_ = tool_.force;
  tool_.force.setZero();
  tool_.moment.setZero();
  energies_.stored = 0;
  const Vector3 tool_increment(0, 0, tool_.increment);
  bool touches = false;
  for (Eigen::Index i = 0; i < points_.size(); ++i) {
    const Vector3 increment = at(layer_.increment, i) - tool_increment;
    slack_(i) -= increment.norm();
    if (slack_(i) > 0) continue;
    const Vector3 x = at(layer_.position, i), n = at(layer_.normal, i);
    const Distance d = tool_.shape->evaluate(x - Vector3(0, 0, tool_.z));
    const double height = layer_.half_thickness(i);
    if (dt == 0) points_.height(i) = height;
    slack_(i) = d.value - height - 0.5 * near_;  // thickness changes are far smaller than this margin
    if (stays_open(points_, i, d.value - height, height, 1)) continue;
    const double side = d.gradient.dot(n) > 0 ? -height : height;  // of the layer's surface that faces the tool
    const PointMotion motion{.distance = d.value,
                             .height = height,
                             .weight = 1,
                             .normal = -d.gradient,
                             .stick = at(points_.stick, i),
                             .slip = increment + side * at(layer_.turn, i),
                             .dt = dt};
    const PointForce force = advance_point(law_, points_, i, motion, energies_);
    const Vector3 push = force.pressing * d.gradient, total = force.drag + push;
    for (int k = 0; k < 3; ++k) {
      force_on_layer_(k, i) = total(k);
      pull_on_layer_(k, i) = side * force.drag(k);
    }
    tool_.force -= total;
    tool_.moment -= x.cross(total) + side * n.cross(force.drag);
    touches = true;
  }
  if (touches) layer_.normals->add_forces_to(layer_.position, layer_.normal, pull_on_layer_, force_on_layer_);
  energies_.work += 0.5 * ((old_force_on_layer_ + force_on_layer_) * layer_.increment).sum() +
                    0.5 * (old_tool_force_ + tool_.force).z() * tool_.increment;
}

void ToolInterface::add_rates_to(Scalars& rate) const {
  const double stiffness = std::max(law_.stiffness, law_.tangential);
  for (Eigen::Index i = 0; i < points_.size(); ++i)
    if (is_near(i))
      rate(i) += stiffness * points_.area(i) / layer_.mass(i) *
                 compute_turning_factor(layer_.half_thickness(i), points_.area(i));
}

double ToolInterface::total_stiffness() const {
  double sum = 0;
  for (Eigen::Index i = 0; i < points_.size(); ++i)
    if (is_near(i)) sum += law_.stiffness * points_.area(i);
  return sum;
}

}  // namespace interply::contact
