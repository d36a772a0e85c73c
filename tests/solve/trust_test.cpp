#include "solve/trust.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solver_fabric/fabric_layer.hpp"
#include "solver_metal/metal_layer.hpp"

namespace {

using namespace interply;
using solve::TrustBook;

/// Eight triangles of 0.5 mm2.
mechanics::TriangleMesh make_square() { return mechanics::make_rectangle({0, 2}, {0, 2}, 1); }

Eigen::ArrayXXd inside(int n_limits) { return Eigen::ArrayXXd::Zero(n_limits, 8); }

TEST(TrustBook, SaysNothingInsideTheLimitsAndAtThem) {
  const auto mesh = make_square();
  TrustBook book({{"strain", "%", 5, "breaks"}}, mesh);
  book.note(1e-3, inside(1) + 5);
  EXPECT_TRUE(book.list_passed().empty());
  EXPECT_EQ(book.describe().values, std::vector<double>(8, 0.0));
}

TEST(TrustBook, KeepsThePeakOfTheRunWhereItWasAndWhenItBegan) {
  const auto mesh = make_square();
  TrustBook book({{"strain", "%", 5, "breaks"}, {"angle", "deg", 60, "locks"}}, mesh);
  Eigen::ArrayXXd q = inside(2);
  book.note(1e-3, q);
  q(1, 3) = 61;
  book.note(2e-3, q);
  q(1, 5) = 62, q(1, 6) = 70;
  book.note(3e-3, q);
  book.note(4e-3, inside(2));  // everything back inside
  const auto passed = book.list_passed();
  ASSERT_EQ(passed.size(), 1u);
  EXPECT_EQ(passed[0].quantity, "angle");
  EXPECT_EQ(passed[0].unit, "deg");
  EXPECT_EQ(passed[0].meaning, "locks");
  EXPECT_EQ(passed[0].limit, 60);
  EXPECT_EQ(passed[0].worst, 70);
  EXPECT_DOUBLE_EQ(passed[0].share, 3.0 / 8);
  EXPECT_EQ(passed[0].first_time, 2e-3);
  const auto corner = [&](int k) { return mechanics::at(mesh.reference, mesh.triangles(k, 6)); };
  EXPECT_NEAR(passed[0].x, (corner(0) + corner(1) + corner(2)).x() / 3, 1e-15);
  EXPECT_NEAR(passed[0].y, (corner(0) + corner(1) + corner(2)).y() / 3, 1e-15);
}

TEST(TrustBook, FieldIsOneBitPerLimitOfTheLastState) {
  const auto mesh = make_square();
  TrustBook book({{"strain", "%", 5, "breaks"}, {"angle", "deg", 60, "locks"}}, mesh);
  Eigen::ArrayXXd q = inside(2);
  q(0, 1) = 6, q(1, 2) = 61, q(0, 4) = 6, q(1, 4) = 61;
  book.note(0, q);
  const observe::Field field = book.describe();
  EXPECT_EQ(field.values, (std::vector<double>{0, 1, 2, 0, 3, 0, 0, 0}));
  EXPECT_FALSE(field.nodal);
  EXPECT_NE(field.description.find("1 where strain is beyond 5 %, 2 where angle is beyond 60 deg"), std::string::npos);
}

/// Quantities of a layer whose square is mapped by x = F X, in the order of its limits.
Eigen::ArrayXd compute_uniform(solve::LayerMechanics& layer, const mechanics::TriangleMesh& mesh,
                               const Eigen::Matrix2d& F) {
  mechanics::NodalVectors x = mesh.reference, force;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Eigen::Vector2d now = F * Eigen::Vector2d(mesh.reference(0, i), mesh.reference(1, i));
    x(0, i) = now.x(), x(1, i) = now.y();
  }
  layer.compute_internal_forces(x, {}, force);
  const Eigen::ArrayXXd q = layer.compute_trust_quantities(x);
  EXPECT_EQ(q.cols(), mesh.n_elements());
  EXPECT_EQ(q.rows(), static_cast<Eigen::Index>(layer.trust_limits().size()));
  EXPECT_LT((q.colwise() - q.col(0)).abs().maxCoeff(), 1e-9);
  return q.col(0);
}

