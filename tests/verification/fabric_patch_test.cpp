/// V11: rigid motions and constant strain of a ply, and the balance of its forces.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "solver_fabric/fabric_layer.hpp"
#include "solver_fabric/material_point.hpp"
#include "support/fabric_cases.hpp"
#include "support/results.hpp"

namespace interply {
namespace {

using namespace fabric_cases;
using mechanics::NodalVectors;

mechanics::TriangleMesh distorted_mesh() { return distort(mechanics::make_rectangle({-30, 30}, {0, 40}, 10), 2.5); }

NodalVectors move(const NodalVectors& x, const Eigen::Matrix3d& R, const Eigen::Vector3d& shift) {
  NodalVectors y = (R * x.matrix()).array();
  y.colwise() += shift.array();
  return y;
}

class FabricPatch : public testing::TestWithParam<scene::Variant> {};
INSTANTIATE_TEST_SUITE_P(Variants, FabricPatch, testing::ValuesIn(kVariants),
                         [](const auto& info) { return name_of(info.param); });

void expect_zero(const char* quantity, scene::Variant variant, const char* source, double largest, const char* unit,
                 double tolerance) {
  test::expect_result({.row = "V11",
                       .quantity = fmt::format("ply, {}, {}", quantity, name_of(variant)),
                       .source = source,
                       .reference = 0,
                       .ours = largest,
                       .unit = unit,
                       .tolerance = tolerance,
                       .absolute = true,
                       .mesh = "10 mm, nodes moved by up to 2.5 mm"});
}

TEST_P(FabricPatch, RigidRotationAndTranslationGiveZeroForce) {
  const auto mesh = distorted_mesh();
  fabric::FabricLayer layer(make_layer(lopsided(GetParam()), 31), 1, mesh);
  NodalVectors force;
  double largest = 0;
  for (const double angle : {0.0, 0.4, 2.0, 3.1}) {
    layer.compute_internal_forces(move(mesh.reference, slanted_rotation(angle), {120, -40, 33}), {}, force);
    largest = std::max(largest, force.abs().maxCoeff());
    // the energy of a table is a difference of integrals of the size of d, so it has their round-off
    EXPECT_LT(std::abs(layer.internal_energy()),
              GetParam() == scene::Variant::Fabric ? 1e-15 * 140 * 2 * 60 * 40 * 1.2 : 1e-20);
  }
  // a strain of round-off (coordinates of 150 mm over sides of 10 mm) x stiffness 2 d x section of a side
  expect_zero("largest force after rigid rotation and translation", GetParam(), "rigid motion", largest, "N",
              1e-15 * 15 * 280 * 1.2 * 10);
}

TEST_P(FabricPatch, ConstantStrainOfADistortedMeshIsExactAndInEquilibriumInside) {
  const auto mesh = distorted_mesh();
  const auto law = lopsided(GetParam());
  const double turn = 31 * kDegree;
  fabric::FabricLayer layer(make_layer(law, 31), 1, mesh);
  mechanics::Matrix2 F;  // in x, y
  F << 1.03, 0.25, 0.1, 0.98;
  const Eigen::Matrix2d fibres = Eigen::Rotation2Dd(turn).toRotationMatrix();
  const mechanics::Matrix2 in_fibre_frame = F * fibres;
  const fabric::FabricPoint w = fabric::evaluate_point(fabric::make_membrane_law(law), in_fibre_frame);
  NodalVectors force;
  const NodalVectors x = move(map_in_plane(mesh, F), slanted_rotation(1.1), {5, 6, 7});
  layer.compute_internal_forces(x, {}, force);
  const auto fields = layer.compute_fields(x);
  double stress_error = 0;
  for (std::size_t e = 0; e < static_cast<std::size_t>(mesh.n_elements()); ++e) {
    stress_error = std::max({stress_error, std::abs(fields[3].values[e] - w.S11), std::abs(fields[4].values[e] - w.S22),
                             std::abs(fields[5].values[e] - w.S12)});
    EXPECT_NEAR(fields[6].values[e], w.W, 1e-11);
  }
  expect_zero("constant strain, largest error of a stress", GetParam(), "stress of the material point", stress_error,
              "MPa", 1e-10);
  EXPECT_NEAR(layer.internal_energy(), 1.2 * w.W * mechanics::compute_areas(mesh).sum(), 1e-9);
  // a node is inside if the triangles around it close
  const auto neighbours = mesh.neighbours;
  std::vector<bool> inside(static_cast<std::size_t>(mesh.n_nodes()), true);
  for (Eigen::Index e = 0; e < mesh.n_elements(); ++e)
    for (int k = 0; k < 3; ++k)
      if (neighbours(k, e) < 0)
        inside[static_cast<std::size_t>(mesh.triangles((k + 1) % 3, e))] =
            inside[static_cast<std::size_t>(mesh.triangles((k + 2) % 3, e))] = false;
  int count = 0;
  double out_of_balance = 0;
  for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i)
    if (inside[static_cast<std::size_t>(i)]) {
      ++count;
      out_of_balance = std::max(out_of_balance, force.col(i).abs().maxCoeff());
    }
  expect_zero("constant strain, largest force on an inner node", GetParam(), "equilibrium", out_of_balance, "N", 1e-9);
  EXPECT_GT(count, 5);
  EXPECT_GT(force.abs().maxCoeff(), 1);  // the edge carries the stress
}

TEST_P(FabricPatch, InternalForcesBalanceInForceAndMoment) {
  const auto mesh = distorted_mesh();
  fabric::FabricLayer layer(make_layer(lopsided(GetParam()), 31), 1, mesh);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> move_by(-0.8, 0.8);
  NodalVectors x = mesh.reference, force;
  for (Eigen::Index i = 0; i < x.size(); ++i) x(i) += move_by(random);
  layer.compute_internal_forces(x, {}, force);
  const double scale = force.abs().maxCoeff();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    sum += mechanics::at(force, i);
    moment += mechanics::at(x, i).cross(mechanics::at(force, i));
  }
  EXPECT_GT(scale, 1);
  EXPECT_LT(sum.norm(), 1e-12 * scale);
  EXPECT_LT(moment.norm(), 1e-12 * scale * 40);
}

}  // namespace
}  // namespace interply
