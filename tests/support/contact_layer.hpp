/// A layer that a test moves as it likes: contact without a solver.
#pragma once

#include <memory>

#include "contact/layer_interface.hpp"
#include "contact/tool_interface.hpp"

namespace interply::test {

using mechanics::NodalVectors;
using mechanics::Vector3;

struct ContactLayer {
  mechanics::TriangleMesh mesh;
  contact::LayerGeometry geometry;

  ContactLayer(mechanics::TriangleMesh m, double thickness) : mesh(std::move(m)), geometry(mesh, thickness, 1e-9) {}
  ContactLayer(const ContactLayer&) = delete;

  /// Node i goes to f(X_i).
  template <typename F>
  void move(F f) {
    NodalVectors next(3, mesh.n_nodes());
    for (int i = 0; i < mesh.n_nodes(); ++i) {
      const Vector3 v = f(mechanics::at(mesh.reference, i));
      for (int d = 0; d < 3; ++d) next(d, i) = v(d);
    }
    geometry.move_to(next);
  }
};

/// A rectangle [-a, a] x [-b, b] at height z, turned about the vertical axis (rad).
inline mechanics::TriangleMesh make_turned_rectangle(double a, double b, double h, double z, double turn = 0) {
  mechanics::TriangleMesh mesh = mechanics::make_rectangle({-a, a}, {-b, b}, h, z);
  const Eigen::Matrix3d rotation(Eigen::AngleAxisd(turn, Vector3::UnitZ()));
  mesh.reference.matrix() = rotation * mesh.reference.matrix().eval();
  return mesh;
}

inline Vector3 total(const NodalVectors& f) { return {f.row(0).sum(), f.row(1).sum(), f.row(2).sum()}; }

/// Moment of nodal forces about the origin, and the sum of what it is made of.
struct Moment {
  Vector3 sum = Vector3::Zero();
  double scale = 0;
  void add(const NodalVectors& position, const NodalVectors& force) {
    for (Eigen::Index i = 0; i < position.cols(); ++i) {
      const Vector3 m = mechanics::at(position, i).cross(mechanics::at(force, i));
      sum += m;
      scale += m.norm();
    }
  }
};

}  // namespace interply::test
