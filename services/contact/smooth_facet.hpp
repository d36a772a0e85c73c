/// One facet of a layer with the smooth surface above it, and the material points between it and its neighbour.
#pragma once

#include "contact/layer_geometry.hpp"
#include "contact/pairing.hpp"

namespace interply::contact {

/// Corners and vertex normals of a facet.
struct SmoothFacet {
  int node[3] = {};
  Vector3 x[3], n[3];         ///< positions, mm; vertex normals
  Vector3 u, v, area;         ///< x_2 - x_1, x_3 - x_1, u x v
  double inverse_square = 0;  ///< 1/|u x v|^2, 1/mm4

  SmoothFacet(const LayerGeometry& layer, int triangle) {
    for (int k = 0; k < 3; ++k) {
      node[k] = layer.mesh().triangles(k, triangle);
      x[k] = layer.position(node[k]);
      n[k] = layer.normal(node[k]);
    }
    u = x[1] - x[0];
    v = x[2] - x[0];
    area = u.cross(v);
    inverse_square = 1 / area.squaredNorm();
  }
  /// In-plane gradients of the weights w_2 and w_3, 1/mm (that of w_1 is minus their sum).
  Vector3 gradient_2() const { return v.cross(area) * inverse_square; }
  Vector3 gradient_3() const { return area.cross(u) * inverse_square; }
};

/// The smooth surface above a facet, (C1).
struct Rise {
  double value = 0;      ///< r, mm
  Vector3 by_corner[3];  ///< dr/dx_i at fixed weights and normals
  Vector3 by_normal[3];  ///< dr/dn_i, mm
  Vector3 slope;         ///< along the facet, sum_i dr/dw_i grad w_i, mm/mm
};

inline Rise compute_rise(const SmoothFacet& f, const double w[3]) {
  Rise rise;
  double by_weight[3] = {};
  for (int k = 0; k < 3; ++k) {
    rise.by_corner[k].setZero();
    rise.by_normal[k].setZero();
  }
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const Vector3 side = f.x[j] - f.x[i], turn = f.n[j] - f.n[i], sum = f.n[i] + f.n[j];
    const double both = 0.5 * w[i] * w[j], skew = w[i] - w[j];
    const double even = 0.5 * side.dot(turn), odd = 0.5 * side.dot(sum);
    rise.value += w[i] * w[j] * (even - skew * odd);
    by_weight[i] += w[j] * (even - (skew + w[i]) * odd);
    by_weight[j] += w[i] * (even - (skew - w[j]) * odd);
    const Vector3 by_side = both * (turn - skew * sum);
    rise.by_corner[i] -= by_side;
    rise.by_corner[j] += by_side;
    rise.by_normal[i] -= both * (1 + skew) * side;
    rise.by_normal[j] += both * (1 - skew) * side;
  }
  rise.slope = (by_weight[1] - by_weight[0]) * f.gradient_2() + (by_weight[2] - by_weight[0]) * f.gradient_3();
  return rise;
}

/// A vector that rides on the facet: the same combination of u, v and u x v as it was of theirs a step ago. Turns
/// exactly with a rigid motion.
inline Vector3 carry_along(const SmoothFacet& f, const LayerGeometry& layer, const Vector3& e) {
  const Vector3 first = layer.increment(f.node[0]);
  const Vector3 u = f.u - (layer.increment(f.node[1]) - first);
  const Vector3 v = f.v - (layer.increment(f.node[2]) - first);
  const Vector3 area = u.cross(v);
  const double inverse = 1 / area.squaredNorm();
  return inverse * (e.dot(v.cross(area)) * f.u + e.dot(area.cross(u)) * f.v + e.dot(area) * f.area);
}

/// The point c = x_p + a n_p at which both sides of an interface meet, as a material point of the facet's layer:
///
///   c = sum_i w'_i x_i - a' m,   m = sum_i w_i n_i                                                           (C4)
///
/// with w the weights of the node's foot point and w', a' from projecting c along m: exact, so that no rigid motion of
/// both layers separates the two, and smooth across facets.
struct CommonPoint {
  double by_corner[3] = {};  ///< w'_i
  double by_normal[3] = {};  ///< -a' w_i, mm

  CommonPoint(const SmoothFacet& f, const double w[3], const Vector3& c) {
    const Projection p = project(c, w[0] * f.n[0] + w[1] * f.n[1] + w[2] * f.n[2], f.x[0], f.x[1], f.x[2]);
    for (int k = 0; k < 3; ++k) {
      by_corner[k] = p.weight[k];
      by_normal[k] = -p.distance * w[k];
    }
  }
  /// Its displacement in the last step, mm.
  Vector3 compute_increment(const SmoothFacet& f, const LayerGeometry& layer) const {
    Vector3 sum = Vector3::Zero();
    for (int k = 0; k < 3; ++k) sum += by_corner[k] * layer.increment(f.node[k]) + by_normal[k] * layer.turn(f.node[k]);
    return sum;
  }
};

}  // namespace interply::contact
