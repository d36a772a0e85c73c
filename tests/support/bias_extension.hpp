/// Bias extension test: a strip whose fibres run at +-45 deg to the load, gripped at y = 0 and y = H.
#pragma once

#include <cmath>

#include "support/fabric_meshes.hpp"
#include "support/static_ply.hpp"

namespace interply::test {

/// Extension at which inextensible fibres shear the middle of the strip by `gamma` (rad), mm:
///   gamma = 90 deg - 2 acos((L0 + d)/(sqrt 2 L0)),   L0 = H - W                                   (V4)
inline double compute_bias_extension(double width, double height, double gamma) {
  const double l0 = height - width;
  return std::sqrt(2.0) * l0 * std::cos(M_PI / 4 - gamma / 2) - l0;
}

/// What inextensible fibres make of a point: rigid next to a grip, sheared in the middle, half of it on the sides.
enum class BiasZone { Rigid, Half, Full };

inline BiasZone find_zone(double width, double height, double x, double y) {
  const double to_grip = std::min(y, height - y);
  if (to_grip < std::min(x, width - x)) return BiasZone::Rigid;
  return to_grip < std::max(x, width - x) ? BiasZone::Half : BiasZone::Full;
}

/// A strip in the grips, in its plane; extend() moves the upper grip to an extension and finds the equilibrium.
class BiasTest {
 public:
  BiasTest(const mechanics::TriangleMesh& mesh, const scene::WovenLaw& law)
      : ply(mesh, law, 45),
        mesh_(mesh),
        width_(mesh.reference.row(0).maxCoeff()),
        height_(mesh.reference.row(1).maxCoeff()) {
    ply.free.row(2).setZero();
    for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i)
      if (is_gripped(i)) ply.free.col(i).setZero();
  }

  /// @param largest  force on a free node at the end, N
  void extend(double extension, double largest) {
    ply.position.row(1) *= (height_ + extension) / (height_ + extension_);
    extension_ = extension;
    ply.relax(largest);
  }

  /// Force of the upper grip, N.
  double force() const {
    double sum = 0;
    for (Eigen::Index i = 0; i < mesh_.n_nodes(); ++i)
      if (mesh_.reference(1, i) > height_ - 1e-9) sum += ply.force(1, i);
    return sum;
  }

  /// Area mean of |shear angle| over a zone, or over the part of it within `to_axis` of the middle x = W/2, rad.
  double read_shear(BiasZone zone, double to_axis = 1e9) const {
    const auto gamma = ply.field("shear_angle");
    const auto areas = mechanics::compute_areas(mesh_);
    double sum = 0, area = 0;
    for (Eigen::Index e = 0; e < mesh_.n_elements(); ++e) {
      Eigen::Array2d centre = Eigen::Array2d::Zero();
      for (int k = 0; k < 3; ++k) centre += mesh_.reference.col(mesh_.triangles(k, e)).head(2) / 3;
      if (find_zone(width_, height_, centre.x(), centre.y()) != zone) continue;
      if (std::abs(centre.x() - width_ / 2) > to_axis) continue;
      sum += std::abs(gamma[static_cast<std::size_t>(e)]) * areas(e);
      area += areas(e);
    }
    return sum / area;
  }

  StaticPly ply;

 private:
  bool is_gripped(Eigen::Index i) const {
    return mesh_.reference(1, i) < 1e-9 || mesh_.reference(1, i) > height_ - 1e-9;
  }
  mechanics::TriangleMesh mesh_;
  double width_, height_, extension_ = 0;
};

}  // namespace interply::test
