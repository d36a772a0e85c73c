#include "mechanics/central_difference.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace {

using namespace interply::mechanics;

/// One mass on a spring: the discrete frequency of the scheme is sin(w' dt / 2) = w dt / 2.
TEST(CentralDifference, OscillatorHasTheDiscreteFrequencyAndKeepsItsEnergy) {
  TriangleMesh mesh = make_rectangle({0, 1}, {0, 1}, 1);
  NodalMotion motion = make_motion_at_rest(mesh);
  const Scalars mass = Scalars::Constant(4, 2.0);
  const double k = 8, omega = 2, dt = 0.3;
  motion.position.row(2) += 1.0;
  NodalVectors force = NodalVectors::Zero(3, 4), old = force;
  const NodalVectors none = NodalVectors::Zero(3, 4);
  double work = 0, kinetic = 0, total = 0;
  const double discrete = 2 / dt * std::asin(0.5 * omega * dt);
  for (int n = 0; n < 1000; ++n) {
    old = force;
    force.row(2) = k * (motion.position.row(2) - mesh.reference.row(2));
    if (n == 0) old = force;
    work += compute_trapezoid_work(old, force, motion.increment);
    kinetic = kick(motion, dt, none, force, mass, {});
    EXPECT_NEAR(motion.position(2, 0), std::cos(discrete * dt * n), 1e-11 * (n + 1));
    if (n == 1) total = kinetic + work;
    if (n > 0) {
      EXPECT_NEAR(kinetic + work, total, 1e-11);
    }
    drift(motion, dt);
  }
}

TEST(CentralDifference, SymmetryNodesStayInTheirPlane) {
  const TriangleMesh mesh = make_rectangle({0, 1}, {0, 1}, 1, 0, true);
  NodalMotion motion = make_motion_at_rest(mesh);
  const NodalVectors push = NodalVectors::Constant(3, 4, 1.0), none = NodalVectors::Zero(3, 4);
  kick(motion, 0.1, push, none, Scalars::Ones(4), mesh.symmetry_nodes);
  drift(motion, 0.1);
  for (const int i : mesh.symmetry_nodes) EXPECT_EQ(motion.position(1, i), 0.0);
  EXPECT_GT(motion.position(1, 3), 1.0);
}

}  // namespace
