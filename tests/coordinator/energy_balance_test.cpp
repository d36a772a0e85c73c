#include "coordinator/energy_balance.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "coordinator/frames.hpp"

namespace {

using namespace interply;
using namespace interply::coordinator;

const std::vector<exchange::LayerEnergies> kLayers{{.kinetic = 1, .internal = 20, .contact_work = 21},
                                                   {.kinetic = 2, .internal = 30, .contact_work = 31.5}};

/// Energies that balance: what punch and holder put in is found again in layers, springs, friction and damping.
CoordinatorEnergies make_own() {
  CoordinatorEnergies own;
  own.interfaces = {{.stored = 3, .friction = 10, .damping = 0.5, .thinning = 0.25, .work = -13.25},
                    {.stored = 4, .friction = 11, .damping = 0.75, .thinning = 0, .work = -15.75}};
  own.blank_holder = {.kinetic = 0.5, .damping = 0.25, .load = 9, .contact = -8.25};
  own.punch_work = 73.75;
  return own;
}

TEST(EnergyBalance, EveryTermEntersOnceWithItsSign) {
  EnergyBalance b;
  assemble_balance(kLayers, make_own(), b);
  EXPECT_DOUBLE_EQ(b.kinetic, 3.5);
  EXPECT_DOUBLE_EQ(b.internal, 50);
  EXPECT_DOUBLE_EQ(b.contact, 7);
  EXPECT_DOUBLE_EQ(b.friction, 21);
  EXPECT_DOUBLE_EQ(b.damping, 1.5);
  EXPECT_DOUBLE_EQ(b.thinning, 0.25);
  EXPECT_DOUBLE_EQ(b.external, 82.75);
  EXPECT_DOUBLE_EQ(b.residual(), 0);
  EXPECT_DOUBLE_EQ(b.scale(), 83);
  EXPECT_DOUBLE_EQ(b.layer_residual[0], 0);
  EXPECT_DOUBLE_EQ(b.layer_residual[1], 0.5);
  EXPECT_DOUBLE_EQ(b.interface_residual[0], 0);
  EXPECT_DOUBLE_EQ(b.interface_residual[1], 0);
}

/// A laminate of 2 kg under a punch of 3 m/s holds 9 J; 50 kN on 100 kN/mm store 12.5 J.
TEST(EnergyBalance, TheLeastScaleIsWhatPunchAndHolderPutIntoAnyLaminate) {
  EXPECT_DOUBLE_EQ(compute_least_scale(2e-3, 3e3, 0, 1e5), 9e3);
  EXPECT_DOUBLE_EQ(compute_least_scale(2e-3, 0, 50e3, 1e5), 12.5e3);
  EXPECT_DOUBLE_EQ(compute_least_scale(2e-3, 3e3, 50e3, 1e5), 21.5e3);
}

TEST(EnergyBalance, TheLeastScaleIsNeverNextToNothing) {
  EXPECT_EQ(compute_least_scale(2e-3, 0, 0, 1e5), 1);      // nothing moves, nothing is pressed
  EXPECT_EQ(compute_least_scale(1e-9, 1e-3, 0, 1e5), 1);   // a crumb at a snail's pace
  EXPECT_EQ(compute_least_scale(2e-3, 0, 0, 0), 1);        // a stack without a flange
}

TEST(EnergyBalance, AssemblingAgainDoesNotAddUp) {
  EnergyBalance b;
  assemble_balance(kLayers, make_own(), b);
  assemble_balance(kLayers, make_own(), b);
  EXPECT_DOUBLE_EQ(b.external, 82.75);
  EXPECT_EQ(b.layer_residual.size(), 2u);
  EXPECT_EQ(b.interface_residual.size(), 2u);
}

TEST(EnergyBalance, TheWorstShareIsNamedAndNaNIsTheWorst) {
  scene::Scene scene;
  scene.layers.resize(2);
  scene.layers[0].name = "sheet";
  scene.layers[1].name = "ply";
  EnergyBalance b;
  b.layer_residual = {0.1, -0.2};
  b.interface_residual = {0, 0.15, 0};
  EXPECT_EQ(explain_residual(scene, b).name, "layer ply");
  b.interface_residual[1] = -0.3;
  EXPECT_EQ(explain_residual(scene, b).name, "interface sheet|ply");
  b.layer_residual[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(explain_residual(scene, b).name, "layer sheet");
}

}  // namespace
