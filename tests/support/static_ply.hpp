/// Static equilibrium of one ply with some of its nodes held: dynamic relaxation of the real FabricLayer, no contact,
/// no coordinator.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "solver_fabric/fabric_layer.hpp"

namespace interply::test {

using mechanics::NodalVectors;

/// Fibres `ratio` times stiffer than the shear of a shear modulus of 0.1 MPa, both linear and without couplings: as
/// nearly inextensible as the tests of nets need.
inline scene::WovenLaw make_net_law(double ratio) {
  const double shear = 0.1, fibre = ratio * shear;  // MPa; the energy d e^2 has the stiffness 2 d
  scene::WovenLaw law;
  law.variant = scene::Variant::Uncoupled;
  law.a = {0, 0};
  law.b = law.d = {fibre / 2, fibre / 2};
  law.s = {shear, 0, 0};
  return law;
}

/// A force on the nodes besides f_int, added with the sign of f_int, and its stiffness per node (N/mm).
struct Support {
  double stiffness = 0;
  std::function<void(const NodalVectors& position, NodalVectors& force)> add_to;
};

/// A ply without bending, thickness 1.2 mm, that looks for its equilibrium.
class StaticPly {
 public:
  NodalVectors position;  ///< [3 x n_nodes] mm; move held nodes before relax()
  NodalVectors free;      ///< 1: free, 0: held [3 x n_nodes]
  NodalVectors force;     ///< f_int at `position`; at held components the reaction, N
  fabric::FabricLayer layer;

  StaticPly(const mechanics::TriangleMesh& mesh, const scene::WovenLaw& law, double orientation_deg)
      : position(mesh.reference),
        free(NodalVectors::Ones(3, mesh.n_nodes())),
        force(NodalVectors::Zero(3, mesh.n_nodes())),
        layer(make_ply(law, orientation_deg), 1, mesh),
        mass_(mechanics::compute_lumped_mass(mesh, kThickness, kDensity)),
        velocity_(NodalVectors::Zero(3, mesh.n_nodes())) {}

  /// Moves the free components until no force on any of them is above `largest` (N): motion without damping that stops
  /// dead whenever the kinetic energy has passed a peak, and starts again with half a kick.
  /// @throws std::runtime_error if `limit` steps do not suffice
  void relax(double largest, const Support& support = {}, int limit = 50000) {
    double kinetic = 0, dt = 0;
    bool at_rest = true;
    for (int step = 0; step < limit; ++step) {
      update_force();
      if (support.add_to) support.add_to(position, force);
      if ((force * free).abs().maxCoeff() <= largest) return;
      if (step % 20 == 0) {
        const double vote = layer.compute_stable_increment(position);
        dt = 0.9 / std::sqrt(1 / (vote * vote) + support.stiffness / mass_.minCoeff() / 4);
      }
      if (at_rest) velocity_.setZero();
      for (int c = 0; c < 3; ++c)
        velocity_.row(c) -= (at_rest ? 0.5 : 1) * dt * force.row(c) * free.row(c) / mass_.transpose();
      const double now = (velocity_.square().colwise().sum() * mass_.transpose()).sum();
      at_rest = now < kinetic;
      kinetic = at_rest ? 0 : now;
      if (!at_rest) position += dt * velocity_;
    }
    throw std::runtime_error("the ply has found no equilibrium");
  }

  /// f_int and the energy at `position`.
  void update_force() { layer.compute_internal_forces(position, {}, force); }

  /// Values of an element field, "shear_angle" (rad), "stretch_warp", ...
  std::vector<double> field(const std::string& name) const {
    for (const auto& f : layer.compute_fields(position))
      if (f.name == name) return f.values;
    throw std::invalid_argument(name);
  }

  /// Largest |l - 1| of both fibres.
  double largest_fibre_strain() const {
    double largest = 0;
    for (const char* name : {"stretch_warp", "stretch_weft"})
      for (const double l : field(name)) largest = std::max(largest, std::abs(l - 1));
    return largest;
  }

  static constexpr double kThickness = 1.2;     ///< mm
  static constexpr double kDensity = 6.19e-10;  ///< t/mm3

 private:
  static scene::Layer make_ply(const scene::WovenLaw& law, double orientation_deg) {
    scene::Layer layer;
    layer.name = "ply";
    layer.thickness = kThickness;
    layer.density = kDensity;
    layer.orientation_deg = orientation_deg;
    layer.law = law;
    layer.bending = {0, 0};
    layer.twist = 0;
    return layer;
  }

  mechanics::Scalars mass_;
  NodalVectors velocity_;
};

}  // namespace interply::test
