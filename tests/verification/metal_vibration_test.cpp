/// Free vibration of an elastic sheet by the integrator's central difference.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "support/metal_sheet.hpp"

namespace interply::metal::test {
namespace {

struct Vibration {
  double period = 0;  ///< s, mean over the cycles
  double drift = 0;   ///< largest change of kinetic plus internal energy / energy
};

/// Releases `mesh` from rest at reference + mode and measures the period of its projection on the mode. Kinetic energy
/// at step n from both half-step velocities, m v(n-1/2) v(n+1/2)/2, the one central difference conserves.
/// @param hold  sets held components of the acceleration to zero
Vibration vibrate(const TriangleMesh& mesh, const scene::Layer& layer, const NodalVectors& mode, int cycles,
                  const std::function<void(NodalVectors&)>& hold) {
  Sheet sheet(layer, mesh);
  const mechanics::Scalars mass = mechanics::compute_lumped_mass(mesh, layer.thickness, layer.density);
  const double dt = 0.9 * sheet.layer.compute_stable_increment();
  NodalVectors x = mesh.reference + mode, v = NodalVectors::Zero(3, x.cols()), a = v;
  const auto update_acceleration = [&] {
    a = -sheet.advance(x);
    for (int c = 0; c < 3; ++c) a.row(c) /= mass.transpose();
    hold(a);
  };
  sheet.advance(x);
  double energy = sheet.layer.internal_energy();
  update_acceleration();
  v = 0.5 * dt * a;
  // at rest v(-1/2) = -v(1/2)
  for (int c = 0; c < 3; ++c) energy -= 0.5 * (mass.transpose() * v.row(c).square()).sum();
  Vibration result;
  double last = 1, first_crossing = 0;
  int crossings = 0;
  for (int step = 1; crossings <= 2 * cycles; ++step) {
    x += dt * v;
    update_acceleration();
    const NodalVectors next = v + dt * a;
    double kinetic = 0;
    for (int c = 0; c < 3; ++c) kinetic += 0.5 * (mass.transpose() * v.row(c) * next.row(c)).sum();
    v = next;
    result.drift = std::max(result.drift, std::abs(kinetic + sheet.layer.internal_energy() - energy) / energy);
    const double amplitude = ((x - mesh.reference) * mode).sum() / mode.square().sum();
    if ((amplitude > 0) != (last > 0)) {
      const double crossing = dt * (step - 1 + last / (last - amplitude));
      if (crossings == 0) first_crossing = crossing;
      result.period = (crossing - first_crossing) * 2 / std::max(1, crossings);
      ++crossings;
    }
    last = amplitude;
    if (step > 2000000) break;
  }
  return result;
}

TEST(FreeVibration, BarInTensionRingsAtItsLongitudinalFrequency) {
  const double length = 100;
  const TriangleMesh mesh = mechanics::make_rectangle({0, length}, {0, 8}, 4);
  NodalVectors mode = NodalVectors::Zero(3, mesh.n_nodes());
  mode.row(0) = 1e-3 * (std::numbers::pi / length * mesh.reference.row(0)).cos();
  const Vibration bar =
      vibrate(mesh, make_sheet(make_elastic(210e3, 0)), mode, 5, [](NodalVectors&) {});  // free at both ends
  const double exact = 2 * length / std::sqrt(210e3 / kDensity);
  RecordProperty("relative error and drift", std::to_string(bar.period / exact - 1) + " " + std::to_string(bar.drift));
  EXPECT_NEAR(bar.period, exact, 2e-3 * exact);
  EXPECT_LT(bar.drift, 1e-4);
}

TEST(FreeVibration, SimplySupportedStripRingsAtItsBendingFrequency) {
  const double length = 100, t = 1;
  const TriangleMesh mesh = mechanics::make_rectangle({0, length}, {0, 10}, 5);
  NodalVectors mode = NodalVectors::Zero(3, mesh.n_nodes());
  mode.row(2) = 1e-3 * (std::numbers::pi / length * mesh.reference.row(0)).sin();
  const Vibration strip = vibrate(mesh, make_sheet(make_elastic(210e3, 0), 3, t), mode, 2, [&](NodalVectors& a) {
    for (Eigen::Index i = 0; i < a.cols(); ++i)
      if (mesh.reference(0, i) == 0 || mesh.reference(0, i) == length) a(2, i) = 0;
  });
  const double omega = std::pow(std::numbers::pi / length, 2) * std::sqrt(210e3 * t * t / (12 * kDensity));
  const double exact = 2 * std::numbers::pi / omega;
  RecordProperty("relative error and drift",
                 std::to_string(strip.period / exact - 1) + " " + std::to_string(strip.drift));
  EXPECT_NEAR(strip.period, exact, 1e-2 * exact);
  EXPECT_LT(strip.drift, 1e-4);
}

}  // namespace
}  // namespace interply::metal::test
