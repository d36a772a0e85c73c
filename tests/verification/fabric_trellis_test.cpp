/// V6, first half: trellis shear of an aligned mesh (fabric_locking_test.cpp: of meshes turned against the fibres).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "solver_fabric/fabric_layer.hpp"
#include "support/fabric_cases.hpp"
#include "support/results.hpp"

namespace interply {
namespace {

using namespace fabric_cases;
using mechanics::NodalVectors;

std::vector<double> get_field(const fabric::FabricLayer& layer, const NodalVectors& x, const std::string& name) {
  for (const auto& f : layer.compute_fields(x))
    if (f.name == name) return f.values;
  throw std::invalid_argument(name);
}

double compute_largest_fibre_strain(const fabric::FabricLayer& layer, const NodalVectors& x) {
  double largest = 0;
  for (const char* name : {"stretch_warp", "stretch_weft"})
    for (const double l : get_field(layer, x, name)) largest = std::max(largest, std::abs(l - 1));
  return largest;
}

TEST(TrellisShear, AlignedMeshKeepsItsFibreLengthTo60Degrees) {
  const auto mesh = mechanics::make_rectangle({-20, 20}, {0, 40}, 4);
  fabric::FabricLayer layer(make_layer(soft()), 1, mesh);
  NodalVectors force;
  for (const double degrees : {-60.0, -20.0, 10.0, 30.0, 60.0}) {
    const NodalVectors x = map_in_plane(mesh, trellis(degrees * kDegree));
    layer.compute_internal_forces(x, {}, force);
    if (degrees > 0)
      test::expect_result({.row = "V6",
                           .quantity = fmt::format("largest fibre strain in trellis shear, aligned, {} deg", degrees),
                           .source = "inextensible fibres",
                           .reference = 0,
                           .ours = compute_largest_fibre_strain(layer, x),
                           .tolerance = 1e-12,
                           .absolute = true,
                           .mesh = "4 mm"});
    EXPECT_LT(compute_largest_fibre_strain(layer, x), 1e-12);
    for (const double gamma : get_field(layer, x, "shear_angle")) EXPECT_NEAR(gamma, degrees * kDegree, 1e-12);
  }
}

TEST(TrellisShear, AlignedMeshFollowsAShearThatVariesFromCellToCellWithoutFibreStrain) {
  const int n = 10;
  const double h = 4;
  const auto mesh = mechanics::make_rectangle({0, n * h}, {0, n * h}, h);
  NodalVectors x = mesh.reference;
  // every column of cells turns its warp edges, every row its weft edges: gamma = 3 (i + j + 1) deg, up to 57
  Eigen::Array2Xd along(2, n + 1), across(2, n + 1);
  along.col(0).setZero();
  across.col(0).setZero();
  for (int i = 0; i < n; ++i) {
    const double turn = 3 * (i + 0.5) * kDegree;
    along.col(i + 1) = along.col(i) + h * Eigen::Array2d(std::cos(turn), std::sin(turn));
    across.col(i + 1) = across.col(i) + h * Eigen::Array2d(std::sin(turn), std::cos(turn));
  }
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) x.col(j * (n + 1) + i).head(2) = along.col(i) + across.col(j);
  fabric::FabricLayer layer(make_layer(soft()), 1, mesh);
  NodalVectors force;
  layer.compute_internal_forces(x, {}, force);
  EXPECT_LT(compute_largest_fibre_strain(layer, x), 1e-12);
  const auto gammas = get_field(layer, x, "shear_angle");
  EXPECT_NEAR(*std::max_element(gammas.begin(), gammas.end()), 57 * kDegree, 1e-12);
}

}  // namespace
}  // namespace interply
