/// Free vibration of an elastic sheet by the integrator's central difference.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "support/metal_sheet.hpp"
#include "support/plate_meshes.hpp"
#include "support/results.hpp"

namespace interply::metal::test {
namespace {

using namespace interply::test;

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
  const double dt = 0.9 * sheet.layer.compute_stable_increment(mesh.reference);
  NodalVectors x = mesh.reference + mode, v = NodalVectors::Zero(3, x.cols()), a = v;
  const auto update_acceleration = [&](double since) {
    a = -sheet.advance(x, since);
    for (int c = 0; c < 3; ++c) a.row(c) /= mass.transpose();
    hold(a);
  };
  update_acceleration(0);
  v = 0.5 * dt * a;
  double energy = 0;  // after the first step, the first kick of nodes and edges being half a one
  Vibration result;
  double last = 1, first_crossing = 0;
  int crossings = 0;
  for (int step = 1; crossings <= 2 * cycles; ++step) {
    x += dt * v;
    update_acceleration(dt);
    const NodalVectors next = v + dt * a;
    double kinetic = 0;
    for (int c = 0; c < 3; ++c) kinetic += 0.5 * (mass.transpose() * v.row(c) * next.row(c)).sum();
    v = next;
    if (step == 1) energy = kinetic + sheet.layer.internal_energy();
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

void expect_frequency(const std::string& quantity, const std::string& source, double period, const Vibration& ours,
                      const std::string& mesh, double order = std::nan("")) {
  expect_result({.row = "V14",
                 .quantity = quantity + ", frequency",
                 .source = source,
                 .reference = 1 / period,
                 .ours = 1 / ours.period,
                 .unit = "Hz",
                 .mesh = mesh,
                 .order = order});
  expect_result({.row = "V14",
                 .quantity = quantity + ", largest change of kinetic plus internal energy over the energy",
                 .source = "conservation",
                 .reference = 0,
                 .ours = ours.drift,
                 .tolerance = 1e-6,
                 .absolute = true,
                 .mesh = mesh});
}

class FreeVibration : public testing::TestWithParam<Pattern> {
 protected:
  const double pi = std::numbers::pi;
};

TEST_P(FreeVibration, BarInTensionRingsAtItsLongitudinalFrequency) {
  const double length = 100, h = 4;
  const TriangleMesh mesh = make_sheet_mesh(GetParam(), {0, length}, {0, 12}, h);
  NodalVectors mode = NodalVectors::Zero(3, mesh.n_nodes());
  mode.row(0) = 1e-3 * (pi / length * mesh.reference.row(0)).cos();  // free at both ends
  const Vibration bar = vibrate(mesh, make_sheet(make_elastic(210e3, 0)), mode, 5, [](NodalVectors&) {});
  expect_frequency("bar in tension, free at both ends", "c/(2 L), c^2 = E/rho",
                   2 * length / std::sqrt(210e3 / kDensity), bar, describe_mesh(h, GetParam()));
}

/// Simply supported strip (nu = 0) and square plate in their first modes; order from three meshes.
TEST_P(FreeVibration, SupportedStripAndPlateRingAtTheirBendingFrequencies) {
  const double length = 100, t = 4;
  for (const bool strip : {true, false}) {
    const double poisson = strip ? 0.0 : 0.3;
    const double wave = std::sqrt(210e3 * t * t / (12 * (1 - poisson * poisson) * kDensity)) * std::pow(pi / length, 2);
    const double exact = 2 * pi / (strip ? wave : 2 * wave);
    const std::vector<double> sizes = {10, 5, 10.0 / 3};
    std::vector<double> error;
    Vibration ours;
    for (const double h : sizes) {
      const double width = strip ? 3 * h : length;
      const TriangleMesh mesh = make_sheet_mesh(GetParam(), {0, length}, {0, width}, h);
      NodalVectors mode = NodalVectors::Zero(3, mesh.n_nodes());
      mode.row(2) = 1e-3 * (pi / length * mesh.reference.row(0)).sin();
      if (!strip) mode.row(2) *= (pi / length * mesh.reference.row(1)).sin();
      ours = vibrate(mesh, make_sheet(make_elastic(210e3, poisson), 3, t), mode, 2, [&](NodalVectors& a) {
        for (Eigen::Index i = 0; i < a.cols(); ++i) {
          const double x = mesh.reference(0, i), y = mesh.reference(1, i);
          if (x == 0 || x == length || (!strip && (y == 0 || y == length))) a(2, i) = 0;
        }
      });
      error.push_back(exact / ours.period - 1);
    }
    const double order = compute_order(sizes, error);
    EXPECT_GT(order, 1.7);
    expect_frequency(strip ? "strip supported at both ends, bending" : "supported square plate, bending",
                     strip ? "pi/2/L^2 sqrt(E t^2/(12 rho))" : "pi/a^2 sqrt(D/(rho t))", exact, ours,
                     describe_mesh(sizes.back(), GetParam()), order);
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, FreeVibration, testing::Values(Pattern::Alternating, Pattern::Unstructured), to_name);

}  // namespace
}  // namespace interply::metal::test
