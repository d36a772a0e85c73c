/// How a mesh lies to the fibres of a ply.
#pragma once

#include "geometry/blank_mesh.hpp"

namespace interply::geometry {

/// Share of the area in triangles that do not have one side along each of two perpendicular fibre directions, to within
/// 5 deg. A triangle without such sides cannot shear like a trellis of fibres that keep their length: it locks.
/// @param orientation  of the warp from x, rad
double compute_misaligned_share(const FlatMesh& mesh, double orientation);

}  // namespace interply::geometry
