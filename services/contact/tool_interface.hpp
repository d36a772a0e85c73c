/// Contact of one layer with one rigid tool given as a signed distance field. Pressure acts on the midsurface node
/// along the field's gradient; friction and damper act where the layer's surface is, half a thickness away along the
/// layer's own normal, and slip is measured there (THEORY.md 2).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "contact/layer_interface.hpp"
#include "contact/points.hpp"
#include "contact/signed_distance.hpp"

namespace interply::contact {

/// A rigid tool that only moves vertically.
struct Tool {
  std::string name;
  std::unique_ptr<SignedDistance> shape;
  double z = 0;                      ///< height of the tool's reference point, mm
  double increment = 0;              ///< z(n) - z(n - 1), mm
  Vector3 force = Vector3::Zero();   ///< of the layers on the tool, N
  Vector3 moment = Vector3::Zero();  ///< of the same about the origin, N mm
};

class ToolInterface {
 public:
  /// @param scratch  as in LayerInterface
  ToolInterface(const InterfaceLaw& law, const LayerGeometry& layer, Tool& tool,
                std::shared_ptr<Scratch> scratch = std::make_shared<Scratch>());

  /// Advances all points and the force on the tool. Nodes that cannot have come near since their distance was last
  /// evaluated (a distance field is 1-Lipschitz) are skipped. @param dt, run  as in LayerInterface
  void update(double dt, const BlockRunner& run = {});
  /// The same point by point: what update() must agree with to round-off.
  void update_plainly(double dt);

  /// Adds the row sums of each node that is near the tool.
  void add_rates_to(Rates& rates) const;
  /// Area of these nodes, mm2.
  double near_area() const;

  const InterfaceLaw& law() const { return law_; }
  const Points& points() const { return points_; }
  const LayerGeometry& layer() const { return layer_; }
  const Tool& tool() const { return tool_; }
  /// Distance of node i to the tool now, from midsurface; points of nodes that cannot touch keep an older gap.
  Distance measure(Eigen::Index i) const {
    return tool_.shape->evaluate(layer_.position(i) - Vector3(0, 0, tool_.z));
  }
  const InterfaceEnergies& energies() const { return energies_; }
  const NodalVectors& force_on_layer() const { return on_layer_.force(); }  ///< [3 x n_nodes] N

 private:
  bool is_near(Eigen::Index i) const { return points_.gap(i) < near_; }
  void finish(const Span& acting);

  InterfaceLaw law_;
  const ToolKernels& kernels_;
  const LayerGeometry& layer_;
  Tool& tool_;
  Points points_;
  Scalars slack_;  ///< path length that the node may still move relative to the tool before it can touch [n] mm
  double near_;    ///< gap below which a node counts for the stable increment, mm
  std::shared_ptr<Scratch> scratch_;
  FaceForces on_layer_;
  std::vector<ToolSums> block_sums_;
  Vector3 old_tool_force_ = Vector3::Zero();
  InterfaceEnergies energies_;
};

}  // namespace interply::contact
