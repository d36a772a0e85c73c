#include "contact/tool_interface.hpp"

#include <algorithm>
#include <utility>

#include "contact/rows.hpp"

namespace interply::contact {

using mechanics::at;

ToolInterface::ToolInterface(const InterfaceLaw& law, const LayerGeometry& layer, Tool& tool,
                             std::shared_ptr<Scratch> scratch)
    : law_(law),
      kernels_(choose_tool_kernels()),
      layer_(layer),
      tool_(tool),
      points_(mechanics::compute_tributary_areas(layer.mesh()), law.tangential),
      slack_(Scalars::Zero(layer.n_nodes())),
      near_(0),
      scratch_(std::move(scratch)),
      on_layer_(layer, scratch_->lower),
      block_sums_(static_cast<std::size_t>(count_blocks(points_.size()))) {
  for (Eigen::Index i = 0; i < layer.n_nodes(); ++i) near_ = std::max(near_, layer.half_thickness(i));
}

void ToolInterface::update(double dt, const BlockRunner& run) {
  const ToolShape shape = tool_.shape->to_shape();
  const ToolRows rows{.law = law_,
                      .dt = dt,
                      .z = tool_.z,
                      .increment = tool_.increment,
                      .margin = 0.5 * near_,  // thickness changes are far smaller
                      .layer = layer_.nodes(),
                      .slack = slack_.data(),
                      .points = get_rows(points_),
                      .force = on_layer_.records()};
  for_each_block(run, points_.size(), [&](Eigen::Index block, Eigen::Index begin, Eigen::Index end) {
    block_sums_[static_cast<std::size_t>(block)] = kernels_.advance(shape, rows, begin, end);
  });
  Span acting;
  old_tool_force_ = tool_.force;
  tool_.force.setZero();
  tool_.moment.setZero();
  energies_.stored = 0;
  for (std::size_t b = 0; b < block_sums_.size(); ++b) {
    const ToolSums& sums = block_sums_[b];
    const auto begin = static_cast<Eigen::Index>(b) * kBlockSize;
    if (sums.touches) acting = join(acting, {begin, std::min(begin + kBlockSize, points_.size())});
    energies_.add(sums.energies);
    tool_.force -= Vector3(sums.force[0], sums.force[1], sums.force[2]);
    tool_.moment -= Vector3(sums.moment[0], sums.moment[1], sums.moment[2]);
  }
  finish(acting);
}

void ToolInterface::finish(const Span& acting) {
  energies_.work += on_layer_.finish(acting);
  energies_.work += 0.5 * (old_tool_force_ + tool_.force).z() * tool_.increment;
}

void ToolInterface::update_plainly(double dt) {
  on_layer_.clear_records();
  old_tool_force_ = tool_.force;
  tool_.force.setZero();
  tool_.moment.setZero();
  energies_.stored = 0;
  const Vector3 tool_increment(0, 0, tool_.increment);
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
  }
  finish({0, points_.size()});
}

void ToolInterface::add_rates_to(Rates& rates) const {
  const double most = std::max(law_.stiffness, law_.tangential);
  for (Eigen::Index i = 0; i < points_.size(); ++i) {
    if (!is_near(i)) continue;
    const double sum = points_.area(i) / layer_.mass()(i);
    rates.stiffness(i) += most * compute_turning_factor(layer_.half_thickness(i), points_.area(i)) * sum;
    rates.damping(i) += law_.damping * sum;
  }
}

double ToolInterface::near_area() const {
  double sum = 0;
  for (Eigen::Index i = 0; i < points_.size(); ++i)
    if (is_near(i)) sum += points_.area(i);
  return sum;
}

}  // namespace interply::contact
