#include "solver_metal/metal_layer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

#include "support/metal_sheet.hpp"

namespace interply::metal::test {
namespace {

NodalVectors rotate(const NodalVectors& x, const Eigen::Matrix3d& r) { return (r * x.matrix()).array(); }

Eigen::Matrix3d make_rotation(double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d(1, -2, 0.7).normalized()).toRotationMatrix();
}

std::uint64_t compute_digest(const MetalLayer& layer) {
  mechanics::Digest digest;
  layer.add_state_to(digest);
  return digest.value();
}

TEST(MetalShell, RotationOfAStressedSheetTurnsItsForces) {
  const TriangleMesh mesh = make_distorted_square(40, 8, 0.2);
  Sheet sheet(make_sheet(make_dc04()), mesh);
  sheet.bend(mesh, 1, 50);
  const NodalVectors before = sheet.force;
  const double energy = sheet.layer.internal_energy();
  const Eigen::Matrix3d r = make_rotation(2.9);
  sheet.advance(rotate(make_curved_shape(mesh, 1), r));
  EXPECT_GT(before.abs().maxCoeff(), 100);
  EXPECT_LT((sheet.force - rotate(before, r)).abs().maxCoeff(), 1e-8 * before.abs().maxCoeff());
  EXPECT_NEAR(sheet.layer.internal_energy(), energy, 1e-10 * energy);
}

TEST(MetalShell, ForcesHaveNoResultantAndNoMoment) {
  const TriangleMesh mesh = make_distorted_square(40, 8, 0.2);
  Sheet sheet(make_sheet(make_dc04()), mesh);
  sheet.bend(mesh, 1, 20);
  const NodalVectors x = make_curved_shape(mesh, 1);
  mechanics::Vector3 force = mechanics::Vector3::Zero(), moment = force;
  for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i) {
    force += mechanics::at(sheet.force, i);
    moment += mechanics::at(x, i).cross(mechanics::at(sheet.force, i));
  }
  EXPECT_LT(force.norm(), 1e-10 * sheet.force.abs().sum());
  EXPECT_LT(moment.norm(), 1e-10 * 40 * sheet.force.abs().sum());
}

/// The stress work of one small elastic step either way is the work of the nodal forces: bending, membrane and the
/// mirrored edge included.
TEST(MetalShell, ForceIsTheGradientOfTheStressWorkInTheElasticRange) {
  for (const bool symmetric : {false, true}) {
    TriangleMesh mesh =
        symmetric ? mechanics::make_rectangle({-16, 16}, {0, 32}, 8, 0, true) : make_distorted_square(40, 8, 0.2);
    for (const double amount : {0.02, 1.0}) {
      const auto replay = [&](const NodalVectors& offset) {
        Sheet sheet(make_sheet(make_elastic()), mesh);
        sheet.bend(mesh, amount, 10);
        sheet.advance(make_curved_shape(mesh, amount) + offset);
        return sheet.layer.internal_energy();
      };
      Sheet sheet(make_sheet(make_elastic()), mesh);
      sheet.bend(mesh, amount, 10);
      for (const unsigned seed : {1u, 2u, 3u}) {
        NodalVectors direction = make_random_vectors(mesh.n_nodes(), seed);
        if (seed == 3) direction.topRows(2).setZero();  // bending alone near the flat state
        for (const int i : mesh.symmetry_nodes) direction(1, i) = 0;
        const double h = 1e-4;
        const double difference = (replay(h * direction) - replay(-h * direction)) / (2 * h);
        const double work = (sheet.force * direction).sum();
        EXPECT_NEAR(difference, work, 1e-5 * (sheet.force * direction).abs().sum()) << seed << " " << amount;
      }
    }
  }
}

