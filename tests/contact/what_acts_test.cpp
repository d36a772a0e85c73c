/// What acts at the points of an interface, as opposed to what its springs would carry if the partner were there.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/contact_layer.hpp"

namespace {

using namespace interply;
using namespace interply::contact;
using test::ContactLayer;
using test::make_turned_rectangle;

const InterfaceLaw kLaw{.stiffness = 500, .tangential = 400, .damping = 1e-5, .friction = 0.25};

double find_largest_excess(const Points& p) {
  const NodalVectors traction = p.acting_traction();
  const Scalars pressure = p.acting_pressure();
  double largest = 0;
  for (Eigen::Index i = 0; i < p.size(); ++i)
    largest = std::max(largest, mechanics::at(traction, i).norm() - kLaw.friction * pressure(i) * (1 + 1e-12));
  return largest;
}

/// A sheet under a smaller one whose rim it passes by the far side: there the springs are long, but nothing acts, and
/// nothing slides.
struct PassingRim {
  ContactLayer lower{make_turned_rectangle(8, 6, 1.0, 0), 1}, upper{make_turned_rectangle(5, 4, 0.7, 0.98, 0.3), 1};
  LayerInterface interface{kLaw, lower.geometry, upper.geometry};
  std::mt19937 random{5};

  void move(int n) {
    std::uniform_real_distribution<double> unit(-0.01, 0.01);
    const double s = 0.02 * n;
    lower.move([&](Vector3 x) {
      const double beyond = std::max(0.0, std::abs(x.x()) - 5.5);
      return Vector3(x + Vector3(s + unit(random), 0.3 * s, std::min(0.8, 0.05 * n) * beyond + unit(random)));
    });
    upper.move([&](Vector3 x) { return Vector3(x + Vector3(unit(random), 0, -0.005)); });
    interface.update(1e-5);
  }
};

TEST(WhatActs, ObeysCoulombAndVanishesPastTheEdge) {
  PassingRim rim;
  rim.interface.update(0);
  int past = 0, at_edge = 0;
  double spring = 0;
  for (int n = 1; n <= 60; ++n) {
    const Points before = rim.interface.points();
    rim.move(n);
    const Points& p = rim.interface.points();
    EXPECT_LE(find_largest_excess(p), 0) << n;
    const Scalars pressure = p.acting_pressure();
    for (Eigen::Index i = 0; i < p.size(); ++i) {
      at_edge += p.gap(i) < 0 && p.weight(i) > 0 && p.weight(i) < 1;
      if (p.weight(i) > 0 && p.gap(i) < 0) continue;
      EXPECT_EQ(pressure(i), 0);
      EXPECT_EQ(mechanics::at(p.acting_traction(), i).norm(), 0);
      if (p.weight(i) > 0 || before.weight(i) > 0) continue;
      past += p.gap(i) < 0;
      spring = std::max(spring, kLaw.tangential * mechanics::at(p.stick, i).norm());
      EXPECT_EQ(p.slip(i), before.slip(i));
      EXPECT_EQ(p.friction_work(i), before.friction_work(i));
    }
  }
  EXPECT_GT(past, 100);
  EXPECT_GT(at_edge, 20);
  EXPECT_GT(spring, 10);  // MPa, had they a partner
}

TEST(WhatActs, FrictionWorkOfAllPointsIsThatOfTheInterface) {
  PassingRim rim;
  rim.interface.update(0);
  for (int n = 1; n <= 60; ++n) {
    rim.move(n);
    const Points& p = rim.interface.points();
    const double friction = rim.interface.energies().friction;
    EXPECT_NEAR((p.friction_work * p.area).sum(), friction, 1e-12 * (p.friction_work.abs() * p.area).sum()) << n;
    if (n == 60) EXPECT_GT(friction, 1);
  }
}

TEST(WhatActs, FrictionWorkOnAToolIsThatOfTheInterface) {
  ContactLayer sheet(make_turned_rectangle(10, 8, 0.5, -0.5, 0.2), 1);
  Tool tool{.name = "punch", .shape = std::make_unique<PyramidPunch>(10, 5, 2), .z = 0};
  ToolInterface interface(kLaw, sheet.geometry, tool);
  interface.update(0);
  for (int n = 1; n <= 100; ++n) {
    tool.increment = -0.01;
    tool.z += tool.increment;
    sheet.move([&](Vector3 x) {
      return Vector3(x + Vector3(0.003 * n, 0, -0.007 * n * std::exp(-0.02 * x.squaredNorm())));
    });
    interface.update(1e-5);
    const Points& p = interface.points();
    EXPECT_LE(find_largest_excess(p), 0) << n;
    EXPECT_NEAR((p.friction_work * p.area).sum(), interface.energies().friction,
                1e-12 * (p.friction_work.abs() * p.area).sum());
  }
  EXPECT_GT(interface.energies().friction, 1);
}

}  // namespace
