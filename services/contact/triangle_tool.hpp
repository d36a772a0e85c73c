/// Signed distance to a triangulated tool.
#pragma once

#include <array>
#include <vector>

#include "contact/signed_distance.hpp"

namespace interply::contact {

/// Exact distance to the nearest point of the surface; its sign is that of (x - nearest point).normal, with the normal
/// of the face, side or corner that the nearest point lies on: of a side the sum of its two faces' normals, of a corner
/// the sum of its faces' normals weighted by their angles there (Baerentzen & Aanaes, IEEE TVCG 11 (2005) 243). So the
/// sign is right everywhere for a closed surface whose normals point outwards.
///
/// An open surface has normals towards the blank, and the tool lies behind it. Where the nearest point lies on its rim
/// the distance is positive all around: the rim acts as the edge of a thin plate. In front of the surface the distance
/// is continuous; behind it, it jumps where the rim becomes nearest, so the surface must reach beyond every place at
/// which the blank can get behind it. (This differs from the paper, which takes closed surfaces only.)
///
/// Where we differ further: a triangle lower than 1e-5 of its longest side has no usable normal. It keeps its place
/// between its neighbours but is not looked at: its sides are theirs, too.
///
/// Immutable after construction: any number of threads may evaluate.
class TriangleTool : public SignedDistance {
 public:
  /// @param vertices   [3 x n] mm
  /// @param triangles  corners counter-clockwise seen from outside; each side in one or two triangles, the two running
  ///                   through it in opposite directions (geometry::Surface)
  /// @throws std::invalid_argument  if a side has three triangles, or no triangle has an area
  TriangleTool(const mechanics::NodalVectors& vertices, const mechanics::Triangles& triangles);

  Distance evaluate(const Vector3& x) const override;
  /// The same by trying every triangle: the reference of the search, equal bit for bit.
  Distance evaluate_by_all(const Vector3& x) const;

 private:
  /// What the search looks at, apart from the rest.
  struct Triangle {
    Vector3 corner, to_1, to_2, normal;  ///< x0, x1 - x0, x2 - x0, unit
  };
  /// Where a nearest point can lie: 0 face; 1 to 3 side from corner k to k + 1; 4 to 6 corner k.
  struct Places {
    std::array<Vector3, 7> normals;  ///< unit
    std::array<bool, 7> is_rim{};
  };
  struct Nearest {
    double squared;       ///< |x - point|^2, mm2
    int triangle, place;  ///< place: index into Places
    Vector3 away;         ///< x - point
  };
  /// Box of the triangles [first, first + count) of a leaf, or of the children at `first` and `first + 1`.
  struct Box {
    Vector3 low, high;
    int first, count;
  };

  static Nearest find_nearest(const Triangle& t, int index, const Vector3& x);
  static void keep_nearer(Nearest& best, const Nearest& other);
  Distance to_distance(const Nearest& nearest) const;
  void build(std::size_t box, std::vector<int>& order, std::size_t begin, std::size_t end);

  std::vector<Triangle> triangles_;  ///< in the order of the leaves
  std::vector<Places> places_;       ///< of the same triangles
  std::vector<Box> boxes_;           ///< a binary tree, the root first
};

}  // namespace interply::contact
