#include "mechanics/central_difference.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <utility>

#include "mechanics/kick_nodes.hpp"

namespace {

using namespace interply;
using namespace interply::mechanics;

/// One mass on a spring: the discrete frequency of the scheme is sin(w' dt / 2) = w dt / 2.
TEST(CentralDifference, OscillatorHasTheDiscreteFrequencyAndKeepsItsEnergy) {
  const TriangleMesh mesh = make_rectangle({0, 1}, {0, 1}, 1);
  NodalMotion motion = make_motion_at_rest(mesh);
  NodalVectors x = mesh.reference;
  const Scalars mass = Scalars::Constant(4, 2.0);
  const double k = 8, omega = 2, dt = 0.3;
  x.row(2) += 1.0;
  NodalVectors force = NodalVectors::Zero(3, 4);
  const NodalVectors none = NodalVectors::Zero(3, 4);
  double total = 0;
  const double discrete = 2 / dt * std::asin(0.5 * omega * dt);
  for (int n = 0; n < 1000; ++n) {
    force.row(2) = k * (x.row(2) - mesh.reference.row(2));
    kick(motion, dt, none, force, mass, {});
    EXPECT_NEAR(x(2, 0), std::cos(discrete * dt * n), 1e-11 * (n + 1));
    if (n == 1) total = motion.kinetic + motion.work.internal;
    if (n > 0) {
      EXPECT_NEAR(motion.kinetic + motion.work.internal, total, 1e-11);
      // the energy that balances is below zero at turning points, by (omega dt / 2)^2 of the whole
      const double whole = 4 * 0.5 * k, sine = std::sin(discrete * dt * n);
      EXPECT_NEAR(motion.kinetic, whole * (sine * sine - 0.25 * omega * omega * dt * dt), 1e-10 * (n + 1));
    }
    drift(motion, dt, x);
  }
}

TEST(CentralDifference, SymmetryNodesStayInTheirPlane) {
  const TriangleMesh mesh = make_rectangle({0, 1}, {0, 1}, 1, 0, true);
  NodalMotion motion = make_motion_at_rest(mesh);
  NodalVectors x = mesh.reference, none = NodalVectors::Zero(3, 4);
  const NodalVectors push = NodalVectors::Constant(3, 4, 1.0);
  kick(motion, 0.1, push, none, Scalars::Ones(4), mesh.symmetry_nodes);
  drift(motion, 0.1, x);
  for (const int i : mesh.symmetry_nodes) EXPECT_EQ(x(1, i), 0.0);
  EXPECT_GT(x(1, 3), 1.0);
}

/// Forces, velocities and masses without any order, at 98 nodes, no multiple of any width.
struct Crowd {
  static constexpr Eigen::Index kNodes = 98;
  NodalVectors contact{3, kNodes}, internal{3, kNodes}, velocity{3, kNodes};
  Scalars mass{kNodes};

  Crowd() {
    for (NodalVectors* a : {&contact, &internal, &velocity}) shake(*a);
    mass = 1.5 + NodalVectors(contact).row(0).transpose();
  }
  void shake(NodalVectors& a) {
    std::uniform_real_distribution<double> number(-1, 1);
    for (double& value : a.reshaped()) value = number(random_);
  }
  template <class Target>
  KickSums kick(double span) {
    const auto rows = [](auto& a) { return std::array{&a(0, 0), &a(1, 0), &a(2, 0)}; };
    const auto f = rows(std::as_const(contact)), g = rows(std::as_const(internal));
    const auto v = rows(velocity);
    return kick_nodes<Target>({mass.data(), {f[0], f[1], f[2]}, {g[0], g[1], g[2]}, {v[0], v[1], v[2]}}, span, kNodes);
  }

 private:
  std::mt19937 random_{3};
};

TEST(CentralDifference, WorkIsTheTrapezoidOverTheIncrementsWhateverTheSteps) {
  const TriangleMesh mesh = make_rectangle({0, 13}, {0, 6}, 1, 0, true);
  ASSERT_EQ(mesh.n_nodes(), Crowd::kNodes);
  Crowd crowd;
  NodalMotion motion = make_motion_at_rest(mesh);
  NodalVectors x = mesh.reference, old_x = x, v = motion.velocity, old_contact, old_internal;
  double dt = 0, contact = 0, internal = 0;
  for (int n = 0; n < 20; ++n) {
    const double next_dt = 0.1 + 0.07 * (n % 3);
    crowd.shake(crowd.contact);
    crowd.shake(crowd.internal);
    if (n > 0) {
      contact += 0.5 * ((old_contact + crowd.contact) * (x - old_x)).sum();
      internal += 0.5 * ((old_internal + crowd.internal) * (x - old_x)).sum();
    }
    old_contact = crowd.contact;
    old_internal = crowd.internal;
    kick(motion, next_dt, crowd.contact, crowd.internal, crowd.mass, mesh.symmetry_nodes);
    EXPECT_NEAR(motion.work.contact, contact, 1e-12 * (n + 1));
    EXPECT_NEAR(motion.work.internal, internal, 1e-12 * (n + 1));

    NodalVectors next = v + 0.5 * (dt + next_dt) * ((old_contact - old_internal).rowwise() / crowd.mass.transpose());
    for (const int i : mesh.symmetry_nodes) next(1, i) = 0;
    EXPECT_LT((motion.velocity - next).abs().maxCoeff(), 1e-14 * (n + 1));
    EXPECT_NEAR(motion.kinetic, 0.5 * ((v * next).rowwise() * crowd.mass.transpose()).sum(), 1e-12 * (n + 1));
    v = next;
    old_x = x;
    dt = next_dt;
    drift(motion, dt, x);
    EXPECT_LT((x - old_x - dt * v).abs().maxCoeff(), 1e-13 * (n + 1));
  }
}

#if defined(__x86_64__)
TEST(KickNodes, GivesTheSameBitsInPacksOfFourAndEightAndOneByOneTheSameButRoundOff) {
  if (!__builtin_cpu_supports("avx512dq")) GTEST_SKIP() << "not on this machine";
  Crowd one, four, eight;
  for (int step = 0; step < 5; ++step) {
    const KickSums a = four.kick<simd::Avx2>(0.1), b = eight.kick<simd::Avx512>(0.1), c = one.kick<simd::Scalar>(0.1);
    EXPECT_TRUE((four.velocity == eight.velocity).all());
    EXPECT_LT((four.velocity - one.velocity).abs().maxCoeff(), 1e-14);
    EXPECT_EQ(a.kinetic, b.kinetic);
    EXPECT_NEAR(a.kinetic, c.kinetic, 1e-12);
    for (Power KickSums::*const when : {&KickSums::before, &KickSums::after})
      for (double Power::*const sum : {&Power::contact, &Power::internal}) {
        EXPECT_EQ(a.*when.*sum, b.*when.*sum);
        EXPECT_NEAR(a.*when.*sum, c.*when.*sum, 1e-12);
      }
  }
}
#endif

}  // namespace
