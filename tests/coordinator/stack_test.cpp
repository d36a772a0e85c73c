#include "coordinator/stack.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "coordinator/scripted_link.hpp"

namespace {

using namespace interply;
using namespace interply::coordinator;
using mechanics::NodalVectors;

constexpr int kLayers = 5;

/// The reference stack, optionally with noise and a vertical shift per layer.
std::vector<exchange::Motion> make_motions(const scene::Scene& scene, const std::vector<double>& shift,
                                           double noise = 0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-noise, noise);
  std::vector<exchange::Motion> motions(kLayers);
  for (int i = 0; i < kLayers; ++i) {
    exchange::Motion& m = motions[static_cast<std::size_t>(i)];
    m.position = solve::make_layer_mesh(scene, i).reference;
    m.position.row(2) += shift[static_cast<std::size_t>(i)];
    if (noise > 0) m.position = m.position.unaryExpr([&](double x) { return x + unit(random); });
    m.vote = 1e-6;
  }
  return motions;
}

double total_z(const NodalVectors& f) { return f.row(2).sum(); }

/// Every interface gets its own pressure: layers pushed into each other by different amounts.
TEST(Stack, ForceOnALayerIsWhatItsTwoFacesCarry) {
  const auto scene = test::read_flat_stack();
  Stack stack(scene);
  const std::vector<double> shift{-0.001, -0.003, -0.006, -0.010, -0.015};
  const auto motions = make_motions(scene, shift);
  stack.move_tools(0, -0.020);
  stack.begin_step();
  for (int i = 0; i < kLayers; ++i) test::accept(stack, i, motions[static_cast<std::size_t>(i)], 0);
  ASSERT_TRUE(stack.is_step_complete());

  const auto resultant = [&](int interface) {  // pressure over area
    const contact::Points& p = stack.points(interface);
    return (p.pressure * p.weight * p.area).sum();
  };
  double tools = stack.die().force.z() + stack.blank_holder().force.z() + stack.punch()->force.z();
  NodalVectors force;
  for (int i = 0; i < kLayers; ++i) {
    ASSERT_TRUE(stack.can_send_force(i));
    stack.sum_force(i, force);
    EXPECT_FALSE(stack.can_send_force(i));
    const double below = i == 0 ? -stack.die().force.z() : resultant(i);
    const double above = i < kLayers - 1 ? resultant(i + 1) : stack.blank_holder().force.z() + stack.punch()->force.z();
    EXPECT_GT(below, 0);
    EXPECT_NEAR(total_z(force), below - above, 1e-9 * above) << i;
    tools += total_z(force);
  }
  EXPECT_NEAR(tools, 0, 1e-9 * stack.blank_holder().force.z());
}

/// Between layers pushed 2 %, 4 % ... into each other the pressure is uniform and what the law says.
TEST(Stack, PressureOfEveryInterfaceFollowsFromItsOwnLaw) {
  const auto scene = test::read_flat_stack();
  Stack stack(scene);
  const std::vector<double> shift{-0.001, -0.003, -0.006, -0.010, -0.015};
  const auto motions = make_motions(scene, shift);
  stack.begin_step();
  for (int i = 0; i < kLayers; ++i) test::accept(stack, i, motions[static_cast<std::size_t>(i)], 0);
  for (int k = 1; k < kLayers; ++k) {
    const auto u = static_cast<std::size_t>(k);
    const double thinner = std::min(scene.layers[u - 1].thickness, scene.layers[u].thickness);
    EXPECT_EQ(stack.thinner(k), thinner);
    const double expected =
        scene.contact.reference_pressure / (scene.contact.penetration * thinner) * (shift[u - 1] - shift[u]);
    EXPECT_NEAR(stack.points(k).pressure.minCoeff(), expected, 1e-9 * expected);
    EXPECT_NEAR(stack.points(k).pressure.maxCoeff(), expected, 1e-9 * expected);
    const double area = 0.5 * scene.blank.length * scene.blank.width;
    EXPECT_NEAR((stack.points(k).pressure * stack.points(k).area).sum(), expected * area, 1e-9 * expected * area);
  }
}

TEST(Stack, OrderOfArrivalDoesNotChangeABit) {
  const auto scene = test::read_flat_stack();
  std::vector<int> order{0, 1, 2, 3, 4};
  std::vector<NodalVectors> reference;
  for (int permutation = 0; permutation < 120; permutation += 1) {
    Stack stack(scene);
    std::vector<NodalVectors> forces(kLayers);
    for (int step = 0; step < 3; ++step) {
      const auto motions = make_motions(scene, {0, -0.002, -0.004, -0.006, -0.008}, 0.003, 7u + unsigned(step));
      stack.move_tools(0, step ? -0.004 : 0);
      stack.begin_step();
      std::vector<int> answered;
      for (const int i : order) {
        test::accept(stack, i, motions[static_cast<std::size_t>(i)], step ? 1e-6 : 0);
        for (int k = 0; k < kLayers; ++k) {
          if (!stack.can_send_force(k)) continue;
          stack.sum_force(k, forces[static_cast<std::size_t>(k)]);
          answered.push_back(k);
        }
      }
      EXPECT_EQ(answered.size(), 5u);
    }
    if (reference.empty()) reference = forces;
    for (int i = 0; i < kLayers; ++i)
      ASSERT_TRUE((forces[static_cast<std::size_t>(i)] == reference[static_cast<std::size_t>(i)]).all());
    std::next_permutation(order.begin(), order.end());
  }
}

