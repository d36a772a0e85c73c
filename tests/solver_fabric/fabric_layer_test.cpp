#include "solver_fabric/fabric_layer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/fabric_cases.hpp"

namespace interply {
namespace {

using namespace fabric_cases;
using fabric::FabricLayer;
using mechanics::NodalVectors;
using mechanics::Vector3;
using testing::AllOf;
using testing::HasSubstr;

/// Wavy, stretched and sheared at random: every branch of the law and bending take part.
NodalVectors wavy(const mechanics::TriangleMesh& mesh, double amount, unsigned seed = 7) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> move(-amount, amount);
  NodalVectors x = mesh.reference;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    x(2, i) += 2 * std::sin(0.15 * x(0, i)) * std::cos(0.1 * x(1, i));
    for (int c = 0; c < 3; ++c) x(c, i) += move(random);
  }
  return x;
}

NodalVectors compute_forces(FabricLayer& layer, const NodalVectors& x) {
  NodalVectors force;
  layer.compute_internal_forces(x, {}, force);
  return force;
}

/// dE/dx of one coordinate by differences.
double differentiate_energy(FabricLayer& layer, NodalVectors x, int component, Eigen::Index node) {
  NodalVectors force;
  const double at = x(component, node);
  return differentiate(
      [&](double value) {
        x(component, node) = value;
        layer.compute_internal_forces(x, {}, force);
        return layer.internal_energy();
      },
      at, 2e-4);
}

/// Largest difference between a force and the derivative of the energy over the given components.
double find_largest_force_error(FabricLayer& layer, const NodalVectors& x, std::initializer_list<int> components) {
  const NodalVectors force = compute_forces(layer, x);
  double largest = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    for (const int c : components)
      largest = std::max(largest, std::abs(differentiate_energy(layer, x, c, i) - force(c, i)));
  return largest / force.abs().maxCoeff();
}

TEST(FabricLayer, ForceIsTheDerivativeOfTheEnergyOfMembraneAndBending) {
  const auto mesh = distort(mechanics::make_rectangle({-20, 20}, {0, 30}, 10), 2);
  for (const auto variant : {scene::Variant::Uncoupled, scene::Variant::Full, scene::Variant::Biaxial}) {
    FabricLayer layer(make_layer(lopsided(variant), 20), 1, mesh);
    EXPECT_LT(find_largest_force_error(layer, wavy(mesh, 0.5), {0, 1, 2}), 1e-7) << name_of(variant);
  }
}

TEST(FabricLayer, ForceOfBendingAloneIsTheDerivativeOfItsEnergy) {
  const auto mesh = distort(mechanics::make_rectangle({-20, 20}, {0, 30}, 10), 2);
  scene::WovenLaw none;
  none.variant = scene::Variant::Uncoupled;
  none.a = none.b = none.d = {1e-9, 1e-9};
  none.s = {1e-9, 0, 0};
  FabricLayer layer(make_layer(none, 20), 1, mesh);
  EXPECT_LT(find_largest_force_error(layer, wavy(mesh, 0.5), {0, 1, 2}), 1e-8);
}

TEST(FabricLayer, ForceAtASymmetryEdgeIsTheDerivativeOfTheHalfModelsEnergy) {
  const auto mesh = distort(mechanics::make_rectangle({-20, 20}, {0, 30}, 10, 0, true), 2);
  FabricLayer layer(make_layer(lopsided()), 1, mesh);
  NodalVectors x = wavy(mesh, 0.5);
  for (const int i : mesh.symmetry_nodes) x(1, i) = 0;
  EXPECT_LT(find_largest_force_error(layer, x, {0, 1, 2}), 1e-7);
}

TEST(FabricLayer, SwappingParametersAndTurningTheFibresBy90DegreesChangesNothing) {
  const auto mesh = distort(mechanics::make_rectangle({-20, 20}, {0, 30}, 10), 2);
  for (const auto variant : kVariants) {
    const auto law = lopsided(variant);
    auto swapped = law;
    for (auto member :
         {&scene::WovenLaw::a, &scene::WovenLaw::b, &scene::WovenLaw::c, &scene::WovenLaw::p_min, &scene::WovenLaw::d,
          &scene::WovenLaw::s_T, &scene::WovenLaw::s_C, &scene::WovenLaw::strain_cap})
      std::swap((swapped.*member).warp, (swapped.*member).weft);
    auto turned = make_layer(swapped, 110);
    std::swap(turned.bending.warp, turned.bending.weft);
    FabricLayer layer(make_layer(law, 20), 1, mesh), other(turned, 1, mesh);
    const NodalVectors x = wavy(mesh, 0.5), f = compute_forces(layer, x), g = compute_forces(other, x);
    EXPECT_LT((f - g).abs().maxCoeff(), 1e-11 * f.abs().maxCoeff()) << name_of(variant);
    EXPECT_NEAR(layer.internal_energy(), other.internal_energy(), 1e-12 * layer.internal_energy());
    const double increment = layer.compute_stable_increment(x);
    EXPECT_NEAR(increment, other.compute_stable_increment(x), 1e-10 * increment);
  }
}

