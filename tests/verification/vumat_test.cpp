/// Laws in Fortran (tests/support/vumat) against the built-in ones of the same equations: the interface loses nothing.
#include <sstream>

#include "launch/point.hpp"
#include "solver_fabric/fabric_layer.hpp"
#include "support/fabric_cases.hpp"
#include "support/metal_sheet.hpp"
#include "support/results.hpp"
#include "support/vumat_laws.hpp"

namespace interply {
namespace {

using mechanics::NodalVectors;

constexpr double kDt = 1e-9;  // short: the edges of the shell, driven by damping, stay where they are

double compare(const NodalVectors& own, const NodalVectors& built_in) {
  return (own - built_in).abs().maxCoeff() / built_in.abs().maxCoeff();
}

TEST(Vumat, WovenPlyInFortranEqualsTheBuiltInOne) {
  const auto mesh = fabric_cases::distort(mechanics::make_rectangle({-30, 30}, {-30, 30}, 6), 1);
  for (const auto variant : {scene::Variant::Uncoupled, scene::Variant::Full}) {
    const scene::WovenLaw law = fabric_cases::lopsided(variant);
    scene::Layer layer = fabric_cases::make_layer(law, 20);
    fabric::FabricLayer built_in(layer, 1, mesh);
    layer.law = test::make_woven_vumat(law);
    fabric::FabricLayer own(layer, 1, mesh);
    NodalVectors built_in_force, own_force;
    double largest = 0;
    for (int i = 1; i <= 50; ++i) {
      const double t = 0.1 * i;
      NodalVectors x = mesh.reference;
      x.row(0) += 0.03 * std::sin(t) * mesh.reference.row(0) + 0.2 * std::sin(0.7 * t) * mesh.reference.row(1);
      x.row(1) += 0.02 * std::sin(1.9 * t) * mesh.reference.row(1);
      x.row(2) += 2e-3 * std::sin(t) * mesh.reference.row(0) * mesh.reference.row(1);
      built_in.compute_internal_forces(x, {.time = i * kDt, .dt = kDt}, built_in_force);
      own.compute_internal_forces(x, {.time = i * kDt, .dt = kDt}, own_force);
      largest = std::max(largest, compare(own_force, built_in_force));
    }
    test::expect_result({.row = "V1",
                         .quantity = "force of a woven ply (" + fabric_cases::name_of(variant) +
                                     ") as a VUMAT, relative difference from the built-in law",
                         .source = "same equations, other code",
                         .reference = 0,
                         .ours = largest,
                         .unit = "",
                         .tolerance = 1e-10,
                         .absolute = true,
                         .mesh = "6 mm, distorted, 50 steps"});
  }
}

/// The same steel in the plane: a VUMAT as membrane in the fabric solver, the built-in law in the metal solver.
TEST(Vumat, J2InFortranAsAMembraneEqualsTheBuiltInSheet) {
  const auto mesh = metal::test::make_distorted_square(20, 4, 0.15);
  scene::Layer layer = metal::test::make_sheet(metal::test::make_dc04(), 1);
  metal::test::Sheet built_in(layer, mesh);
  layer.law = test::make_j2_vumat(metal::test::make_dc04(), scene::Integration::Membrane);
  layer.bending = {0, 0};
  layer.twist = 0;
  fabric::FabricLayer own(layer, 1, mesh);
  NodalVectors own_force;
  double largest = 0;
  for (int i = 1; i <= 100; ++i) {
    const double t = 0.02 * i;
    NodalVectors x = mesh.reference;
    x.row(0) += 0.15 * std::sin(t) * mesh.reference.row(0) + 0.05 * t * mesh.reference.row(1);
    x.row(1) -= 0.04 * t * mesh.reference.row(1) + 1e-3 * t * mesh.reference.row(0).square();
    built_in.advance(x, kDt);
    own.compute_internal_forces(x, {.time = i * kDt, .dt = kDt}, own_force);
    largest = std::max(largest, compare(own_force, built_in.force));
  }
  test::expect_result({.row = "V9",
                       .quantity = "force of a steel membrane with J2 as a VUMAT, relative difference",
                       .source = "same equations, other code, other solver",
                       .reference = 0,
                       .ours = largest,
                       .unit = "",
                       .tolerance = 1e-9,
                       .absolute = true,
                       .mesh = "4 mm, distorted, 100 steps to 15 %"});
  EXPECT_NEAR(own.compute_nodal_thickness().minCoeff(), built_in.layer.compute_nodal_thickness().minCoeff(), 1e-9);
}

std::vector<double> last_row(const std::string& csv) {
  const auto end = csv.find_last_not_of('\n'), begin = csv.rfind('\n', end) + 1;
  std::istringstream cells(csv.substr(begin, end - begin + 1));
  std::vector<double> values;
  for (std::string cell; std::getline(cells, cell, ',');) values.push_back(std::stod(cell));
  return values;
}

TEST(Vumat, PointFollowsAPathLikeTheBuiltInLaw) {
  const std::string path = "F11,F12,F21,F22\n1.02,0.1,0.1,0.99\n1.03,0.2,0.2,1.01\n";  // symmetric: F = U
  const scene::WovenLaw law = fabric_cases::lopsided();
  const auto built_in = last_row(launch::follow_path(law, path, "path.csv"));
  const std::string csv = launch::follow_path(test::make_woven_vumat(law), path, "path.csv");
  EXPECT_TRUE(csv.starts_with("F11,F12,F21,F22,F33,sigma11_MPa,sigma22_MPa,sigma12_MPa,state_1\n"));
  const auto own = last_row(csv);
  mechanics::Matrix2 u, s;
  u << 1.03, 0.2, 0.2, 1.01;
  s << built_in[8], built_in[10], built_in[10], built_in[9];
  const mechanics::Matrix2 sigma = u * s * u / u.determinant();
  EXPECT_NEAR(own[4], 1, 0);
  EXPECT_NEAR(own[5], sigma(0, 0), 1e-10 * sigma.norm());
  EXPECT_NEAR(own[6], sigma(1, 1), 1e-10 * sigma.norm());
  EXPECT_NEAR(own[7], sigma(0, 1), 1e-10 * sigma.norm());
  EXPECT_NEAR(own[8], built_in[6], 1e-12);
}

}  // namespace
}  // namespace interply