TEST(MetalShell, StressWorkIsTheWorkOfTheNodalForcesToSecondOrder) {
  const TriangleMesh mesh = make_distorted_square(40, 8, 0.2);
  for (const auto& law : {make_elastic(), make_dc04()}) {
    double last = 0;
    for (const int steps : {50, 100, 200}) {
      Sheet sheet(make_sheet(law), mesh);
      NodalVectors x = mesh.reference, f = NodalVectors::Zero(3, mesh.n_nodes());
      double work = 0;
      for (int s = 1; s <= steps; ++s) {
        const NodalVectors next = make_curved_shape(mesh, 1.0 * s / steps);
        const NodalVectors old = f;
        f = sheet.advance(next);
        work += 0.5 * ((old + f) * (next - x)).sum();
        x = next;
      }
      const double error = std::abs(sheet.layer.internal_energy() - work) / work;
      EXPECT_LT(error, 0.1 / (steps * steps) * 50);
      if (last > 0) {
        EXPECT_GT(last / error, 3) << steps;  // 4 in the limit; the plastic front is only piecewise smooth
      }
      last = error;
    }
  }
}

TEST(MetalShell, HalfModelIsHalfOfTheWhole) {
  const TriangleMesh half = mechanics::make_rectangle({-16, 16}, {0, 32}, 8, 0, true);
  const TriangleMesh whole = mechanics::make_rectangle({-16, 16}, {-32, 32}, 8);
  const auto shape = [](const TriangleMesh& mesh, double amount) {
    NodalVectors x = mesh.reference;
    x.row(0) += amount * (0.05 * mesh.reference.row(0) + 1e-3 * mesh.reference.row(1).square());
    x.row(1) *= 1 - 0.02 * amount;
    x.row(2) += amount * (4e-3 * mesh.reference.row(1).square() + 2e-3 * mesh.reference.row(0).square());
    return x;
  };
  Sheet a(make_sheet(make_dc04()), half), b(make_sheet(make_dc04()), whole);
  for (int s = 1; s <= 20; ++s) {
    a.advance(shape(half, s / 20.0), 3e-7);  // the edges move, too
    b.advance(shape(whole, s / 20.0), 3e-7);
  }
  EXPECT_NEAR(a.layer.internal_energy(), 0.5 * b.layer.internal_energy(), 1e-10 * b.layer.internal_energy());
  const double scale = b.force.abs().maxCoeff();
  const Eigen::Index offset = whole.n_nodes() - half.n_nodes();
  for (Eigen::Index i = 0; i < half.n_nodes(); ++i) {
    const bool on_plane = half.reference(1, i) == 0;
    for (const int c : {0, 1, 2}) {
      if (on_plane && c == 1) continue;  // the plane's reaction
      EXPECT_NEAR(a.force(c, i), (on_plane ? 0.5 : 1.0) * b.force(c, offset + i), 1e-10 * scale);
    }
  }
}

TEST(MetalShell, AnyNumberOfThreadsGivesTheSameBits) {
  const TriangleMesh mesh = make_distorted_square(200, 8, 0.2);  // several blocks
  Sheet one(make_sheet(make_dc04(), 5, 1, 1), mesh);
  one.bend(mesh, 0.2, 10);
  for (const int threads : {2, 3}) {
    Sheet many(make_sheet(make_dc04(), 5, 1, threads), mesh);
    many.bend(mesh, 0.2, 10);
    EXPECT_TRUE((many.force == one.force).all());
    EXPECT_EQ(many.layer.internal_energy(), one.layer.internal_energy());
    EXPECT_EQ(compute_digest(many.layer), compute_digest(one.layer));
  }
}

TEST(MetalShell, NodalThicknessIsTheAreaWeightedMeanAndNeverBelowItsElements) {
  const TriangleMesh mesh = make_distorted_square(40, 8, 0.2);
  Sheet sheet(make_sheet(make_dc04(), 5, 1.5), mesh);
  EXPECT_LT((sheet.layer.compute_nodal_thickness() - 1.5).abs().maxCoeff(), 1e-14);
  sheet.bend(mesh, 1, 40);
  const auto thickness = sheet.field("thickness");
  const mechanics::Scalars nodal = sheet.layer.compute_nodal_thickness(), areas = mechanics::compute_areas(mesh);
  EXPECT_GE(nodal.minCoeff(), *std::min_element(thickness.begin(), thickness.end()));
  EXPECT_LE(nodal.maxCoeff(), *std::max_element(thickness.begin(), thickness.end()));
  double volume = 0;  // a third of each element's volume at each corner
  for (Eigen::Index e = 0; e < areas.size(); ++e) volume += areas(e) * thickness[e];
  EXPECT_NEAR((nodal * mechanics::compute_tributary_areas(mesh)).sum(), volume, 1e-9 * volume);
}