TEST(FabricLayer, MirroredSheetBehavesAsItsMirrorImage) {
  const auto mesh = mechanics::make_rectangle({-20, 20}, {-20, 20}, 10);
  // reflection x -> -x of the mesh, corners reordered to stay counter-clockwise
  auto image = mesh;
  image.reference.row(0) *= -1;
  image.triangles.row(1).swap(image.triangles.row(2));
  image.neighbours.row(1).swap(image.neighbours.row(2));
  FabricLayer layer(make_layer(lopsided(), 20), 1, mesh), mirror(make_layer(lopsided(), -20), 1, image);
  NodalVectors x = wavy(mesh, 0.5), y = x;
  y.row(0) *= -1;
  NodalVectors f = compute_forces(layer, x), g = compute_forces(mirror, y);
  g.row(0) *= -1;
  EXPECT_LT((f - g).abs().maxCoeff(), 1e-11 * f.abs().maxCoeff());
  const auto gamma = layer.compute_fields(x)[0].values, gamma_image = mirror.compute_fields(y)[0].values;
  for (std::size_t e = 0; e < gamma.size(); ++e) EXPECT_NEAR(gamma[e], -gamma_image[e], 1e-13);
}

/// Bending energy of the surface z(x, y) per area (membrane energy subtracted), and its value on a mesh without edges,
/// where the missing sides of the patches lose some: the loss halves with the mesh size.
double compute_bending_energy_density(const scene::Layer& ply, const std::function<double(double, double)>& z) {
  const auto compute = [&](double h) {
    const auto mesh = mechanics::make_rectangle({-20, 20}, {-20, 20}, h);
    NodalVectors x = mesh.reference;
    for (Eigen::Index i = 0; i < x.cols(); ++i) x(2, i) = z(x(0, i), x(1, i));
    auto without = ply;
    without.bending = {0, 0};
    without.twist = 0;
    FabricLayer bent(ply, 1, mesh), membrane(without, 1, mesh);
    compute_forces(bent, x);
    compute_forces(membrane, x);
    return (bent.internal_energy() - membrane.internal_energy()) / 1600;
  };
  return 2 * compute(1) - compute(2);
}

TEST(FabricLayer, BendingAlongEachFibreStoresHalfItsStiffnessTimesCurvatureSquared) {
  const double k = 1e-3;
  const auto along_x = [&](double x, double) { return k * x * x / 2; };
  for (const auto& [orientation, stiffness] : {std::pair{0.0, 2.2}, std::pair{90.0, 1.4}}) {
    const double expected = stiffness * k * k / 2;
    EXPECT_NEAR(compute_bending_energy_density(make_layer(soft(), orientation), along_x), expected, 0.01 * expected);
  }
}

/// The nodes held in a twisted shape until the edges are at rest, on alternating diagonals. The sheet is linear, so
/// half the final forces times the way is its energy; the second difference over the size of the sheet leaves the
/// interior.
TEST(FabricLayer, TwistStoresTwiceTheTwistStiffnessTimesItsSquare) {
  auto ply = make_layer(soft());
  const double k = 1e-6;
  const auto compute_energy = [&](double side) {
    const auto mesh = mechanics::make_rectangle({-side / 2, side / 2}, {-side / 2, side / 2}, 4);
    NodalVectors x = mesh.reference, force;
    x.row(2) = k * x.row(0) * x.row(1);
    FabricLayer layer(ply, 1, mesh);
    const double dt = 0.9 * layer.compute_stable_increment(mesh.reference);
    layer.compute_internal_forces(x, {}, force);
    for (int i = 0; i < 3000; ++i) layer.compute_internal_forces(x, {.dt = dt}, force);
    return 0.5 * (force.row(2) * x.row(2)).sum();
  };
  const double expected = 2 * ply.twist * k * k * 40 * 40;  // (2 m12 kappa12)/2 with m12 = twist 2 kappa12
  const double found = 0.5 * (compute_energy(120) - 2 * compute_energy(80) + compute_energy(40));
  EXPECT_NEAR(found, expected, 2e-3 * expected);
}

