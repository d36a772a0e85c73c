/// Nodal and element arrays. Every array keeps the point (node or element) innermost, so that a loop over points
/// runs through contiguous memory and vectorises.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace interply::mechanics {

/// A 3-vector per node, row 0 = x, 1 = y, 2 = z; each row contiguous over the nodes. [3 x n_nodes]
using NodalVectors = Eigen::Array<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
/// A scalar per node or element. [n]
using Scalars = Eigen::ArrayXd;
/// Node numbers of each triangle, row k = k-th corner, contiguous over the elements. [3 x n_elements]
using Triangles = Eigen::Array<int, 3, Eigen::Dynamic, Eigen::RowMajor>;

using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;
using Matrix2 = Eigen::Matrix2d;

/// Vector of node `i`.
inline Vector3 at(const NodalVectors& a, Eigen::Index i) { return {a(0, i), a(1, i), a(2, i)}; }
/// Adds `v` to the vector of node `i`.
inline void add_at(NodalVectors& a, Eigen::Index i, const Vector3& v) {
  a(0, i) += v.x();
  a(1, i) += v.y();
  a(2, i) += v.z();
}

}  // namespace interply::mechanics