TEST(MetalShell, FieldsCoverEveryElementAndTheSummaryNamesTheirExtremes) {
  const TriangleMesh mesh = make_distorted_square(40, 8, 0.2);
  Sheet sheet(make_sheet(make_dc04(), 4), mesh);
  sheet.bend(mesh, 1, 40);
  for (const auto& field : sheet.layer.compute_fields(sheet.position)) {
    EXPECT_EQ(static_cast<Eigen::Index>(field.values.size()), mesh.n_elements()) << field.name;
    EXPECT_FALSE(field.nodal);
    EXPECT_FALSE(field.unit.empty());
    EXPECT_FALSE(field.description.empty());
  }
  const auto summary = sheet.layer.summarise(sheet.position);
  const auto strain = sheet.field("plastic_strain"), thickness = sheet.field("thickness");
  ASSERT_EQ(summary.size(), 3u);
  EXPECT_EQ(summary[0].value, *std::max_element(strain.begin(), strain.end()));
  EXPECT_NEAR(summary[1].value, 100 * (1 - *std::min_element(thickness.begin(), thickness.end())), 1e-12);
  EXPECT_NEAR(summary[2].value, 530 * std::pow(0.0065 + summary[0].value, 0.23), 1e-6);
}

TEST(MetalShell, FactoryScalesTheDensity) {
  const TriangleMesh mesh = mechanics::make_rectangle({0, 20}, {0, 20}, 4);
  scene::Scene scene;
  scene.layers = {make_sheet(make_dc04())};
  const double dt = make_metal_layer(scene, 0, mesh)->compute_stable_increment(mesh.reference);
  scene.time.mass_scaling = 4;
  EXPECT_NEAR(make_metal_layer(scene, 0, mesh)->compute_stable_increment(mesh.reference), 2 * dt, 1e-3 * dt);
}

class DivergedSheet : public testing::Test {
 protected:
  TriangleMesh mesh = mechanics::make_rectangle({0, 20}, {0, 20}, 4);
  Sheet sheet{make_sheet(make_dc04()), mesh};
  std::string diverge(const NodalVectors& x) {
    try {
      sheet.layer.compute_internal_forces(x, {.time = 0.0123}, sheet.force);
    } catch (const mechanics::Divergence& error) {
      return error.what();
    }
    return "nothing thrown";
  }
};

using testing::AllOf;
using testing::HasSubstr;

TEST_F(DivergedSheet, CrushedElementIsNamedWithPlaceTimeAndCure) {
  NodalVectors x = mesh.reference;
  x(1, 7) = 0.1;  // the far corner of element 0, almost down on its opposite side: 0.1 of 4 mm
  EXPECT_THAT(diverge(x), AllOf(HasSubstr("layer sheet, element 0 at ("), HasSubstr("mm, t = 0.0123 s"),
                                HasSubstr("area ratio 0.025 is not in [0.05, 20]"), HasSubstr("time.safety")));
}

TEST_F(DivergedSheet, TornElementIsNamed) {
  NodalVectors x = mesh.reference;
  x.col(7) += 1000;
  EXPECT_THAT(diverge(x), AllOf(HasSubstr("is not in [0.05, 20]"), HasSubstr("sheet")));
}

TEST_F(DivergedSheet, NanPositionIsNamed) {
  NodalVectors x = mesh.reference;
  x(2, 14) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(diverge(x),
              AllOf(HasSubstr("layer sheet, element "), HasSubstr("node 14 is at ("), HasSubstr("nan), the motion")));
}

}  // namespace
}  // namespace interply::metal::test