TEST(TrustOfAPly, FibreStrainCompressionAndShearAreThoseOfItsFibres) {
  const auto mesh = make_square();
  scene::Layer layer{.name = "ply", .thickness = 1.2, .density = 6.19e-10, .law = scene::WovenLaw{}};
  fabric::FabricLayer ply(layer, 1, mesh);
  Eigen::Matrix2d F;
  F << 1.07, 0, 0, 0.98;
  Eigen::ArrayXd q = compute_uniform(ply, mesh, F);
  EXPECT_NEAR(q(0), 7, 1e-9);
  EXPECT_NEAR(q(1), 2, 1e-9);
  EXPECT_NEAR(q(2), 0, 1e-6);
  const double angle = 0.5;  // the weft turns towards the warp, both keep their length
  F << 1, std::sin(angle), 0, std::cos(angle);
  q = compute_uniform(ply, mesh, F);
  EXPECT_NEAR(q(0), 0, 1e-9);
  EXPECT_NEAR(q(2), angle * 180 / M_PI, 1e-9);
}

/// W = b [ea^2 exp(c eb) + eb^2 exp(c ea)] in equibiaxial tension e has the eigenvalue b exp(x) (2 - 4 x + x^2) with
/// x = c e across the diagonal: negative from x = 2 - sqrt 2 on.
TEST(TrustOfAPly, LossOfConvexityIsMinusTheSmallestEigenvalue) {
  const auto mesh = make_square();
  scene::WovenLaw law{.variant = scene::Variant::Biaxial, .a = {0, 0}, .b = {100, 100}, .c = {50, 50}};
  law.p_min = {0, 0};
  fabric::FabricLayer ply({.name = "ply", .thickness = 1.2, .density = 6.19e-10, .law = law}, 1, mesh);
  const auto quantity_at = [&](double e) {
    return compute_uniform(ply, mesh, (1 + e) * Eigen::Matrix2d::Identity())(3);
  };
  const double limit = (2 - std::sqrt(2.0)) / 50;
  EXPECT_LT(quantity_at(0), 0);
  EXPECT_LT(quantity_at(0.99 * limit), 0);
  EXPECT_GT(quantity_at(1.01 * limit), 0);
  EXPECT_NEAR(quantity_at(0.02), 100 * std::exp(1.0), 1e-9);
}

TEST(TrustOfASheet, ThinningFollowsFromConstantVolume) {
  const auto mesh = make_square();
  metal::MetalLayer sheet({.name = "sheet", .thickness = 1.0, .density = 7.85e-9, .law = scene::J2Law{}}, 7.85e-9,
                          mesh);
  Eigen::Matrix2d F = Eigen::Matrix2d::Identity();
  Eigen::ArrayXd q;
  for (int i = 1; i <= 100; ++i) {  // plane strain by a third: the thickness falls to 3/4, elastic strains apart
    F(0, 0) = 1 + i / 300.0;
    q = compute_uniform(sheet, mesh, F);
  }
  EXPECT_NEAR(q(0), 25, 0.3);
}

TEST(Trust, EveryLimitSaysWhatLiesBeyond) {
  const auto mesh = make_square();
  fabric::FabricLayer ply({.name = "ply", .thickness = 1.2, .density = 6.19e-10, .law = scene::WovenLaw{}}, 1, mesh);
  metal::MetalLayer sheet({.name = "sheet", .thickness = 1.0, .density = 7.85e-9, .law = scene::J2Law{}}, 7.85e-9,
                          mesh);
  const solve::LayerMechanics* const layers[] = {&ply, &sheet};
  for (const solve::LayerMechanics* layer : layers)
    for (const solve::TrustLimit& limit : layer->trust_limits()) {
      EXPECT_FALSE(limit.quantity.empty());
      EXPECT_FALSE(limit.unit.empty());
      EXPECT_FALSE(limit.meaning.empty());
    }
}

}  // namespace