TEST(Stack, LayerIsAnsweredAsSoonAsItsNeighboursAreHere) {
  const auto scene = test::read_flat_stack();
  Stack stack(scene);
  const auto motions = make_motions(scene, {0, 0, 0, 0, 0});
  const auto arrive = [&](int i) { test::accept(stack, i, motions[static_cast<std::size_t>(i)], 0); };
  stack.begin_step();
  arrive(4);
  EXPECT_FALSE(stack.can_send_force(4));
  arrive(3);
  EXPECT_TRUE(stack.can_send_force(4));
  EXPECT_FALSE(stack.can_send_force(3));
  arrive(1);
  EXPECT_FALSE(stack.can_send_force(1));
  arrive(0);
  EXPECT_TRUE(stack.can_send_force(0));
  EXPECT_FALSE(stack.can_send_force(1));
  EXPECT_FALSE(stack.is_step_complete());
  arrive(2);
  for (int i = 0; i < kLayers; ++i) EXPECT_TRUE(stack.can_send_force(i)) << i;
  EXPECT_TRUE(stack.is_step_complete());
}

TEST(Stack, LinearMomentumIsConservedWhateverTheShape) {
  const auto scene = test::read_flat_stack();
  Stack stack(scene);
  for (int step = 0; step < 5; ++step) {
    const auto motions = make_motions(scene, {0, -0.01, -0.02, -0.03, -0.04}, 0.02, 11u + unsigned(step));
    stack.move_tools(0, -0.01);
    stack.begin_step();
    for (int i = 0; i < kLayers; ++i) test::accept(stack, i, motions[static_cast<std::size_t>(i)], step ? 1e-6 : 0);
    mechanics::Vector3 sum = stack.die().force + stack.blank_holder().force + stack.punch()->force;
    double scale = 0;
    NodalVectors force;
    for (int i = 0; i < kLayers; ++i) {
      stack.sum_force(i, force);
      sum += mechanics::Vector3(force.row(0).sum(), force.row(1).sum(), force.row(2).sum());
      scale += force.abs().sum();
    }
    EXPECT_GT(scale, 1000);
    EXPECT_LT(sum.norm(), 1e-12 * scale);
  }
}

TEST(Stack, FlangeAreaMassAndStiffnessAreThoseOfTheModelledPart) {
  const auto half_scene = test::read_flat_stack(), full_scene = test::read_flat_stack({"blank.symmetry=full"});
  const Stack half(half_scene), full(full_scene);
  EXPECT_NEAR(full.flange_area(), 2 * half.flange_area(), 1e-9 * full.flange_area());
  EXPECT_NEAR(full.mass(), 2 * half.mass(), 1e-12 * full.mass());
  EXPECT_NEAR(full.stiffness(), 2 * half.stiffness(), 1e-9 * full.stiffness());
  EXPECT_NEAR(full.mass(), 280 * 280 * (2 * 7.85e-9 * 1.0 + 3 * 6.19e-10 * 1.2), 1e-12);
  // the opening: triangle of edge 100 widened by 22 + 10 mm
  const double r = 32, opening = std::sqrt(3.0) / 4 * 1e4 + 300 * r + M_PI * r * r;
  EXPECT_NEAR(full.flange_area(), 280 * 280 - opening, 1e-9);
}

TEST(Stack, ContactRatesBoundTheTrueFrequenciesOfTheWholeStack) {
  // Largest eigenvalue of M^-1 K over the layers' vertical displacements, by power iteration on the stack's own forces
  const auto scene = test::read_flat_stack({"blank.mesh_size=40", "contact.damping=0"});
  std::vector<NodalVectors> u(kLayers);
  std::vector<mechanics::Scalars> mass;
  const std::vector<double> squeezed{-0.001, -0.003, -0.006, -0.010, -0.015};
  const auto base = make_motions(scene, squeezed);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto forces_at = [&](double scale) {
    Stack stack(scene);
    stack.move_tools(0, -0.020);
    stack.begin_step();
    std::vector<NodalVectors> f(kLayers);
    for (int i = 0; i < kLayers; ++i) {
      exchange::Motion m = base[static_cast<std::size_t>(i)];
      m.position += scale * u[static_cast<std::size_t>(i)];
      test::accept(stack, i, m, 0);
    }
    for (int i = 0; i < kLayers; ++i) stack.sum_force(i, f[static_cast<std::size_t>(i)]);
    return f;
  };
  Stack stack(scene);
  for (int i = 0; i < kLayers; ++i) {
    mass.push_back(stack.layer(i).geometry.mass());
    u[static_cast<std::size_t>(i)] = NodalVectors::Zero(3, mass.back().size());
    for (int n = 0; n < mass.back().size(); ++n) u[static_cast<std::size_t>(i)](2, n) = unit(random);
  }
  const double small = 1e-7;
  double eigenvalue = 0;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const auto plus = forces_at(small), minus = forces_at(-small);
    double norm = 0;
    for (std::size_t i = 0; i < kLayers; ++i) {
      const mechanics::Scalars a = (-(plus[i].row(2) - minus[i].row(2)) / (2 * small)).transpose() / mass[i];
      u[i].row(2) = a.transpose();
      norm = std::max(norm, a.abs().maxCoeff());
    }
    eigenvalue = norm;
    for (auto& v : u) v /= norm;
  }
  stack.begin_step();
  for (int i = 0; i < kLayers; ++i) test::accept(stack, i, base[static_cast<std::size_t>(i)], 0);
  const double bound = std::pow(2 / stack.collect_votes().contact, 2);
  EXPECT_LE(eigenvalue, bound);
  EXPECT_GT(eigenvalue, 0.85 * bound);  // one weight for all layers would leave 0.77
}

}  // namespace
