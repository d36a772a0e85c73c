/// Signed distance fields of the analytic tools: > 0 outside the tool, gradient = outward unit normal. In tool
/// coordinates; the tool's vertical motion is the caller's matter.
#pragma once

#include <array>

#include "contact/tool_kernels.hpp"
#include "mechanics/nodal.hpp"

namespace interply::contact {

using mechanics::Vector2;
using mechanics::Vector3;

struct Distance {
  double value = 0;  ///< mm
  Vector3 gradient;  ///< unit, away from the tool
};

/// A rigid surface. `evaluate` is 1-Lipschitz and exact outside the tool's inner body.
class SignedDistance {
 public:
  virtual ~SignedDistance() = default;
  virtual Distance evaluate(const Vector3& x) const = 0;
  /// For the kernel. Must not outlive the object.
  virtual ToolShape to_shape() const;
};

/// Regular triangle in the plane, centroid at the origin, one corner on the positive x axis.
class Triangle2 {
 public:
  explicit Triangle2(double edge);
  /// Signed distance (> 0 outside) and its gradient.
  double distance(const Vector2& p, Vector2& gradient) const;
  /// Height above the side whose line is farthest below: at most the distance.
  double height(const Vector2& p) const;
  const std::array<Vector2, 3>& corners() const { return corners_; }

 private:
  struct Side {
    Vector2 start, along, normal;  ///< from its first corner to its second; unit, outward
    double inverse_square;         ///< 1/|along|^2
  };
  std::array<Vector2, 3> corners_;
  std::array<Side, 3> sides_;
};

/// Punch: regular triangular pyramid (base edge, height) pointing down, apex of the inner sharp body at (0, 0, radius),
/// prismatic above its base, offset by a ball. The lowest point of the tool is (0, 0, 0). One base corner lies on +x,
/// so that one edge of the tetrahedron lies in the plane y = 0.
class PyramidPunch : public SignedDistance {
 public:
  PyramidPunch(double edge, double height, double radius);
  Distance evaluate(const Vector3& x) const override;
  ToolShape to_shape() const override;

 private:
  struct Face {
    int n = 3;                      ///< corners in use
    std::array<Vector3, 4> corner;  ///< counter-clockwise seen from outside
    Vector3 normal;                 ///< outward
  };
  PunchShape shape_;
  std::array<Face, 6> faces_;  ///< three of the pyramid, three of the prism
};

/// Plate with a triangular opening (edge, offset by `offset` with round corners) and shoulder radius. The flat land is
/// z = 0; the material lies below it (die, facing up) or above it (blank holder, facing down).
class OpeningPlate : public SignedDistance {
 public:
  OpeningPlate(double edge, double offset, double shoulder, bool faces_up);
  Distance evaluate(const Vector3& x) const override;
  ToolShape to_shape() const override;

 private:
  Triangle2 triangle_;
  PlateShape shape_;
};

/// Area of the opening enlarged by its shoulder radius, where the flat land begins: A = sqrt(3)/4 e^2 + 3 e r + pi r^2
/// with r = offset + shoulder. mm2, full model
double compute_opening_area(double edge, double offset, double shoulder);

}  // namespace interply::contact
