/// V11 of the steel sheet: rigid motion, constant strain and constant curvature on general meshes.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "support/metal_sheet.hpp"
#include "support/plate_meshes.hpp"
#include "support/results.hpp"

namespace interply::metal::test {
namespace {

using namespace interply::test;

constexpr double kSize = 8, kSide = 40;

class MetalPatch : public testing::TestWithParam<Pattern> {
 protected:
  TriangleMesh mesh = make_sheet_mesh(GetParam(), {-kSide / 2, kSide / 2}, {-kSide / 2, kSide / 2}, kSize);

  void expect_zero(const std::string& quantity, const std::string& source, double ours, const std::string& unit,
                   double tolerance) const {
    expect_result({.row = "V11",
                   .quantity = quantity,
                   .source = source,
                   .reference = 0,
                   .ours = ours,
                   .unit = unit,
                   .tolerance = tolerance,
                   .absolute = true,
                   .mesh = describe_mesh(kSize, GetParam())});
  }
};

/// Bound: round-off of the strain times E t h.
TEST_P(MetalPatch, RigidMotionGivesZeroForceInOneStepAndInMany) {
  for (const int steps : {1, 360}) {
    Sheet sheet(make_sheet(make_dc04()), mesh);
    NodalVectors x;
    for (int s = 1; s <= steps; ++s) {
      const double part = static_cast<double>(s) / steps;
      x = (Eigen::AngleAxisd(2.6 * part, Eigen::Vector3d(1, -2, 0.7).normalized()).toRotationMatrix() *
           mesh.reference.matrix())
              .array();
      x.colwise() += part * Eigen::Array3d(13, -57, 11);
      sheet.advance(x);
    }
    expect_zero("steel, largest nodal force after a rotation by 149 deg and a translation in " + std::to_string(steps) +
                    (steps == 1 ? " step" : " steps"),
                "rigid motion", sheet.force.abs().maxCoeff(), "N", 210e3 * kSize * 1e-13);
    EXPECT_NEAR(sheet.layer.internal_energy(), 0, 1e-12);
  }
}

TEST_P(MetalPatch, ConstantStrainIsExact) {
  Sheet sheet(make_sheet(make_elastic()), mesh);
  const double e = 1e-7;
  NodalVectors x = mesh.reference;
  x.row(0) = (1 + 3 * e) * mesh.reference.row(0) + 2 * e * mesh.reference.row(1);
  x.row(1) = (1 - e) * mesh.reference.row(1);
  sheet.advance(x);
  const double d = 210e3 / (1 - 0.09);
  const auto report = [&](const std::string& field, double exact) {
    double worst = exact;
    for (const double s : sheet.field(field))
      if (std::abs(s - exact) > std::abs(worst - exact)) worst = s;
    expect_result({.row = "V11",
                   .quantity = "steel, constant strain, " + field + " of the worst element",
                   .source = "Hooke's law, plane stress",
                   .reference = exact,
                   .ours = worst,
                   .unit = "MPa",
                   .tolerance = 2e-6,  // finite strain, 1e-7
                   .mesh = describe_mesh(kSize, GetParam())});
  };
  report("sigma_11", d * (3 - 0.3) * e);
  report("sigma_22", d * (-1 + 0.9) * e);
  report("sigma_12", 210e3 / 2.6 * 2 * e);
  for (const double t : sheet.field("thickness")) EXPECT_NEAR(t, 1 - 0.3 / 0.7 * 2 * e, 1e-3 * e);
}

TEST_P(MetalPatch, ConstantPlasticStrainLeavesInnerNodesInBalance) {
  Sheet sheet(make_sheet(make_dc04()), mesh);
  for (int s = 1; s <= 100; ++s) {
    const double a = s / 100.0;
    NodalVectors x = mesh.reference;
    x.row(0) = (1 + 0.2 * a) * mesh.reference.row(0) + 0.15 * a * mesh.reference.row(1);
    x.row(1) = -0.05 * a * mesh.reference.row(0) + (1 - 0.04 * a) * mesh.reference.row(1);
    sheet.advance(x);
  }
  double inner = 0;
  for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i)
    if (mesh.reference.col(i).head(2).abs().maxCoeff() < kSide / 2)
      inner = std::max(inner, sheet.force.col(i).abs().maxCoeff());
  expect_zero("steel, constant plastic strain of 0.2, largest force on an inner node over the largest at the edge",
              "patch test", inner / sheet.force.abs().maxCoeff(), "", 1e-9);
  const auto stress = sheet.field("von_mises");
  for (const double s : stress) EXPECT_NEAR(s, stress[0], 1e-9 * s);
}

INSTANTIATE_TEST_SUITE_P(Meshes, MetalPatch, testing::Values(Pattern::Alternating, Pattern::Unstructured), to_name);

}  // namespace
}  // namespace interply::metal::test
