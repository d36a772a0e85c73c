#include "coordinator/plausibility.hpp"

#include <fmt/format.h>

#include <cmath>

namespace interply::coordinator {

namespace {

constexpr double kFarthest = 10;     ///< distance of the nodes (root mean square) / (size of the blank + stroke)
constexpr double kThickness = 100;   ///< thickness / that of the scene, and its inverse
constexpr double kMostSteps = 1e11;  ///< more would take months

bool is_within(double value, double largest) { return std::abs(value) <= largest; }  // false for NaN

}  // namespace

Plausibility::Plausibility(const scene::Scene& scene, int layer, const mechanics::TriangleMesh& mesh)
    : name_(scene.layers[static_cast<std::size_t>(layer)].name),
      farthest_(kFarthest * (mesh.reference.abs().maxCoeff() + scene.motion.stroke)),
      thickness_(scene.layers[static_cast<std::size_t>(layer)].thickness),
      end_time_(scene.end_time()) {}

std::string Plausibility::find_fault(const exchange::Motion& motion) const {
  const auto describe = [&](const std::string& what, const char* cure) {
    return fmt::format("layer {}: {} at step {}; check {}", name_, what, motion.step, cure);
  };
  if (!(motion.vote > 0) || std::isinf(motion.vote))
    return describe(fmt::format("its stable increment is {} s", motion.vote), "the tangent of its law");
  if (end_time_ / motion.vote > kMostSteps)
    return describe(fmt::format("its stable increment is {:.3g} s, with which the run would take {:.1g} steps,",
                                motion.vote, end_time_ / motion.vote),
                    "the tangent of its law, its density and its mesh");
  const auto& x = motion.position;
  const double n = static_cast<double>(x.cols());
  if (!(x.matrix().squaredNorm() <= n * farthest_ * farthest_)) {  // no single pass says more cheaply that all is well
    Eigen::Index worst = 0;
    while (worst + 1 < x.cols() && mechanics::at(x, worst).allFinite() &&
           is_within(mechanics::at(x, worst).norm(), farthest_))
      ++worst;
    return describe(fmt::format("its node {} is at ({}, {}, {}) mm", worst, x(0, worst), x(1, worst), x(2, worst)),
                    "its law, density and mesh, or lower time.safety");
  }
  for (Eigen::Index i = 0; i < motion.thickness.size(); ++i)
    if (const double t = motion.thickness(i); !(t > thickness_ / kThickness && t < thickness_ * kThickness))
      return describe(
          fmt::format("its node {} is {} mm thick, which the scene's {:g} mm cannot become,", i, t, thickness_),
          "its law");
  const exchange::LayerEnergies& e = motion.energies;
  if (!std::isfinite(e.kinetic + e.internal + e.internal_work + e.contact_work))
    return describe(fmt::format("its energies (kinetic {}, internal {}, work of contact {} mJ) are no numbers",
                                e.kinetic, e.internal, e.contact_work),
                    "its law");
  return {};
}

}  // namespace interply::coordinator
