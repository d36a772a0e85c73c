#include "coordinator/blank_holder.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace interply;
using namespace interply::coordinator;

constexpr double kMass = 8e-4, kStiffness = 4e6, kArea = 1000;  // t, N/mm, mm2

/// The holder on a spring that pushes back with -k z where it is pressed below z = 0.
struct OnASpring {
  BlankHolder holder;
  double z = 0, time = 0, dt;
  OnASpring(const scene::BlankHolder& settings, double increment)
      : holder(settings, kArea, kMass, kStiffness), dt(increment) {
    holder.kick(0, 0, 0, dt);
  }
  double force() const { return -kStiffness * z; }
  void step() {
    z += holder.drift(dt);
    time += dt;
    holder.kick(time, force(), dt, dt);
  }
};

TEST(BlankHolder, OscillatesAtTheFrequencyOfCentralDifferences) {
  // sin(omega_d dt/2) = omega dt/2; a ramp of one step sets it free at once
  const double omega = std::sqrt(kStiffness / kMass), dt = 0.2 / omega;
  OnASpring s({.pressure = 2, .ramp = 0.5 * dt, .damping = 0}, dt);
  const double equilibrium = -2 * kArea / kStiffness;
  double first = 0, last = 0;
  int crossings = 0;
  for (int n = 0; n < 20000; ++n) {
    const double before = s.z - equilibrium;
    s.step();
    const double after = s.z - equilibrium;
    if (before > 0 && after <= 0) {
      last = s.time - dt * after / (after - before);
      if (crossings++ == 0) first = last;
    }
  }
  const double period = (last - first) / (crossings - 1);
  EXPECT_NEAR(2 * M_PI / period, 2 / dt * std::asin(0.5 * omega * dt), 1e-5 * omega);
}

TEST(BlankHolder, BooksCloseToRoundOff) {
  const double omega = std::sqrt(kStiffness / kMass), dt = 0.4 / omega;
  for (const double damping : {0.0, 0.1, 0.5}) {
    OnASpring s({.pressure = 2, .ramp = 20 * dt, .damping = damping}, dt);
    for (int n = 0; n < 5000; ++n) s.step();
    const BodyEnergies& e = s.holder.energies();
    EXPECT_LT(std::abs(e.residual()), 1e-11 * std::abs(e.load)) << damping;
    EXPECT_GT(e.load, 0);  // the force goes down and so does the holder
    EXPECT_NEAR(-e.contact, 0.5 * kStiffness * s.z * s.z, 1e-10 * e.load);
    EXPECT_EQ(e.damping > 0, damping > 0);
  }
}

TEST(BlankHolder, ComesToRestWhereContactCarriesTheTarget) {
  const double omega = std::sqrt(kStiffness / kMass), dt = 0.2 / omega;
  OnASpring s({.pressure = 2, .ramp = 100 * dt, .damping = 0.1}, dt);
  for (int n = 0; n < 4000; ++n) s.step();
  EXPECT_DOUBLE_EQ(s.holder.target(), 2 * kArea);
  EXPECT_NEAR(s.force(), 2 * kArea, 1e-9 * 2 * kArea);
  EXPECT_NEAR(s.holder.energies().kinetic, 0, 1e-12);
}

TEST(BlankHolder, FractionOfCriticalDampingIsTheDecayOfTheAmplitude) {
  const double omega = std::sqrt(kStiffness / kMass), dt = 0.02 / omega, zeta = 0.1;
  OnASpring s({.pressure = 2, .ramp = 0.5 * dt, .damping = zeta}, dt);
  const double equilibrium = -2 * kArea / kStiffness;
  std::vector<double> peaks;
  double previous = 0, before = 0;
  for (int n = 0; n < 4000; ++n) {
    s.step();
    const double u = s.z - equilibrium;
    if (previous < before && previous < u) peaks.push_back(previous);
    before = previous;
    previous = u;
  }
  ASSERT_GT(peaks.size(), 4u);
  const double decrement = std::log(peaks[1] / peaks[2]);
  EXPECT_NEAR(decrement, 2 * M_PI * zeta / std::sqrt(1 - zeta * zeta), 0.02 * decrement);
}

}  // namespace
