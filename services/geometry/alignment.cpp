#include "geometry/alignment.hpp"

#include <cmath>
#include <numbers>

namespace interply::geometry {

double compute_misaligned_share(const FlatMesh& mesh, double orientation) {
  constexpr double kAlong = 5 * std::numbers::pi / 180;
  double total = 0, misaligned = 0;
  for (const auto& triangle : mesh.triangles) {
    bool along[2] = {false, false};  // warp, weft
    double twice_area = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& a = mesh.points[static_cast<std::size_t>(triangle[k])];
      const auto& b = mesh.points[static_cast<std::size_t>(triangle[(k + 1) % 3])];
      const double angle = std::atan2(b[1] - a[1], b[0] - a[0]) - orientation;
      for (int fibre = 0; fibre < 2; ++fibre)
        if (std::abs(std::remainder(angle - fibre * std::numbers::pi / 2, std::numbers::pi)) <= kAlong)
          along[fibre] = true;
      twice_area += a[0] * b[1] - a[1] * b[0];
    }
    total += twice_area;
    if (!along[0] || !along[1]) misaligned += twice_area;
  }
  return total > 0 ? misaligned / total : 0;
}

}  // namespace interply::geometry
