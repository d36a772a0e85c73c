/// The DC04 bar, by the material point and by a strip of shell elements.
#include <gtest/gtest.h>

#include <cmath>

#include "solver_metal/material_point.hpp"
#include "support/metal_sheet.hpp"
#include "support/plate_meshes.hpp"
#include "support/results.hpp"

namespace interply::metal::test {
namespace {

using namespace interply::test;

std::vector<double> make_strains(double end, int n) {
  std::vector<double> strain;
  for (int i = 1; i <= n; ++i) strain.push_back(end * i / n);
  return strain;
}

/// Nominal stress: force per initial section.
double compute_nominal(const MetalPoint& p) { return p.stress * std::exp(p.width_strain + p.thickness_strain); }

/// Considere: the nominal stress is largest where d sigma/de = sigma, for Swift at the plastic strain n - e0.
constexpr double kUniform = 0.23 - 0.0065;
const double kStrength = 530 * std::pow(0.23, 0.23) * std::exp(-kUniform);

void expect_considere(double uniform, double strength, const std::string& mesh) {
  expect_result({.row = "V9",
                 .quantity = "DC04, uniform plastic strain",
                 .source = "Considere, n - e0",
                 .reference = kUniform,
                 .ours = uniform,
                 .mesh = mesh});
  expect_result({.row = "V9",
                 .quantity = "DC04, tensile strength R_m",
                 .source = "Considere, K n^n exp(-(n - e0))",
                 .reference = kStrength,
                 .ours = strength,
                 .unit = "MPa",
                 .tolerance = 2e-3,
                 .mesh = mesh});
}

TEST(Dc04Bar, YieldsAt166MPa) {
  const double closed = 530 * std::pow(0.0065, 0.23);
  expect_result({.row = "V9",
                 .quantity = "DC04, initial yield stress",
                 .source = "DC04 of EN 10130, 166 MPa",
                 .reference = 166,
                 .ours = closed,
                 .unit = "MPa",
                 .tolerance = 3e-3,
                 .mesh = "closed form, K e0^n"});
  const double e = closed / 210e3;
  const auto path = follow_uniaxial_path(make_dc04(), {0.999 * e, 1.01 * e});
  EXPECT_EQ(path[0].plastic_strain, 0);
  EXPECT_GT(path[1].plastic_strain, 0);
  expect_result({.row = "V9",
                 .quantity = "DC04, stress just beyond yield",
                 .source = "K e0^n",
                 .reference = closed,
                 .ours = path[1].stress,
                 .unit = "MPa",
                 .tolerance = 1e-3,
                 .mesh = "material point"});
}

/// Elasticity moves the point by sigma/E = 0.0018 in total strain.
TEST(Dc04Bar, CarriesItsLargestNominalStressAtTheConsiderePoint) {
  const auto path = follow_uniaxial_path(make_dc04(), make_strains(0.3, 3000));
  const auto best = std::max_element(path.begin(), path.end(), [](const MetalPoint& a, const MetalPoint& b) {
    return compute_nominal(a) < compute_nominal(b);
  });
  expect_considere(best->plastic_strain, compute_nominal(*best), "material point");
  // without elasticity, exactly
  const auto rigid = follow_uniaxial_path({2.1e10, 0.3, scene::Swift{}}, {kUniform - 1e-3, kUniform, kUniform + 1e-3});
  EXPECT_NEAR(compute_nominal(rigid[1]), kStrength, 1e-5 * kStrength);
  EXPECT_GT(compute_nominal(rigid[1]), compute_nominal(rigid[0]));
  EXPECT_GT(compute_nominal(rigid[1]), compute_nominal(rigid[2]));
}

class PulledStrip : public testing::TestWithParam<Pattern> {
 protected:
  TriangleMesh mesh = make_sheet_mesh(GetParam(), {0, 40}, {0, 12}, 4);
  Sheet sheet{make_sheet(make_dc04(), 5, 0.8), mesh};

  /// Mean nominal stress across the end x = 40.
  double pull(double strain, double width) {
    NodalVectors x = mesh.reference;
    x.row(0) *= std::exp(strain);
    x.row(1) *= std::exp(width);
    sheet.advance(x);
    double force = 0;
    for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i)
      if (mesh.reference(0, i) == 40) force += sheet.force(0, i);
    return force / (12 * 0.8);
  }
};

TEST_P(PulledStrip, FollowsTheMaterialPointToItsUniformStrain) {
  double best = 0, at = 0;
  for (const MetalPoint& p : follow_uniaxial_path(make_dc04(), make_strains(0.3, 600))) {
    const double nominal = pull(p.strain, p.width_strain);
    EXPECT_NEAR(nominal, compute_nominal(p), 1e-4 * compute_nominal(p)) << p.strain;
    EXPECT_NEAR(sheet.field("thickness")[0], 0.8 * std::exp(p.thickness_strain), 1e-5);
    double sideways = 0;  // no force across the strip
    for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i)
      if (mesh.reference(1, i) == 0) sideways += sheet.force(1, i);
    EXPECT_LT(std::abs(sideways) / (40 * 0.8), 0.05);
    if (nominal > best) {
      best = nominal;
      at = sheet.field("plastic_strain")[0];
    }
  }
  expect_considere(at, best, describe_mesh(4, GetParam()));
}

TEST_P(PulledStrip, PlaneStrainNeeds2OverSqrt3OfTheUniaxialStress) {
  double nominal = 0;
  for (int i = 1; i <= 200; ++i) nominal = pull(0.1 * i / 200, 0);
  const double p = sheet.field("plastic_strain")[0], thickness = sheet.field("thickness")[0] / 0.8;
  EXPECT_NEAR(p, 2 / std::sqrt(3.0) * 0.1, 3e-3);  // less the elastic strain
  expect_result({.row = "V9",
                 .quantity = "DC04, stress in plane strain tension at 0.1",
                 .source = "2/sqrt(3) K (e0 + p)^n",
                 .reference = 2 / std::sqrt(3.0) * 530 * std::pow(0.0065 + p, 0.23),
                 .ours = nominal / thickness,
                 .unit = "MPa",
                 .tolerance = 1e-3,
                 .mesh = describe_mesh(4, GetParam())});
  EXPECT_NEAR(sheet.field("sigma_22")[0] / sheet.field("sigma_11")[0], 0.5, 5e-3);
}

INSTANTIATE_TEST_SUITE_P(Meshes, PulledStrip, testing::Values(Pattern::Alternating, Pattern::Unstructured), to_name);

}  // namespace
}  // namespace interply::metal::test
