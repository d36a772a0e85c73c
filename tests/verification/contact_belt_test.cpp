/// V12, V13: a flexible belt over a rigid drum: capstan friction, and the pressure of a membrane on a curved tool.
#include <gtest/gtest.h>

#include <cmath>

#include "support/drum.hpp"
#include "support/results.hpp"

namespace {

using namespace interply;
using test::BeltOnDrum;

double ramp(double x) { return x <= 0 ? 0 : x >= 1 ? 1 : x * x * (3 - 2 * x); }

/// Friction acts at the drum's radius R, the belt pulls at its midsurface rho = R + t/2, and friction t/2 beside the
/// midsurface is a couple that needs a shear force Q = tau t/2. Equilibrium of the curved belt without bending moment,
/// per midsurface length s = rho theta:
///   tension  rho dT/ds = tau R      pressure  p = T/rho - dQ/ds      tau = mu p
/// gives T ~ e^(lambda theta) with lambda (1 + mu lambda (t/2)/rho) = mu R/rho; e^(mu theta) for a thin belt.
double compute_exponent(double mu, double radius, double half_thickness) {
  const double rho = radius + half_thickness, a = mu * half_thickness / rho;
  return (std::sqrt(1 + 4 * a * mu * radius / rho) - 1) / (2 * a);
}

TEST(BeltOnACylinder, TensionRatioIsThatOfTheCapstan) {
  const double mu = 0.3, tension = 10, speed = 1500;
  const BeltOnDrum::Setup base{.friction = mu};
  const double exponent = compute_exponent(mu, base.radius, 0.5 * BeltOnDrum::kThickness);
  const double exact = std::exp(exponent * base.wrap);
  std::vector<double> sizes{16, 8, 4}, error;
  double ratio = 0;
  for (const double h : sizes) {
    BeltOnDrum::Setup setup = base;
    setup.h = setup.width = h;
    setup.tail = 5 * h;
    BeltOnDrum belt(setup);
    const double dt = belt.dt(), start = 0.2e-3, rising = 0.2e-3, settled = 1.5e-3, stop = settled + h / speed;
    double tight = 0, slack = 0;
    for (double time = 0; time < stop; time += dt) {
      belt.step(tension * ramp(time / start), time < start ? 0 : speed * ramp((time - start) / rising), 5e4);
      if (time < settled) continue;
      tight += belt.tension_of_tail(1);
      slack += belt.tension_of_tail(-1);
    }
    ratio = tight / slack;
    error.push_back(ratio - exact);
  }
  test::expect_result({.row = "V12",
                       .quantity = "belt pulled over a cylinder, mu 0.3, 90 deg: ratio of the tensions",
                       .source = "capstan e^(mu theta), friction at R, belt at R + t/2",
                       .reference = exact,
                       .ours = ratio,
                       .mesh = "4 mm on R 50 mm",
                       .order = test::compute_order(sizes, error)});
  EXPECT_GT(test::compute_order({sizes[0], sizes[1]}, {error[0], error[1]}), 1.5);
  EXPECT_GT(test::compute_order(sizes, error), 1.5);
}

TEST(BeltOnACylinder, PressureOfATenseMembraneIsTensionOverRadius) {
  const double tension = 10;
  std::vector<double> sizes{16, 8, 4}, error;
  double pressure = 0, scatter = 0;
  const double exact = tension / BeltOnDrum::Setup{}.radius;
  for (const double h : sizes) {
    BeltOnDrum::Setup setup;
    setup.h = setup.width = h;
    BeltOnDrum belt(setup);
    const double dt = belt.dt();
    for (double time = 0; time < 2e-3; time += dt) belt.step(tension * ramp(time / 0.3e-3), 0, 3e4);
    const BeltOnDrum::Pressure p = belt.pressure(0.6);
    pressure = p.mean * belt.mean_radius() / setup.radius;  // per area of the drum
    scatter = std::max(p.largest - p.mean, p.mean - p.least) / p.mean;
    error.push_back(pressure - exact);
  }
  test::expect_result({.row = "V13",
                       .quantity = "pressure of a membrane under tension on a cylinder",
                       .source = "T/R",
                       .reference = exact,
                       .ours = pressure,
                       .unit = "MPa",
                       .mesh = "4 mm on R 50 mm"});
  EXPECT_LT(std::abs(error.front()), 0.02 * exact);  // 18 deg of arc per element
  EXPECT_LT(std::abs(error.back()), 0.2 * std::abs(error.front()));
  test::expect_result({.row = "V13",
                       .quantity = "scatter of that pressure from triangle to triangle",
                       .source = "uniform",
                       .reference = 0,
                       .ours = scatter,
                       .tolerance = 0.01,
                       .absolute = true,
                       .mesh = "4 mm on R 50 mm"});
}

}  // namespace
