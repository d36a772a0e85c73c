#include "coordinator/interface_fields.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace interply::coordinator {

using contact::LayerGeometry;
using contact::NodalVectors;
using contact::Points;
using contact::Scalars;
using contact::State;
using contact::Vector3;
using mechanics::at;
using mechanics::Vector2;
using observe::Field;

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

Field make_field(const char* name, const char* unit, const char* description, const Scalars& a) {
  return {name, unit, description, true, {a.data(), a.data() + a.size()}, 1};
}
Field make_field(const char* name, const char* unit, const char* description, const NodalVectors& a) {
  return {name, unit, description, true, {a.data(), a.data() + a.size()}, static_cast<int>(a.rows())};
}

/// Current gaps and the directions along which they are measured, from the node to its partner.
struct Gaps {
  Scalars gap;          ///< mm
  NodalVectors normal;  ///< unit [3 x n]
};

Gaps measure_gaps(const contact::LayerInterface& between) {
  const LayerGeometry& lower = between.lower();
  Gaps gaps{between.points().gap, NodalVectors(3, lower.n_nodes())};
  for (Eigen::Index i = 0; i < lower.n_nodes(); ++i) gaps.normal.col(i) = lower.normal(i).array();
  return gaps;
}

Gaps measure_gaps(const contact::ToolInterface& against) {
  const LayerGeometry& layer = against.layer();
  Gaps gaps{against.points().gap, NodalVectors(3, layer.n_nodes())};
  for (Eigen::Index i = 0; i < layer.n_nodes(); ++i) {
    const contact::Distance d = against.measure(i);
    if (gaps.gap(i) > 0) gaps.gap(i) = d.value - layer.half_thickness(i);  // not looked at while it cannot touch
    gaps.normal.col(i) = -d.gradient.array();
  }
  return gaps;
}

/// Whoever has no share of the partner in front of it is past its edge, whether it has come by the far side or not.
Scalars describe_states(const Points& p) {
  return (p.weight > 0).select(p.state.cast<double>(), static_cast<double>(State::Passed));
}

/// s times the rows of a, value by value.
NodalVectors scale(const Scalars& s, const NodalVectors& a) {
  NodalVectors scaled = a;
  for (int d = 0; d < 3; ++d) scaled.row(d) *= s.transpose();
  return scaled;
}

/// F d: a direction d of the flat blank under the map of triangle e.
Vector3 carry_along(const LayerGeometry& layer, Eigen::Index e, const Vector2& d) {
  const auto& corner = layer.mesh().triangles;
  const Vector3 X = at(layer.mesh().reference, corner(0, e)), x = layer.position(corner(0, e));
  const Vector2 U = (at(layer.mesh().reference, corner(1, e)) - X).head<2>();
  const Vector2 V = (at(layer.mesh().reference, corner(2, e)) - X).head<2>();
  const double twice = U.x() * V.y() - U.y() * V.x();
  return (d.x() * V.y() - d.y() * V.x()) / twice * (layer.position(corner(1, e)) - x) +
         (U.x() * d.y() - U.y() * d.x()) / twice * (layer.position(corner(2, e)) - x);
}

/// The same at each node, mean over its triangles by their reference areas. [3 x n_nodes]
NodalVectors carry_along_at_nodes(const LayerGeometry& layer, const Vector2& d) {
  const Scalars area = mechanics::compute_areas(layer.mesh());
  NodalVectors sum = NodalVectors::Zero(3, layer.n_nodes());
  for (Eigen::Index e = 0; e < area.size(); ++e)
    for (int k = 0; k < 3; ++k) sum.col(layer.mesh().triangles(k, e)) += area(e) * carry_along(layer, e, d).array();
  return sum;
}

/// The same where each node of the lower layer faces the upper one. [3 x n_nodes of lower]
NodalVectors carry_along_at_facing(const contact::LayerInterface& between, const Vector2& d) {
  NodalVectors carried(3, between.lower().n_nodes());
  for (Eigen::Index i = 0; i < carried.cols(); ++i)
    carried.col(i) = carry_along(between.upper(), between.facing(i), d).array();
  return carried;
}

/// Components of tangential vectors along directions, laid across the normals and made unit. [n]
Scalars project(const NodalVectors& vectors, const NodalVectors& directions, const NodalVectors& normals) {
  Scalars along(vectors.cols());
  for (Eigen::Index i = 0; i < along.size(); ++i) {
    const Vector3 d = at(directions, i), n = at(normals, i);
    along(i) = at(vectors, i).dot((d - d.dot(n) * n).normalized());
  }
  return along;
}

