#include "contact/tool_interface.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/rows.hpp"

namespace interply::contact {

using mechanics::at;

ToolInterface::ToolInterface(const InterfaceLaw& law, const LayerGeometry& layer, Tool& tool,
                             std::shared_ptr<Scratch> scratch)
    : law_(law),
      kernels_(choose_contact_kernels()),
      layer_(layer),
      tool_(tool),
      points_(mechanics::compute_tributary_areas(layer.mesh()), law.tangential),
      slack_(Scalars::Zero(layer.n_nodes())),
      near_(0),
      gap_(points_.gap),
      gradient_(NodalVectors::Zero(3, layer.n_nodes())),
      scratch_(std::move(scratch)),
      on_layer_(layer, scratch_->lower),
      block_sums_(static_cast<std::size_t>(count_blocks(points_.size()))),
      block_touches_(block_sums_.size()) {
  gradient_.row(2) = 1;
  for (Eigen::Index i = 0; i < layer.n_nodes(); ++i) near_ = std::max(near_, layer.half_thickness(i));
}

/// Distances of those of the nodes [begin, end) that may be near. Returns whether one of them touches or did.
bool ToolInterface::evaluate(Eigen::Index begin, Eigen::Index end) {
  bool touches = false;  // nodes that touch have no slack
  for (Eigen::Index i = begin; i < end; ++i) {
    if (slack_(i) > 0) {
      const Quad& by = layer_.node(i).increment;
      const double down = by.z - tool_.increment;
      slack_(i) -= std::sqrt(by.x * by.x + by.y * by.y + down * down);
    }
    if (slack_(i) > 0) continue;
    const Distance d = tool_.shape->evaluate(layer_.position(i) - Vector3(0, 0, tool_.z));
    gap_(i) = d.value - layer_.half_thickness(i);
    for (int k = 0; k < 3; ++k) gradient_(k, i) = d.gradient(k);
    slack_(i) = gap_(i) - 0.5 * near_;  // thickness changes are far smaller than this margin
    touches = touches || gap_(i) < 0 || points_.gap(i) < 0;
  }
  return touches;
}

void ToolInterface::update(double dt, const BlockRunner& run) {
  const ToolRows rows{.law = law_,
                      .dt = dt,
                      .increment = tool_.increment,
                      .layer = layer_.nodes(),
                      .gradient = get_rows(std::as_const(gradient_)),
                      .gap = gap_.data(),
                      .points = get_rows(points_),
                      .force = on_layer_.records()};
  for_each_block(run, points_.size(), [&](Eigen::Index block, Eigen::Index begin, Eigen::Index end) {
    const auto b = static_cast<std::size_t>(block);
    block_touches_[b] = evaluate(begin, end);
    if (block_touches_[b]) {
      block_sums_[b] = kernels_.advance_tool(rows, begin, end);
      return;
    }
    block_sums_[b] = {};
    std::fill(rows.force + 2 * begin, rows.force + 2 * end, Quad{});
    points_.gap.segment(begin, end - begin) = gap_.segment(begin, end - begin);
    for (Eigen::Index i = begin; i < end; ++i) points_.height(i) = layer_.half_thickness(i);
  });
  old_tool_force_ = tool_.force;
  tool_.force.setZero();
  tool_.moment.setZero();
  energies_.stored = 0;
  for (const ToolSums& sums : block_sums_) {
    energies_.add(sums.energies);
    tool_.force -= Vector3(sums.force[0], sums.force[1], sums.force[2]);
    tool_.moment -= Vector3(sums.moment[0], sums.moment[1], sums.moment[2]);
  }
  finish(std::find(block_touches_.begin(), block_touches_.end(), 1) != block_touches_.end());
}

void ToolInterface::finish(bool touches) {
  energies_.work += touches ? on_layer_.finish() : on_layer_.finish_without_forces();
  energies_.work += 0.5 * (old_tool_force_ + tool_.force).z() * tool_.increment;
}

void ToolInterface::update_plainly(double dt) {
  on_layer_.clear_records();
  old_tool_force_ = tool_.force;
  tool_.force.setZero();
  tool_.moment.setZero();
  energies_.stored = 0;
  const Vector3 tool_increment(0, 0, tool_.increment);
  bool touches = false;
  for (Eigen::Index i = 0; i < points_.size(); ++i) {
    const Vector3 x = layer_.position(i), n = layer_.normal(i);
    const Distance d = tool_.shape->evaluate(x - Vector3(0, 0, tool_.z));
    const double height = layer_.half_thickness(i);
    if (dt == 0) points_.height(i) = height;
    if (stays_open(points_, i, d.value - height, height, 1)) continue;
    const double side = d.gradient.dot(n) > 0 ? -height : height;  // of the layer's surface that faces the tool
    const PointMotion motion{.distance = d.value,
                             .height = height,
                             .weight = 1,
                             .normal = -d.gradient,
                             .stick = at(points_.stick, i),
                             .slip = layer_.increment(i) - tool_increment + side * layer_.turn(i),
                             .dt = dt};
    const PointForce force = advance_point(law_, points_, i, motion, energies_);
    const Vector3 total = force.drag + force.pressing * d.gradient, pull = side * force.drag;
    on_layer_.records()[2 * i] = {total.x(), total.y(), total.z(), 0};
    on_layer_.records()[2 * i + 1] = {pull.x(), pull.y(), pull.z(), 0};
    tool_.force -= total;
    tool_.moment -= x.cross(total) + n.cross(pull);
    touches = true;
  }
  finish(touches);
}

void ToolInterface::add_rates_to(Scalars& rate) const {
  const double stiffness = std::max(law_.stiffness, law_.tangential);
  for (Eigen::Index i = 0; i < points_.size(); ++i)
    if (is_near(i))
      rate(i) += stiffness * points_.area(i) / layer_.mass()(i) *
                 compute_turning_factor(layer_.half_thickness(i), points_.area(i));
}

double ToolInterface::total_stiffness() const {
  double sum = 0;
  for (Eigen::Index i = 0; i < points_.size(); ++i)
    if (is_near(i)) sum += law_.stiffness * points_.area(i);
  return sum;
}

}  // namespace interply::contact
