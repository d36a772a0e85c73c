#include "contact/points.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace interply::contact;

const InterfaceLaw kLaw{.stiffness = 500, .tangential = 500, .damping = 0, .friction = 0.25};

PointMotion pressed(double depth, const Vector3& slip) {
  return {.distance = 1.0 - depth, .height = 1.0, .weight = 1, .normal = Vector3::UnitZ(), .slip = slip, .dt = 1e-6};
}

/// Force on the node of a point whose spring is carried by nothing.
Vector3 advance(const InterfaceLaw& law, Points& p, PointMotion m, InterfaceEnergies& e) {
  if (stays_open(p, 0, m.distance - m.height, m.height, m.weight)) return Vector3::Zero();
  m.stick = interply::mechanics::at(p.stick, 0);
  const PointForce force = advance_point(law, p, 0, m, e);
  return force.drag - force.pressing * m.normal;
}

Points one_point(double area = 4) {
  Points p(Scalars::Constant(1, area), kLaw.tangential);
  p.height(0) = 1.0;
  return p;
}

TEST(ContactPoint, PressureIsStiffnessTimesPenetrationAndNeverTension) {
  Points p = one_point();
  InterfaceEnergies e;
  EXPECT_EQ(advance(kLaw, p, pressed(-0.01, Vector3::Zero()), e), Vector3::Zero());
  const Vector3 f = advance(kLaw, p, pressed(0.004, Vector3(0, 0, 0.014)), e);
  EXPECT_NEAR(p.pressure(0), 2.0, 1e-12);
  EXPECT_NEAR(f.z(), -8.0, 1e-12);
  InterfaceLaw damped = kLaw;
  damped.damping = 1;  // separating fast: the damper must not pull
  advance(damped, p, pressed(0.003, Vector3(0, 0, -0.01)), e);
  EXPECT_EQ(p.pressure(0), 0.0);
}

TEST(ContactPoint, SticksBelowAndSlidesAboveTheFrictionLimit) {
  Points p = one_point();
  InterfaceEnergies e;
  advance(kLaw, p, pressed(0.004, Vector3::Zero()), e);
  advance(kLaw, p, pressed(0.004, Vector3(0.0009, 0, 0)), e);  // 0.45 MPa < 0.25 * 2
  EXPECT_EQ(p.state(0), static_cast<int>(State::Stick));
  EXPECT_NEAR(p.acting_traction()(0, 0), -0.45, 1e-12);
  advance(kLaw, p, pressed(0.004, Vector3(0.0011, 0, 0)), e);  // would be 1.0 MPa
  EXPECT_EQ(p.state(0), static_cast<int>(State::Slide));
  EXPECT_NEAR(p.acting_traction()(0, 0), -0.5, 1e-12);
  EXPECT_NEAR(p.slip(0), 0.001, 1e-12);
}

/// Whatever the history, what the forces do is what the springs store plus what slip and damping take.
TEST(ContactPoint, EnergyBooksCloseAlongAnyPathWithFixedNormal) {
  InterfaceLaw law = kLaw;
  law.damping = 2e-6;
  Points p = one_point();
  InterfaceEnergies e;
  Vector3 old_force = Vector3::Zero(), slip;
  double depth = -0.001;
  for (int n = 0; n < 4000; ++n) {
    const double next = 0.004 * std::sin(0.013 * n) + 0.001 * std::sin(0.11 * n);
    slip << 1e-4 * std::cos(0.05 * n), 1e-4 * std::sin(0.031 * n), next - depth;
    depth = next;
    e.stored = 0;
    const Vector3 force = advance(law, p, pressed(depth, slip), e);
    e.work += 0.5 * (old_force + force).dot(slip);
    old_force = force;
    // a contact that opens or closes within a step leaves O(k slip^2); everything else is exact
    EXPECT_NEAR(e.residual(), 0, 1e-4 * (e.friction + e.damping + 0.01));
  }
  EXPECT_GT(e.friction, 0.05);
  EXPECT_GT(e.damping, 0);
}

TEST(ContactPoint, ThinningWorkIsBooked) {
  Points p = one_point();
  InterfaceEnergies e;
  PointMotion m = pressed(0.004, Vector3::Zero());
  p.height(0) = m.height;
  advance(kLaw, p, m, e);
  const double before = e.stored;
  e.stored = 0;
  m.height -= 0.001;  // the layer thins at fixed midsurfaces
  advance(kLaw, p, m, e);
  EXPECT_NEAR(e.stored - before, e.thinning, 1e-12);
  EXPECT_LT(e.thinning, 0);
}

TEST(Stiffness, GivesTheAllowedPenetrationAtTheReferencePressure) {
  EXPECT_NEAR(compute_stiffness(10, 0.02, 1.0), 500, 1e-12);  // services/contact/THEORY.md: 4 um under 2 MPa
}

TEST(PenetrationSample, PercentileIsByAreaAndLeavesOutWhatFacesNothing) {
  Points p(Scalars::Constant(1001, 1.0), kLaw.tangential);
  for (int i = 0; i < 1000; ++i) p.gap(i) = i < 5 ? -0.1 : -0.01;
  p.gap(1000) = -5;
  p.weight(1000) = 0;  // beyond the partner's edge
  PenetrationSample sample;
  sample.add(p, 0.5);
  EXPECT_DOUBLE_EQ(sample.compute_percentile(0.99), 0.02);
  EXPECT_DOUBLE_EQ(sample.peak(), 0.2);
}

}  // namespace
