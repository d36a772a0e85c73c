/// Which triangle of the partner a node faces: found once, then followed by walking to neighbours.
#pragma once

#include <vector>

#include "contact/law.hpp"
#include "contact/layer_geometry.hpp"

namespace interply::contact {

/// Projection of a point along a direction onto the plane of a triangle.
struct Projection {
  double weight[3] = {};  ///< barycentric, sum 1
  double distance = 0;    ///< from the point along the direction, mm
  Vector3 facet_normal;   ///< N/(n.N): the gradient of -distance by the point
};

/// @param x  point   @param n  unit direction   @param a, b, c  corners
Projection project(const Vector3& x, const Vector3& n, const Vector3& a, const Vector3& b, const Vector3& c);

/// A node and the place it faces. Beyond the partner's edge the weights are those of the extended facet, one of them
/// negative.
struct Facing {
  int triangle = -1;  ///< -1: faces nothing
  Projection projection;
  int edge = -1;     ///< corner opposite the side of the partner's edge that the node is beyond, or -1
  double share = 1;  ///< 1 inside, 1 + weight[edge]/kEdgeMargin beyond the edge, down to 0
};

/// The facing of a node that is held to triangle `t`, whether it is above it or not.
Facing hold(const LayerGeometry& partner, const Vector3& x, const Vector3& normal, int t);

/// Projects along the normal, starting at `triangle` and walking across the side with the most negative weight.
/// Beyond the partner's edge the last triangle is kept (so that the node can come back) with share 0 if it is too far.
Facing find_facing(const LayerGeometry& partner, const Vector3& x, const Vector3& normal, int triangle);

/// The same by trying every triangle: the nearest along the normal of those that hold the foot point (the first of
/// equals), else the one whose smallest weight is largest. The reference that walking and FlatSearch must agree with.
int search_facing(const LayerGeometry& partner, const Vector3& x, const Vector3& normal);

/// search_facing() for many points, for the start of a run: where the normal is z, as in a flat stack, only the few
/// triangles around the point are tried unless none of them holds it.
class FlatSearch {
 public:
  /// @param partner  referenced; must not move meanwhile
  explicit FlatSearch(const LayerGeometry& partner);
  /// Equal to search_facing().
  int find(const Vector3& x, const Vector3& normal) const;

 private:
  int locate(double at, int axis) const;  ///< column (axis 0) or row (1) of a coordinate
  std::size_t cell(int column, int row) const { return static_cast<std::size_t>(row * n_[0] + column); }

  const LayerGeometry& partner_;
  Eigen::Vector2d low_, width_;     ///< of the grid and of a cell, mm
  int n_[2] = {1, 1};               ///< columns, rows
  std::vector<std::size_t> start_;  ///< of each cell in `triangles_`
  std::vector<int> triangles_;      ///< that reach into the cells, ascending in each
};

}  // namespace interply::contact