/// Components of the tractions along the fibres of a ply. @param carry  F d at each node for a direction d
template <class Carry>
Field describe_along_fibres(const char* name, const char* description, const scene::Layer& ply,
                            const NodalVectors& traction, const NodalVectors& normal, const Carry& carry) {
  const double angle = ply.orientation_deg / kDegrees;
  const Vector2 warp(std::cos(angle), std::sin(angle)), weft(-warp.y(), warp.x());
  Field field{name, "MPa", description, true, {}, 2};
  for (const Vector2& fibre : {warp, weft}) {
    const Scalars along = project(traction, carry(fibre), normal);
    field.values.insert(field.values.end(), along.data(), along.data() + along.size());
  }
  return field;
}

const NodalVectors& find_force(const Stack& stack, int interface) {
  const contact::LayerInterface* between = stack.between_layers(interface);
  return between ? between->force_on_lower() : stack.against_tool(interface)->force_on_layer();
}

}  // namespace

std::vector<Field> describe_interface(const scene::Scene& scene, const Stack& stack, int interface) {
  const contact::LayerInterface* between = stack.between_layers(interface);
  const Points& p = stack.points(interface);
  const LayerGeometry& layer = between ? between->lower() : stack.against_tool(interface)->layer();
  const Gaps gaps = between ? measure_gaps(*between) : measure_gaps(*stack.against_tool(interface));
  const Scalars area = layer.compute_tributary_areas(), pressure = p.acting_pressure();
  const double on_upper = interface == 0 ? 1 : -1;  // points hold what acts on their own node; the die lies below it
  const NodalVectors traction = on_upper * p.acting_traction(), true_traction = scale(p.area / area, traction);
  const Scalars true_pressure = pressure * p.area / area;
  std::vector<Field> fields{
      make_field("pressure", "MPa", "normal pressure per reference area of the node, >= 0", pressure),
      make_field("tangential_traction", "MPa", "tangential traction on the upper partner, per reference area",
                 traction),
      make_field("gap", "mm", "gap along the normal, > 0 open", gaps.gap),
      make_field("slip", "mm", "accumulated length of the path that the node has slid on its partner", p.slip),
      make_field("friction_work", "mJ/mm2", "work dissipated by friction so far, per reference area of the node",
                 p.friction_work),
      make_field("state", "-", "0 open, 1 stick, 2 slide, 3 past the edge of the partner (nothing acts)",
                 describe_states(p)),
      make_field("share", "-", "share of the node's area that faces the partner, less than 1 past its edge", p.weight),
      make_field("force", "N", "contact force on the node of the layer that carries the fields",
                 find_force(stack, interface)),
      make_field("normal", "-", "unit vector from the node to its partner, along which the gap is measured",
                 gaps.normal),
      make_field("area", "mm2", "current area of the node: a third of the deformed midsurface triangles around it",
                 area),
      make_field("true_pressure", "MPa", "normal pressure per current area of the node, >= 0", true_pressure),
      make_field("true_traction", "MPa", "tangential traction on the upper partner, per current area", true_traction)};
  const std::size_t own = interface == 0 ? 0 : std::min(static_cast<std::size_t>(interface), scene.layers.size()) - 1;
  if (scene.layers[own].kind() == scene::Kind::Fabric)
    fields.push_back(describe_along_fibres(
        "true_traction_along_fibres", "true_traction projected on unit warp and weft of the layer that carries it",
        scene.layers[own], true_traction, gaps.normal,
        [&](const Vector2& d) { return carry_along_at_nodes(layer, d); }));
  if (between && scene.layers[own + 1].kind() == scene::Kind::Fabric)
    fields.push_back(describe_along_fibres(
        "true_traction_along_other_fibres", "true_traction projected on unit warp and weft of the other layer",
        scene.layers[own + 1], true_traction, gaps.normal,
        [&](const Vector2& d) { return carry_along_at_facing(*between, d); }));
  return fields;
}

std::vector<Field> describe_other_side(const Stack& stack, int interface) {
  const contact::LayerInterface* between = stack.between_layers(interface);
  if (!between) return {};
  return {make_field("force_on_other", "N", "contact force on the node of the other layer", between->force_on_upper())};
}

}  // namespace interply::coordinator
