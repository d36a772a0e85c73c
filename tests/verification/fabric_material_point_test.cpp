/// V1: material point under uniaxial and biaxial strain, all variants, against the paper's equations written out here.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "solver_fabric/material_point.hpp"
#include "support/fabric_cases.hpp"
#include "support/results.hpp"
#include "support/woven_paper.hpp"

namespace interply {
namespace {

using namespace fabric_cases;
using fabric::FabricPoint;

/// Tolerance on a stress: round-off, or the interpolation error of the sampled tables, 6 a h^2/8.
double tolerance(const scene::WovenLaw& law, double value) {
  const double h = 2.5e-4;
  const double tables = law.variant == scene::Variant::Fabric ? 6 * std::max(law.a.warp, law.a.weft) * h * h / 8 : 0;
  return tables + 1e-11 * (1 + std::abs(value));
}

FabricPoint stretch(const scene::WovenLaw& law, double e_a, double e_b) {
  mechanics::Matrix2 F;
  F << 1 + e_a, 0, 0, 1 + e_b;
  return fabric::follow_path(law, {F}).front();
}

/// Nominal stresses, force over reference section: T = l S at zero shear.
double warp_stress(const scene::WovenLaw& law, double e_a, double e_b) {
  return (1 + e_a) * stretch(law, e_a, e_b).S11;
}
double weft_stress(const scene::WovenLaw& law, double e_a, double e_b) {
  return (1 + e_b) * stretch(law, e_a, e_b).S22;
}

/// Tension of eq. (4) and its slope, the biaxial factor of eq. (5), (6) below the cap and its slope.
double energy(double a, double b, double e) { return a * e * e * e + b * e * e; }
double tension(double a, double b, double e) { return 3 * a * e * e + 2 * b * e; }
double factor(const scene::WovenLaw& law, double c, double p_min, double e) {
  return is_biaxial(law.variant) ? std::exp(c * e) + p_min * (1 - std::exp(c * e)) : 1;
}
double factor_slope(const scene::WovenLaw& law, double c, double p_min, double e) {
  return is_biaxial(law.variant) ? (1 - p_min) * c * std::exp(c * e) : 0;
}

TEST(WovenMaterialPoint, UniaxialAtFixedWidthIsTheUniaxialTestPlusTheCouplingAcross) {
  for (const auto variant : kVariants)
    for (const auto& law : all_sets(variant))
      for (const double e : {0.002, 0.01, 0.02, 0.05}) {
        SCOPED_TRACE(name_of(variant));
        const double warp = tension(law.a.warp, law.b.warp, e), weft = tension(law.a.weft, law.b.weft, e);
        EXPECT_NEAR(warp_stress(law, e, 0), warp, tolerance(law, warp));
        EXPECT_NEAR(weft_stress(law, 0, e), weft, tolerance(law, weft));
        const double across_warp = energy(law.a.warp, law.b.warp, e) * factor_slope(law, law.c.warp, law.p_min.warp, 0);
        const double across_weft = energy(law.a.weft, law.b.weft, e) * factor_slope(law, law.c.weft, law.p_min.weft, 0);
        EXPECT_NEAR(weft_stress(law, e, 0), across_warp, tolerance(law, across_warp));
        EXPECT_NEAR(warp_stress(law, 0, e), across_weft, tolerance(law, across_weft));
      }
}

TEST(WovenMaterialPoint, UniaxialCompressionIsLinear) {
  for (const auto variant : kVariants)
    for (const auto& law : all_sets(variant))
      for (const double e : {-0.002, -0.03}) {
        EXPECT_NEAR(warp_stress(law, e, 0), 2 * law.d.warp * e, 1e-11);
        EXPECT_NEAR(weft_stress(law, 0, e), 2 * law.d.weft * e, 1e-11);
      }
}

TEST(WovenMaterialPoint, FreeWidthContractsUntilTheWeftIsFreeOfStress) {
  for (const auto variant : kVariants)
    for (const auto& law : all_sets(variant))
      for (const double e : {0.005, 0.02, 0.04}) {
        SCOPED_TRACE(name_of(variant));
        // 2 d e_b + N_a(e) dk_a/de_b = 0, and the same with a and b exchanged
        const double across_weft = find_root(
            [&](double x) {
              return 2 * law.d.weft * x +
                     energy(law.a.warp, law.b.warp, e) * factor_slope(law, law.c.warp, law.p_min.warp, x);
            },
            -0.5, 0);
        const double across_warp = find_root(
            [&](double x) {
              return 2 * law.d.warp * x +
                     energy(law.a.weft, law.b.weft, e) * factor_slope(law, law.c.weft, law.p_min.weft, x);
            },
            -0.5, 0);
        EXPECT_NEAR(weft_stress(law, e, across_weft), 0, 1e-10);
        EXPECT_NEAR(warp_stress(law, across_warp, e), 0, 1e-10);
        const double warp = tension(law.a.warp, law.b.warp, e) * factor(law, law.c.warp, law.p_min.warp, across_weft);
        const double weft = tension(law.a.weft, law.b.weft, e) * factor(law, law.c.weft, law.p_min.weft, across_warp);
        EXPECT_NEAR(warp_stress(law, e, across_weft), warp, tolerance(law, warp));
        EXPECT_NEAR(weft_stress(law, across_warp, e), weft, tolerance(law, weft));
      }
}

TEST(WovenMaterialPoint, BiaxialTensionStiffensByTheCouplingBelowTheCap) {
  for (const auto variant : kVariants)
    for (const auto& law : all_sets(variant))
      for (const auto& [e_a, e_b] : {std::array{0.02, 0.02}, std::array{0.01, 0.025}}) {
        SCOPED_TRACE(name_of(variant));
        const double warp = tension(law.a.warp, law.b.warp, e_a) * factor(law, law.c.warp, law.p_min.warp, e_b) +
                            energy(law.a.weft, law.b.weft, e_b) * factor_slope(law, law.c.weft, law.p_min.weft, e_a);
        const double weft = tension(law.a.weft, law.b.weft, e_b) * factor(law, law.c.weft, law.p_min.weft, e_a) +
                            energy(law.a.warp, law.b.warp, e_a) * factor_slope(law, law.c.warp, law.p_min.warp, e_b);
        EXPECT_NEAR(warp_stress(law, e_a, e_b), warp, tolerance(law, warp));
        EXPECT_NEAR(weft_stress(law, e_a, e_b), weft, tolerance(law, weft));
      }
}

/// One row of the table. 0.1 %: the interpolation of the sampled tables of variant `fabric`; the others are exact.
void expect_row(const std::string& quantity, const scene::WovenLaw& law, const char* set, const char* source,
                double reference, double ours, const char* unit) {
  test::expect_result({.row = "V1",
                       .quantity = fmt::format("{}, set {}, {}", quantity, set, name_of(law.variant)),
                       .source = source,
                       .reference = reference,
                       .ours = ours,
                       .unit = unit,
                       .tolerance = law.variant == scene::Variant::Fabric ? 1e-3 : 1e-9,
                       .mesh = "point"});
}

/// The equations of one fibre direction under its own strain e and the transverse strain x.
struct Fibre {
  double a, b, c, p_min, d;
};
Fibre warp_of(const scene::WovenLaw& l) { return {l.a.warp, l.b.warp, l.c.warp, l.p_min.warp, l.d.warp}; }
Fibre weft_of(const scene::WovenLaw& l) { return {l.a.weft, l.b.weft, l.c.weft, l.p_min.weft, l.d.weft}; }

/// Transverse strain at which the slack fibre `across` balances the coupling of `along` stretched by e; 1-D root.
double contract(const scene::WovenLaw& law, const Fibre& along, const Fibre& across, double e) {
  return find_root(
      [&](double x) {
        return 2 * across.d * x + energy(along.a, along.b, e) * factor_slope(law, along.c, along.p_min, x);
      },
      -0.5, 0);
}

TEST(WovenMaterialPoint, AnswersInClosedFormForTheTable) {
  const char* closed = "eq. (2)-(7), closed form";
  for (const auto variant : kVariants)
    for (const auto& [set, law] : {std::pair{"stiff", stiff(variant)}, std::pair{"lopsided", lopsided(variant)}}) {
      const Fibre warp = warp_of(law), weft = weft_of(law);
      expect_row("1 % along the warp at fixed width, stress", law, set, closed, tension(warp.a, warp.b, 0.01),
                 warp_stress(law, 0.01, 0), "MPa");
      const bool is_symmetric = law.a.warp == law.a.weft;
      if (!is_symmetric)
        expect_row("1 % along the weft at fixed width, stress", law, set, closed, tension(weft.a, weft.b, 0.01),
                   weft_stress(law, 0, 0.01), "MPa");
      for (const bool along_warp : {true, false}) {
        if (is_symmetric && !along_warp) continue;
        const Fibre& along = along_warp ? warp : weft;
        const Fibre& other = along_warp ? weft : warp;
        const std::string name = fmt::format("2 % along the {} at free width", along_warp ? "warp" : "weft");
        const auto across = [&](double x) {
          return along_warp ? weft_stress(law, 0.02, x) : warp_stress(law, x, 0.02);
        };
        const double reference = contract(law, along, other, 0.02), ours = find_root(across, -0.5, 0.5);
        if (is_biaxial(variant))
          expect_row(name + ", transverse strain", law, set, "1-D root of eq. (3)-(7)", 100 * reference, 100 * ours,
                     "%");
        else
          EXPECT_NEAR(ours, 0, 1e-15) << name;
        expect_row(name + ", stress", law, set, "1-D root of eq. (3)-(7)",
                   tension(along.a, along.b, 0.02) * factor(law, along.c, along.p_min, reference),
                   along_warp ? warp_stress(law, 0.02, ours) : weft_stress(law, ours, 0.02), "MPa");
        expect_row(fmt::format("equibiaxial 2 %, stress along the {}", along_warp ? "warp" : "weft"), law, set, closed,
                   tension(along.a, along.b, 0.02) * factor(law, along.c, along.p_min, 0.02) +
                       energy(other.a, other.b, 0.02) * factor_slope(law, other.c, other.p_min, 0.02),
                   along_warp ? warp_stress(law, 0.02, 0.02) : weft_stress(law, 0.02, 0.02), "MPa");
      }
    }
}

/// The printed numbers, to the digits printed.
TEST(WovenMaterialPoint, StiffSetGivesTheNumbersOfMechanicsV1) {
  for (const auto variant : kVariants) {
    EXPECT_NEAR(warp_stress(stiff(variant), 0.01, 0), 24.5, 0.05);
    const auto law = stiff(variant);
    const double across = find_root([&](double x) { return weft_stress(law, 0.02, x); }, -0.5, 0);
    EXPECT_NEAR(across, is_biaxial(variant) ? -0.0145 : 0, 5e-5) << name_of(variant);
    EXPECT_NEAR(warp_stress(law, 0.02, across), is_biaxial(variant) ? 74.8 : 82, 0.05) << name_of(variant);
    EXPECT_NEAR(warp_stress(law, 0.02, 0.02), is_biaxial(variant) ? 107 : 82, 0.5) << name_of(variant);
  }
}

TEST(WovenMaterialPoint, EnergyAndStressAreThePapersInAllFourBranches) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> strain(-0.1, 0.1), angle(-80 * kDegree, 80 * kDegree);
  for (const auto variant : kVariants) {
    for (auto law : all_sets(variant)) {
      if (variant == scene::Variant::Fabric)
        law.tables = {.warp = {{-0.2, -30}, {0, 0}, {0.03, 8}, {0.06, 40}},
                      .weft = {{-0.2, -20}, {-0.01, -2}, {0.02, 4}, {0.05, 30}},
                      .shear = {{0, 0}, {0.4, 0.03}, {0.9, 0.2}, {1.2, 1}}};
      for (int i = 0; i < 400; ++i) {
        const double la = 1 + strain(random), lb = 1 + strain(random), gamma = angle(random);
        mechanics::Matrix2 F;
        F << la, lb * std::sin(gamma), 0, lb * std::cos(gamma);
        const FabricPoint p = fabric::follow_path(law, {F}).front();
        const double W = woven_paper::compute_energy<double>(law, la * la, lb * lb, gamma);
        const Eigen::Matrix2d S = woven_paper::compute_stress(law, F.transpose() * F);
        const double tolerance = 1e-11 * (1 + S.cwiseAbs().maxCoeff());
        EXPECT_NEAR(p.W, W, 1e-12 * (1 + W)) << name_of(variant);
        EXPECT_NEAR(p.S11, S(0, 0), tolerance) << name_of(variant);
        EXPECT_NEAR(p.S22, S(1, 1), tolerance) << name_of(variant);
        EXPECT_NEAR(p.S12, S(0, 1), tolerance) << name_of(variant);
        EXPECT_NEAR(p.gamma, gamma, 1e-14);
      }
    }
  }
}

TEST(WovenMaterialPoint, EquibiaxialTensionLosesConvexityAtAbout2OverC) {
  scene::WovenLaw law = stiff(scene::Variant::Biaxial);
  law.strain_cap = scene::WovenLaw{}.strain_cap;  // none: the paper's law
  const double strain = find_root([&](double e) { return -stretch(law, e, e).smallest_eigenvalue; }, 0.01, 0.2);
  EXPECT_NEAR(strain, 2.08 / law.c.warp, 0.1 * 2.08 / law.c.warp);  // solver_fabric/THEORY.md: "~ 2.08/c"
}

}  // namespace
}  // namespace interply
