/// Small sheets for the tests of the metal solver.
#pragma once

#include <cmath>
#include <random>

#include "solver_metal/metal_layer.hpp"

namespace interply::metal::test {

using mechanics::NodalVectors;
using mechanics::TriangleMesh;

inline constexpr double kDensity = 7.85e-9;

/// DC04 of the shipped scenes.
inline scene::J2Law make_dc04() { return {}; }

/// A law that never yields.
inline scene::J2Law make_elastic(double young = 210e3, double poisson = 0.3) {
  return {young, poisson, scene::HardeningTable{{{{0.0, 1e12}}}}};
}

inline scene::Layer make_sheet(const scene::J2Law& law, int points = 5, double thickness = 1.0, int threads = 1) {
  scene::Layer layer;
  layer.name = "sheet";
  layer.thickness = thickness;
  layer.density = kDensity;
  layer.law = law;
  layer.integration_points = points;
  layer.threads = threads;
  return layer;
}

/// Rectangle around the origin whose inner nodes are moved at random by up to `amount` x h.
inline TriangleMesh make_distorted_square(double length, double h, double amount) {
  TriangleMesh mesh = mechanics::make_rectangle({-length / 2, length / 2}, {-length / 2, length / 2}, h);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> offset(-amount * h, amount * h);
  for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i) {
    const double dx = offset(random), dy = offset(random);
    const bool inner = mesh.reference.col(i).head(2).abs().maxCoeff() < length / 2 - h / 2;
    if (!inner) continue;
    mesh.reference(0, i) += dx;
    mesh.reference(1, i) += dy;
  }
  return mesh;
}

/// A vector per node, components in [-1, 1].
inline NodalVectors make_random_vectors(Eigen::Index n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> component(-1, 1);
  NodalVectors v(3, n);
  for (Eigen::Index i = 0; i < v.size(); ++i) v.data()[i] = component(random);
  return v;
}

/// Smooth stretched, sheared and bent shape; `amount` scales the displacement.
inline NodalVectors make_curved_shape(const TriangleMesh& mesh, double amount) {
  NodalVectors x = mesh.reference;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const double a = mesh.reference(0, i), b = mesh.reference(1, i);
    x(0, i) += amount * (1.0e-1 * a + 3e-2 * b);
    x(1, i) += amount * (-2e-2 * b + 1e-2 * a);
    x(2, i) += amount * (6e-3 * a * a - 3e-3 * b * b + 4e-3 * a * b);
  }
  return x;
}

/// A layer with its last position and the nodal forces there.
struct Sheet {
  MetalLayer layer;
  NodalVectors position, force;

  Sheet(const scene::Layer& l, const TriangleMesh& mesh) : layer(l, l.density, mesh), position(mesh.reference) {}

  /// @param dt  since the last position if both belong to a motion, s
  const NodalVectors& advance(const NodalVectors& x, double dt = 0) {
    position = x;
    layer.compute_internal_forces(position, {.dt = dt}, force);
    return force;
  }
  /// Follows make_curved_shape() from 0 to `amount`.
  void bend(const TriangleMesh& mesh, double amount, int steps) {
    for (int s = 1; s <= steps; ++s) advance(make_curved_shape(mesh, amount * s / steps));
  }
  std::vector<double> field(const std::string& name) const {
    for (const auto& f : layer.compute_fields(position))
      if (f.name == name) return f.values;
    throw std::out_of_range(name);
  }
};

}  // namespace interply::metal::test
