/// V14: impact of two free layers: energy and momentum.
#include <gtest/gtest.h>

#include <cmath>

#include "solver_fabric/fabric_layer.hpp"
#include "solver_metal/metal_layer.hpp"
#include "support/free_layers.hpp"
#include "support/point_masses.hpp"
#include "support/results.hpp"

namespace {

using namespace interply;
using namespace interply::test;

const contact::InterfaceLaw kFrictionless{.stiffness = 500, .tangential = 500};
const double kSheetDensity = 7.85e-9, kPlyDensity = 6.19e-10;

mechanics::TriangleMesh make_mesh(double size, double h, double z) {
  return mechanics::make_rectangle({-size, size}, {-size, size}, h, z);
}

std::unique_ptr<solve::LayerMechanics> make_sheet(const mechanics::TriangleMesh& mesh) {
  scene::Layer layer;
  layer.name = "sheet";
  layer.law = scene::J2Law{};
  return std::make_unique<metal::MetalLayer>(layer, kSheetDensity, mesh);
}

std::unique_ptr<solve::LayerMechanics> make_ply(const mechanics::TriangleMesh& mesh) {
  scene::Layer layer;
  layer.name = "ply";
  layer.thickness = 1.2;
  layer.density = kPlyDensity;
  layer.law = scene::WovenLaw{};
  return std::make_unique<fabric::FabricLayer>(layer, 1.0, mesh);
}

/// Every pair of facing nodes is a collision on a line: v1' = (m1 - m2)/(m1 + m2) v1 + ..., without loss.
TEST(Impact, OfPointMassesExchangesVelocitiesAsElasticSpheres) {
  for (const double ratio : {0.2, 1.0, 3.0}) {
    const double speed = 1000;
    const auto lower_mesh = make_mesh(20, 5, 0), upper_mesh = make_mesh(20, 5, 1.05);
    FreeLayer lower(lower_mesh, std::make_unique<PointMasses>(lower_mesh.n_nodes()), 1, 1e-9, Vector3(0, 0, speed));
    FreeLayer upper(upper_mesh, std::make_unique<PointMasses>(upper_mesh.n_nodes()), 1, ratio * 1e-9,
                    Vector3(0, 0, -speed));
    FreePair pair(kFrictionless, lower, upper);
    const double reduced = 1e-9 * ratio / (1 + ratio), period = 2 * M_PI * std::sqrt(reduced / 500);
    for (int n = 0; n < 4000 && pair.time < 2 * (0.025e-3 + period); ++n) pair.step(period / 200);
    const double m1 = 1, m2 = ratio;
    const double v1 = ((m1 - m2) * speed - 2 * m2 * speed) / (m1 + m2);
    const double v2 = (2 * m1 * speed + (m1 - m2) * speed) / (m1 + m2);
    EXPECT_EQ(pair.interface.energies().stored, 0);  // apart again
    EXPECT_LT((lower.motion.velocity.row(2) - v1).abs().maxCoeff(), 2e-3 * speed) << ratio;
    EXPECT_LT((upper.motion.velocity.row(2) - v2).abs().maxCoeff(), 2e-3 * speed) << ratio;
    if (ratio != 3.0) continue;
    expect_result({.row = "V14",
                   .quantity = "speed after impact on a layer of three times the mass",
                   .source = "elastic collision (m1 - 3 m1)/(4 m1) v - 6/4 v",
                   .reference = v1,
                   .ours = lower.motion.velocity.row(2).mean(),
                   .unit = "mm/s",
                   .mesh = "matching, 200 steps a period"});
  }
}

/// A steel sheet against a ply of another mesh, bending and stretching both; nothing dissipates but the steel, whose
/// stress work counts as internal energy.
TEST(Impact, OfASheetOnAPlyKeepsEnergyAndMomentum) {
  const auto lower_mesh = make_mesh(40, 10, 0), upper_mesh = make_mesh(25, 8, 1.15);
  FreeLayer lower(lower_mesh, make_ply(lower_mesh), 1.2, kPlyDensity, Vector3(0, 0, 2000));
  FreeLayer upper(upper_mesh, make_sheet(upper_mesh), 1.0, kSheetDensity, Vector3(0, 0, -2000));
  FreePair pair(kFrictionless, lower, upper);
  const double dt = 0.1e-6;
  pair.step(dt);
  const double energy = pair.energy();
  const Vector3 momentum = pair.momentum();
  double largest = 0, exchanged = 0;
  for (int n = 0; n < 9000; ++n) {
    pair.step(dt);
    largest = std::max(largest, std::abs(pair.energy() - energy));
    exchanged = std::max(exchanged, (lower.momentum() - momentum).norm());
    ASSERT_LT((pair.momentum() - momentum).norm(), 1e-10 * lower.geometry.mass().sum() * 2000);
  }
  expect_result({.row = "V14",
                 .quantity = "sheet on ply: largest change of the total energy / energy",
                 .source = "conservation",
                 .reference = 0,
                 .ours = largest / energy,
                 .tolerance = 1e-3,
                 .absolute = true,
                 .mesh = "10 mm against 8 mm"});
  EXPECT_GT(lower.internal(), 0);
  EXPECT_GT(exchanged, 0);
}

TEST(Impact, WithFrictionAndDampingKeepsMomentumToRoundOffAndAccountsForWhatIsLost) {
  const auto lower_mesh = make_mesh(40, 10, 0), upper_mesh = make_mesh(25, 8, 1.15);
  FreeLayer lower(lower_mesh, make_ply(lower_mesh), 1.2, kPlyDensity, Vector3(1500, -300, 2000));
  FreeLayer upper(upper_mesh, make_sheet(upper_mesh), 1.0, kSheetDensity, Vector3(-200, 400, -2000));
  contact::InterfaceLaw law = kFrictionless;
  law.friction = 0.3;
  law.damping = contact::compute_damping(0.1, law.stiffness, 1.2 * kPlyDensity, kSheetDensity);
  FreePair pair(law, lower, upper);
  const double dt = 0.1e-6;
  pair.step(dt);
  const double energy = pair.energy();
  const Vector3 momentum = pair.momentum();
  const double scale = 2000 * (lower.geometry.mass().sum() + upper.geometry.mass().sum());
  double largest = 0, lost = 0;
  for (int n = 0; n < 9000; ++n) {
    pair.step(dt);
    largest = std::max(largest, std::abs(pair.energy() - energy));
    lost = std::max(lost, (pair.momentum() - momentum).norm());
  }
  expect_result({.row = "V14",
                 .quantity = "the same with friction and damping: energy not accounted for / energy",
                 .source = "conservation",
                 .reference = 0,
                 .ours = largest / energy,
                 .tolerance = 1e-3,
                 .absolute = true,
                 .mesh = "10 mm against 8 mm"});
  expect_result({.row = "V14",
                 .quantity = "the same: largest change of momentum / momentum",
                 .source = "conservation, round-off",
                 .reference = 0,
                 .ours = lost / scale,
                 .tolerance = 1e-11,
                 .absolute = true,
                 .mesh = "10 mm against 8 mm"});
  EXPECT_GT(pair.interface.energies().friction, 1e-3 * energy);
  EXPECT_GT(pair.interface.energies().damping, 1e-4 * energy);
}

}  // namespace
