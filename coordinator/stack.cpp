#include "coordinator/stack.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/coordinator.hpp"
#include "coordinator/fastest_mode.hpp"
#include "coordinator/tool_surfaces.hpp"
#include "coordinator/tools.hpp"
#include "solve/layer_mechanics.hpp"

namespace interply::coordinator {

using mechanics::Scalars;

namespace {

constexpr int kTool = -1;

bool is_tool(const std::string& name) { return name == "die" || name == "punch" || name == "blank_holder"; }

}  // namespace

double find_friction(const scene::Scene& scene, const std::string& first, const std::string& second) {
  const scene::Contact& c = scene.contact;
  for (const scene::PairFriction& pair : c.pairs)
    if ((pair.first == first && pair.second == second) || (pair.first == second && pair.second == first))
      return pair.coefficient;
  const auto is_fabric = [&](const std::string& name) {
    return std::any_of(scene.layers.begin(), scene.layers.end(),
                       [&](auto& l) { return l.name == name && l.kind() == scene::Kind::Fabric; });
  };
  const int fabrics = is_fabric(first) + is_fabric(second);
  if (is_tool(first) || is_tool(second)) return fabrics ? c.tool_fabric : c.tool_steel;
  return fabrics == 2 ? c.fabric_fabric : fabrics == 1 ? c.steel_fabric : c.steel_steel;
}

std::vector<InterfaceName> name_interfaces(const scene::Scene& scene) {
  std::vector<InterfaceName> names;
  const auto& layers = scene.layers;
  const std::string &first = layers.front().name, &last = layers.back().name;
  names.push_back({"die|" + first, first, "die"});
  for (std::size_t i = 0; i + 1 < layers.size(); ++i)
    names.push_back({layers[i].name + "|" + layers[i + 1].name, layers[i].name, layers[i + 1].name});
  names.push_back({last + "|blank_holder", last, "blank_holder"});
  if (scene.tools.punch) names.push_back({last + "|punch", last, "punch"});
  return names;
}

Stack::Stack(const scene::Scene& scene)
    : scene_(scene),
      workers_(scene.contact.threads),
      run_([this](Eigen::Index n, const auto& body) { workers_.for_each(n, body); }, scene.contact.threads),
      layers_(scene.layers.size()) {
  double height = 0;
  for (int i = 0; i < n_layers(); ++i) {
    const scene::Layer& layer = scene.layers[static_cast<std::size_t>(i)];
    LayerSlot& slot = layers_[static_cast<std::size_t>(i)];
    slot.mesh = solve::make_layer_mesh(scene, i);
    slot.geometry = {slot.mesh, layer.thickness, layer.density * scene.time.mass_scaling};
    mass_ += slot.geometry.mass().sum();
    height += layer.thickness;
  }

  PlacedTools placed = place_tools(scene, layer(0).mesh, layer(n_layers() - 1).mesh, height);
  flange_area_ = placed.flange_area;
  tool_surfaces_ = make_tool_surfaces(scene, placed, layer(n_layers() - 1).mesh);
  const auto take = [](contact::Tool& tool, const char* name, PlacedTool& from) {
    tool.name = name;
    tool.shape = std::move(from.shape);
    tool.z = from.z;
  };
  take(die_tool_, "die", placed.die);
  take(blank_holder_tool_, "blank_holder", placed.blank_holder);
  const int top = n_layers() - 1;
  const std::string &first = scene.layers.front().name, &last = scene.layers.back().name;
  const auto scratch = std::make_shared<contact::Scratch>();
  die_ = std::make_unique<contact::ToolInterface>(make_law(kTool, 0, find_friction(scene, "die", first)),
                                                  layer(0).geometry, die_tool_, scratch);
  for (int i = 0; i < top; ++i) {
    const double friction = find_friction(scene, scene.layers[static_cast<std::size_t>(i)].name,
                                          scene.layers[static_cast<std::size_t>(i) + 1].name);
    between_.push_back(std::make_unique<contact::LayerInterface>(make_law(i, i + 1, friction), layer(i).geometry,
                                                                 layer(i + 1).geometry, scratch));
  }
  blank_holder_ =
      std::make_unique<contact::ToolInterface>(make_law(top, kTool, find_friction(scene, last, "blank_holder")),
                                               layer(top).geometry, blank_holder_tool_, scratch);
  if (placed.punch.shape) {
    take(punch_tool_, "punch", placed.punch);
    punch_start_ = punch_tool_.z;
    punch_ = std::make_unique<contact::ToolInterface>(make_law(top, kTool, find_friction(scene, last, "punch")),
                                                      layer(top).geometry, punch_tool_, scratch);
  }

  double compliance = 0;  // of all interfaces in series
  for (int i = 0; i <= top + 1; ++i)
    compliance += 1 / make_law(i == 0 ? kTool : i - 1, i == top + 1 ? kTool : i, 0).stiffness;
  stiffness_ = flange_area_ / compliance;
}

contact::InterfaceLaw Stack::make_law(int lower, int upper, double friction) const {
  double thickness = std::numeric_limits<double>::infinity();
  double mass[2] = {thickness, thickness};  // per area; a tool is infinitely heavy
  for (int side = 0; side < 2; ++side) {
    const int i = side == 0 ? lower : upper;
    if (i == kTool) continue;
    const scene::Layer& l = scene_.layers[static_cast<std::size_t>(i)];
    thickness = std::min(thickness, l.thickness);
    mass[side] = l.density * scene_.time.mass_scaling * l.thickness;
  }
  const scene::Contact& c = scene_.contact;
  const double stiffness = contact::compute_stiffness(c.reference_pressure, c.penetration, thickness);
  return {.stiffness = stiffness,
          .tangential = c.tangential_stiffness * stiffness,
          .damping = contact::compute_damping(c.damping, stiffness, mass[0], mass[1]),
          .friction = friction};
}

void Stack::move_tools(double punch_travel, double blank_holder_increment) {
  blank_holder_tool_.increment = blank_holder_increment;
  blank_holder_tool_.z += blank_holder_increment;
  const double z = punch_start_ - punch_travel;
  punch_tool_.increment = z - punch_tool_.z;
  punch_tool_.z = z;
}

void Stack::begin_step() {
  for (LayerSlot& slot : layers_) slot.is_here = slot.is_sent = false;
}

void Stack::take_motion(int i, const mechanics::NodalVectors& position, const Scalars& thickness, double vote) {
  LayerSlot& slot = layers_[static_cast<std::size_t>(i)];
  slot.geometry.move_to(position);
  if (thickness.size() > 0) slot.geometry.set_half_thickness(0.5 * thickness);
  slot.vote = vote;
  slot.is_here = true;
}

void Stack::compute_contact_of(int i, double dt) {
  const int top = n_layers() - 1;
  if (i == 0) die_->update(dt, run_);
  if (i > 0 && layer(i - 1).is_here) between_[static_cast<std::size_t>(i) - 1]->update(dt, run_);
  if (i < top && layer(i + 1).is_here) between_[static_cast<std::size_t>(i)]->update(dt, run_);
  if (i == top) {
    blank_holder_->update(dt, run_);
    if (punch_) punch_->update(dt, run_);
  }
}

bool Stack::can_send_force(int i) const {
  const int top = n_layers() - 1;
  return layer(i).is_here && !layer(i).is_sent && (i == 0 || layer(i - 1).is_here) &&
         (i == top || layer(i + 1).is_here);
}

void Stack::sum_force(int i, mechanics::NodalVectors& force) {
  const auto below = static_cast<std::size_t>(i) - 1, above = static_cast<std::size_t>(i);
  const mechanics::NodalVectors& from_below = i == 0 ? die_->force_on_layer() : between_[below]->force_on_upper();
  if (i < n_layers() - 1)
    force = from_below + between_[above]->force_on_lower();
  else if (punch_)
    force = from_below + blank_holder_->force_on_layer() + punch_->force_on_layer();
  else
    force = from_below + blank_holder_->force_on_layer();
  layers_[above].is_sent = true;
}

bool Stack::is_step_complete() const {
  return std::all_of(layers_.begin(), layers_.end(), [](const LayerSlot& s) { return s.is_here; });
}

Votes Stack::collect_votes() const {
  const std::size_t n = layers_.size();
  Chain chain(n + 1);  // and the blank holder
  std::vector<contact::Rates> within;
  for (const LayerSlot& slot : layers_) within.emplace_back(slot.mesh.n_nodes());
  for (std::size_t i = 0; i + 1 < n; ++i) {
    contact::Rates up(layers_[i].mesh.n_nodes()), down(layers_[i + 1].mesh.n_nodes());
    between_[i]->add_rates_to({within[i], up}, {within[i + 1], down});
    chain.up[i] = up.find_largest();
    chain.down[i] = down.find_largest();
  }
  contact::Rates under_holder(layers_.back().mesh.n_nodes());
  blank_holder_->add_rates_to(under_holder);
  within.back() += under_holder;
  die_->add_rates_to(within.front());
  if (punch_) punch_->add_rates_to(within.back());

  const contact::InterfaceLaw law = make_law(n_layers() - 1, kTool, 0);
  const scene::BlankHolder& holder = scene_.tools.blank_holder;
  const double mass = holder.mass_ratio * mass_, area = blank_holder_->near_area();
  chain.up.back() = under_holder.find_largest();
  chain.down.back() = chain.own.back() = {law.stiffness * area / mass, law.damping * area / mass};
  chain.own.back().damping += 2 * holder.damping * std::sqrt(stiffness_ / mass);  // its damper, blank_holder.hpp

  for (std::size_t i = 0; i < n; ++i) chain.own[i] = within[i].find_largest();
  Votes votes{.contact = find_fastest_mode(chain).increment};
  for (std::size_t i = 0; i < n; ++i) {
    const double vote = layers_[i].vote;
    votes.layers.push_back(vote);
    chain.own[i].stiffness += 4 / (vote * vote);
  }
  const FastestMode mode = find_fastest_mode(chain);
  votes.stack = mode.increment;
  votes.fastest = mode.member;
  return votes;
}

const contact::LayerInterface* Stack::between_layers(int interface) const {
  const bool is_between = interface > 0 && interface < n_layers();
  return is_between ? between_[static_cast<std::size_t>(interface) - 1].get() : nullptr;
}

const contact::ToolInterface* Stack::against_tool(int interface) const {
  if (between_layers(interface)) return nullptr;
  return (interface == 0 ? die_ : interface == n_layers() ? blank_holder_ : punch_).get();
}

const contact::InterfaceLaw& Stack::law(int interface) const {
  const contact::LayerInterface* between = between_layers(interface);
  return between ? between->law() : against_tool(interface)->law();
}

const contact::Points& Stack::points(int interface) const {
  const contact::LayerInterface* between = between_layers(interface);
  return between ? between->points() : against_tool(interface)->points();
}

const contact::InterfaceEnergies& Stack::energies(int interface) const {
  const contact::LayerInterface* between = between_layers(interface);
  return between ? between->energies() : against_tool(interface)->energies();
}

double Stack::thinner(int interface) const {
  const auto thickness = [&](int i) { return scene_.layers[static_cast<std::size_t>(i)].thickness; };
  const int n = n_layers();
  if (interface == 0) return thickness(0);
  if (interface >= n) return thickness(n - 1);
  return std::min(thickness(interface - 1), thickness(interface));
}

}  // namespace interply::coordinator
