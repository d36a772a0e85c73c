/// The laminate between its tools as the coordinator sees it: geometry of every layer, contact between neighbours,
/// tools.
#pragma once

#include <memory>
#include <vector>

#include "contact/layer_interface.hpp"
#include "contact/tool_interface.hpp"
#include "coordinator/blank_holder.hpp"
#include "coordinator/pace.hpp"
#include "observe/frames.hpp"
#include "scene/scene.hpp"
#include "solve/blocks.hpp"

namespace interply::coordinator {

/// One layer: what contact needs of it, and the force that contact returns to it.
struct LayerSlot {
  mechanics::TriangleMesh mesh;
  contact::LayerGeometry geometry;
  double vote = 0;       ///< latest stable increment of the layer alone, s
  bool is_here = false;  ///< its motion of this step has arrived
  bool is_sent = false;  ///< its force of this step has been summed up
};

/// Interface i couples layer i - 1 (or the die, i = 0) to layer i (or the tools above the top layer).
class Stack {
 public:
  explicit Stack(const scene::Scene& scene);
  Stack(const Stack&) = delete;
  Stack& operator=(const Stack&) = delete;

  int n_layers() const { return static_cast<int>(layers_.size()); }
  const LayerSlot& layer(int i) const { return layers_[static_cast<std::size_t>(i)]; }

  /// Tools to t(n). @param punch_travel  downwards since the start, mm   @param blank_holder_increment  mm
  void move_tools(double punch_travel, double blank_holder_increment);
  /// Nobody has arrived yet at this step.
  void begin_step();
  /// @param position  x(n) [3 x n_nodes] mm   @param thickness  at the nodes, mm, or empty if it is constant
  /// @param vote      latest stable increment of the layer alone, s
  void take_motion(int i, const mechanics::NodalVectors& position, const mechanics::Scalars& thickness, double vote);
  /// Every interface of layer i that has both partners now. @pre each is called once a step, in any order of layers
  void compute_contact_of(int i, double dt);
  /// Layer i's faces are both done and its force has not been summed up yet.
  bool can_send_force(int i) const;
  /// Sum of the contact forces on layer i, its lower face first, N; once a step.
  void sum_force(int i, mechanics::NodalVectors& force);
  bool is_step_complete() const;

  /// Largest stable increments (fastest_mode.hpp): of the layers as they last said, and with what contact adds.
  Votes collect_votes() const;

  /// All interfaces in the order of name_interfaces(): die, between layers upwards, blank holder, punch.
  int n_interfaces() const { return n_layers() + 1 + (punch_ ? 1 : 0); }
  const contact::LayerInterface* between_layers(int interface) const;  ///< null: against a tool
  const contact::ToolInterface* against_tool(int interface) const;     ///< null: between layers
  const contact::InterfaceLaw& law(int interface) const;
  const contact::Points& points(int interface) const;
  const contact::InterfaceEnergies& energies(int interface) const;
  /// Thickness of the thinner partner, mm.
  double thinner(int interface) const;

  const contact::Tool& die() const { return die_tool_; }
  const contact::Tool& blank_holder() const { return blank_holder_tool_; }
  const contact::Tool* punch() const { return punch_tool_.shape ? &punch_tool_ : nullptr; }
  const std::vector<observe::ToolSurface>& tool_surfaces() const { return tool_surfaces_; }
  double flange_area() const { return flange_area_; }  ///< modelled part, mm2
  double mass() const { return mass_; }                ///< of the modelled laminate, with mass scaling, t
  double stiffness() const { return stiffness_; }      ///< of all interfaces in series under the flange, N/mm

 private:
  contact::InterfaceLaw make_law(int lower, int upper, double friction) const;

  const scene::Scene& scene_;
  solve::Workers workers_;
  contact::BlockRunner run_;  ///< on the workers
  std::vector<LayerSlot> layers_;
  contact::Tool die_tool_, blank_holder_tool_, punch_tool_;
  std::unique_ptr<contact::ToolInterface> die_, blank_holder_, punch_;
  std::vector<std::unique_ptr<contact::LayerInterface>> between_;  ///< i: layers i and i + 1
  std::vector<observe::ToolSurface> tool_surfaces_;                ///< die, blank holder, punch if there is one
  double flange_area_ = 0, mass_ = 0, stiffness_ = 0, punch_start_ = 0;
};

/// Coulomb coefficient between two neighbours; tools are "die", "punch", "blank_holder".
double find_friction(const scene::Scene& scene, const std::string& first, const std::string& second);

}  // namespace interply::coordinator