TEST(FabricLayer, AnyNumberOfThreadsGivesTheSameBits) {
  const auto mesh = mechanics::make_rectangle({-60, 60}, {0, 60}, 3);  // 1600 elements, 7 blocks
  const NodalVectors x = wavy(mesh, 0.2);
  auto ply = make_layer(lopsided(), 20);
  FabricLayer one(ply, 1, mesh);
  const NodalVectors force = compute_forces(one, x);
  const double increment = one.compute_stable_increment(x);
  for (const int threads : {2, 3, 8}) {
    ply.threads = threads;
    FabricLayer many(ply, 1, mesh);
    for (int repeat = 0; repeat < 5; ++repeat) {
      const NodalVectors other = compute_forces(many, x);
      EXPECT_TRUE((force == other).all());
      EXPECT_EQ(one.internal_energy(), many.internal_energy());
      EXPECT_EQ(increment, many.compute_stable_increment(x));
    }
  }
}

std::string catch_divergence(FabricLayer& layer, const NodalVectors& x) {
  NodalVectors force;
  try {
    layer.compute_internal_forces(x, {.time = 1.25e-3}, force);
  } catch (const mechanics::Divergence& e) {
    return e.what();
  }
  return "no divergence";
}

TEST(FabricLayer, NaNPositionNamesLayerElementTimeQuantityAndCure) {
  const auto mesh = mechanics::make_rectangle({0, 20}, {0, 20}, 10);
  FabricLayer layer(make_layer(soft()), 1, mesh);
  NodalVectors x = mesh.reference;
  x(1, 8) = std::numeric_limits<double>::quiet_NaN();  // corner of the last cell
  Eigen::Index first = 0;
  while ((mesh.triangles.col(first) != 8).all()) ++first;
  EXPECT_THAT(catch_divergence(layer, x),
              AllOf(HasSubstr("layer ply_2"), HasSubstr("element " + std::to_string(first) + " "),
                    HasSubstr("t = 0.00125 s"), HasSubstr("nan"), HasSubstr("lower time.safety")));
}

TEST(FabricLayer, FoldedElementsNameShearAngleOrAreaAndWhereTheyAre) {
  const auto mesh = mechanics::make_rectangle({0, 20}, {0, 20}, 10);
  FabricLayer layer(make_layer(soft()), 1, mesh);
  EXPECT_THAT(catch_divergence(layer, map_in_plane(mesh, trellis(86 * kDegree))),
              AllOf(HasSubstr("element 0 centred at ("), HasSubstr("shear angle is 86 deg"), HasSubstr("85 deg"),
                    HasSubstr("refine the mesh")));
  EXPECT_EQ(catch_divergence(layer, map_in_plane(mesh, trellis(84 * kDegree))), "no divergence");
  mechanics::Matrix2 flat;
  flat << 0.19, 0, 0, 0.1;
  EXPECT_THAT(catch_divergence(layer, map_in_plane(mesh, flat)),
              AllOf(HasSubstr("area ratio is 0.019"), HasSubstr("0.02")));
}

TEST(FabricLayer, OverflowingEnergyNamesTheBiaxialCoupling) {
  const auto mesh = mechanics::make_rectangle({0, 20}, {0, 20}, 10);
  FabricLayer layer(make_layer(soft()), 1, mesh);
  mechanics::Matrix2 burst;
  burst << 40, 0, 0, 40;
  EXPECT_THAT(catch_divergence(layer, map_in_plane(mesh, burst)),
              AllOf(HasSubstr("strain energy"), HasSubstr("strain_cap")));
}

TEST(FabricLayer, FirstFailedElementIsNamedForAnyNumberOfThreads) {
  const auto mesh = mechanics::make_rectangle({-60, 60}, {0, 60}, 3);
  NodalVectors x = mesh.reference;
  for (const Eigen::Index i : {300, 500, 800}) x(0, i) = std::numeric_limits<double>::quiet_NaN();
  auto ply = make_layer(soft());
  FabricLayer one(ply, 1, mesh);
  ply.threads = 3;
  FabricLayer three(ply, 1, mesh);
  EXPECT_EQ(catch_divergence(one, x), catch_divergence(three, x));
}

