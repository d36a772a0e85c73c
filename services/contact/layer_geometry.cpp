#include "contact/layer_geometry.hpp"

#include <span>

#include "contact/fours.hpp"

namespace interply::contact {

using Eigen::Index;

LayerGeometry::LayerGeometry(const mechanics::TriangleMesh& mesh, double thickness, double density)
    : mesh_(&mesh),
      cells_(pair_triangles(mesh)),
      nodes_(static_cast<std::size_t>(mesh.n_nodes())),
      mass_(mechanics::compute_lumped_mass(mesh, thickness, density)),
      area_(nodes_.size()),
      inverse_length_(mesh.n_nodes()),
      sideways_(Scalars::Ones(mesh.n_nodes())) {
  for (const int i : mesh.symmetry_nodes) sideways_(i) = 0;
  for (Index i = 0; i < mesh.n_nodes(); ++i) set(node(i).position, mechanics::at(mesh.reference, i));
  set_half_thickness(Scalars::Constant(mesh.n_nodes(), 0.5 * thickness));
  move_to(mesh.reference);
  for (Node& node : nodes_) node.turn = {};
}

void LayerGeometry::move_to(const NodalVectors& to) {
  const double* const x[3] = {&to(0, 0), &to(1, 0), &to(2, 0)};
  Node* const nodes = nodes_.data();
  Quad* const area = area_.data();
  for_each_four(0, n_nodes(), [&](Index i, int count) {
    Four row[4] = {load_row(x[0], i, count), load_row(x[1], i, count), load_row(x[2], i, count), Four{}};
    transpose(row[0], row[1], row[2], row[3]);
    for (int l = 0; l < count; ++l) {
      Node& node = nodes[i + l];
      const Four old = load(node.position), now = __builtin_shufflevector(row[l], old, 0, 1, 2, 7);
      store(node.position, now);
      store(node.increment, now - old);
      store(area[i + l], Four{});
    }
  });
  for (const auto& [a, b, c, d] : cells_.pairs) {
    const Four origin = load(nodes[a].position), across = load(nodes[c].position) - origin;
    const Four first = cross(load(nodes[b].position) - origin, across);
    const Four second = cross(across, load(nodes[d].position) - origin), both = first + second;
    add_to(area[a], both);
    add_to(area[b], first);
    add_to(area[c], both);
    add_to(area[d], second);
  }
  for (const auto& [a, b, c] : cells_.singles) {
    const Four origin = load(nodes[a].position);
    const Four twice = cross(load(nodes[b].position) - origin, load(nodes[c].position) - origin);
    add_to(area[a], twice);
    add_to(area[b], twice);
    add_to(area[c], twice);
  }
  for (const int i : mesh_->symmetry_nodes) area[i].y = 0;
  for_each_four(0, n_nodes(), [&](Index i, int count) {
    const Vectors s = gather(
        i, count, [&](Index k) -> auto& { return area[k]; });
    const Four inverse = 1 / sqrt(s.x * s.x + s.y * s.y + s.z * s.z);
    store_row(inverse_length_.data(), i, count, inverse);
    for (int l = 0; l < count; ++l) {
      Node& node = nodes[i + l];
      const Four now = inverse[l] * load(area[i + l]);
      store(node.turn, now - load(node.normal));
      store(node.normal, now);
    }
  });
}

void LayerGeometry::set_half_thickness(const Scalars& half) {
  for (Index i = 0; i < n_nodes(); ++i) node(i).position.w = half(i);
}

NodalVectors LayerGeometry::positions() const {
  NodalVectors x(3, n_nodes());
  for (Index i = 0; i < n_nodes(); ++i) x.col(i) = position(i).array();
  return x;
}

Scalars LayerGeometry::compute_tributary_areas() const {
  Scalars areas = Scalars::Zero(n_nodes());
  const mechanics::Triangles& corner = mesh_->triangles;
  for (Index e = 0; e < corner.cols(); ++e) {
    const Vector3 x = position(corner(0, e));
    const double area = 0.5 * (position(corner(1, e)) - x).cross(position(corner(2, e)) - x).norm();
    for (int k = 0; k < 3; ++k) areas(corner(k, e)) += area / 3;
  }
  return areas;
}

void LayerGeometry::add_forces_of_pulls(Quad* records, const Cells::Reach& reach) const {
  const Node* const nodes = nodes_.data();
  for_each_four(
      reach.nodes.first, reach.nodes.last,
      [&](Index i, int count) {  // pulls on normals to pulls on sums of area vectors
        const auto pull = [&](Index k) -> auto& { return records[2 * k + 1]; };
        const Vectors n = gather(
            i, count, [&](Index k) -> auto& { return nodes[k].normal; });
        const Vectors p = gather(i, count, pull);
        const Four along = p.x * n.x + p.y * n.y + p.z * n.z, inverse = load_row(inverse_length_.data(), i, count);
        scatter(i, count,
                {(p.x - along * n.x) * inverse, (p.y - along * n.y) * inverse * load_row(sideways_.data(), i, count),
                 (p.z - along * n.z) * inverse, Four{}},
                pull);
      });
  const Quad* const pull = records + 1;
  // s is a sum of u x v over the triangles
  for (const auto& [a, b, c, d] : std::span(cells_.pairs).subspan(reach.pairs.first, reach.pairs.size())) {
    const Four shared = load(pull[2 * a]) + load(pull[2 * c]);
    const Four p = load(pull[2 * b]) + shared, q = load(pull[2 * d]) + shared;
    const Four origin = load(nodes[a].position), across = load(nodes[c].position) - origin;
    const Four on_b = cross(across, p), on_d = cross(q, across);
    const Four on_c = cross(p, load(nodes[b].position) - origin) + cross(load(nodes[d].position) - origin, q);
    add_to(records[2 * a], -(on_b + on_c + on_d));
    add_to(records[2 * b], on_b);
    add_to(records[2 * c], on_c);
    add_to(records[2 * d], on_d);
  }
  for (const auto& [a, b, c] : std::span(cells_.singles).subspan(reach.singles.first, reach.singles.size())) {
    const Four q = load(pull[2 * a]) + load(pull[2 * b]) + load(pull[2 * c]);
    const Four origin = load(nodes[a].position);
    const Four on_b = cross(load(nodes[c].position) - origin, q), on_c = cross(q, load(nodes[b].position) - origin);
    add_to(records[2 * a], -on_b - on_c);
    add_to(records[2 * b], on_b);
    add_to(records[2 * c], on_c);
  }
}

}  // namespace interply::contact