TEST(FabricLayer, FieldsAndSummaryReportTheState) {
  const auto mesh = mechanics::make_rectangle({0, 20}, {0, 20}, 10);
  FabricLayer layer(make_layer(lopsided()), 1, mesh);
  mechanics::Matrix2 F;
  F << 1.08, 0, 0, 0.97;  // warp beyond the weft's cap of 0.07, but the weft is compressed
  NodalVectors x = map_in_plane(mesh, F);
  compute_forces(layer, x);
  auto fields = layer.compute_fields(x);
  const std::vector<std::string> names{"shear_angle",
                                       "stretch_warp",
                                       "stretch_weft",
                                       "S11",
                                       "S22",
                                       "S12",
                                       "energy_density",
                                       "beyond_cap",
                                       "smallest_hessian_eigenvalue",
                                       "warp",
                                       "weft"};
  ASSERT_EQ(fields.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(fields[i].name, names[i]);
    EXPECT_EQ(fields[i].values.size(), static_cast<std::size_t>(mesh.n_elements() * fields[i].components));
    EXPECT_EQ(fields[i].components, i < 9 ? 1 : 3);
  }
  EXPECT_NEAR(fields[1].values[0], 1.08, 1e-14);
  EXPECT_NEAR(fields[2].values[0], 0.97, 1e-14);
  EXPECT_EQ(fields[7].values[0], 0);
  F << 1.08, 0, 0, 1.01;
  x = map_in_plane(mesh, F);
  compute_forces(layer, x);
  EXPECT_EQ(layer.compute_fields(x)[7].values[0], 1);
  const auto summary = layer.summarise(x);
  EXPECT_EQ(summary[0].name, "shear angle up to");
  EXPECT_NEAR(summary[0].value, 0, 1e-12);
  EXPECT_NEAR(summary[1].value, 8, 1e-12);
  EXPECT_NEAR(summary[2].value, 1, 1e-12);
  EXPECT_EQ(summary[3].value, 100);
}

/// The weft, at rest 90 degrees counter-clockwise from the warp, is turned towards it by 0.2 rad and leaves it again by
/// 0.3 rad; the sheet is turned and tilted as a whole. Fibres are where the motion takes them, and the shear angle is
/// positive where the angle between them is less than a right one.
TEST(FabricLayer, ShearAngleIsPositiveWhereWarpAndWeftCloseInAndFibresFollowTheMotion) {
  const auto mesh = mechanics::make_rectangle({0, 20}, {0, 20}, 10);
  for (const double degrees : {0.0, 30.0}) {
    FabricLayer layer(make_layer(lopsided(), degrees), 1, mesh);
    const double angle = degrees * M_PI / 180;
    for (const double gamma : {0.2, -0.3}) {
      const Eigen::Rotation2Dd to_fibres(angle);
      mechanics::Matrix2 shear;
      shear << 1.01, std::sin(gamma), 0, std::cos(gamma);  // F warp = 1.01 warp, F weft = (sin, cos) in the fibre frame
      const mechanics::Matrix2 F = to_fibres.toRotationMatrix() * shear * to_fibres.inverse().toRotationMatrix();
      const Eigen::Matrix3d turn(Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()));
      NodalVectors x = map_in_plane(mesh, F);
      x.matrix() = turn * x.matrix().eval();
      const auto fields = layer.compute_fields(x);
      const auto at = [&](std::size_t field, Eigen::Index e) {
        const auto n = static_cast<std::size_t>(mesh.n_elements()), i = static_cast<std::size_t>(e);
        const auto& v = fields[field].values;
        return Vector3(v[i], v[n + i], v[2 * n + i]);
      };
      const Vector3 warp = turn * Vector3(std::cos(angle), std::sin(angle), 0);
      const double across = angle + M_PI / 2 - gamma;
      const Vector3 weft = turn * Vector3(std::cos(across), std::sin(across), 0);
      for (Eigen::Index e = 0; e < mesh.n_elements(); ++e) {
        EXPECT_NEAR(fields[0].values[static_cast<std::size_t>(e)], gamma, 1e-13);
        EXPECT_LT((at(9, e) - warp).norm(), 1e-13);
        EXPECT_LT((at(10, e) - weft).norm(), 1e-13);
        EXPECT_NEAR(std::acos(at(9, e).dot(at(10, e))), M_PI / 2 - gamma, 1e-12);
      }
    }
  }
}

TEST(FabricLayer, FactoryTakesLawOrientationAndMassScalingFromTheScene) {
  scene::Scene scene;
  scene.layers = {make_layer(soft()), make_layer(stiff(scene::Variant::Biaxial), 45)};
  const auto mesh = mechanics::make_rectangle({0, 20}, {0, 20}, 10);
  const auto plain = fabric::make_fabric_layer(scene, 1, mesh);
  scene.time.mass_scaling = 4;
  const auto scaled = fabric::make_fabric_layer(scene, 1, mesh);
  const NodalVectors& x = mesh.reference;
  const double increment = plain->compute_stable_increment(x);
  EXPECT_NEAR(scaled->compute_stable_increment(x), 2 * increment, 1e-12 * increment);
  EXPECT_LT(increment, fabric::make_fabric_layer(scene, 0, mesh)->compute_stable_increment(x));
}

}  // namespace
}  // namespace interply
