/// A user's own law through the thickness of a sheet: J2 in Fortran against the built-in J2.
#include "solver_metal/vumat_section.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/metal_sheet.hpp"
#include "support/vumat_laws.hpp"

namespace interply::metal {
namespace {

using test::make_sheet;
using test::Sheet;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kDt = 1e-8;

scene::Layer make_own_sheet(scene::VumatLaw law) {
  law.integration = scene::Integration::Shell;
  scene::Layer layer = make_sheet(test::make_dc04());
  layer.law = law;
  return layer;
}

/// Built-in and own sheet on the same way: stretched, sheared and bent well into the plastic range and part of it back.
struct Twins {
  double time = 0;
  mechanics::TriangleMesh mesh = test::make_distorted_square(20, 4, 0.15);
  Sheet built_in{make_sheet(test::make_dc04()), mesh};
  Sheet own{make_own_sheet(interply::test::make_j2_vumat(test::make_dc04(), scene::Integration::Shell)), mesh};

  void follow(double from, double to, int steps) {
    for (int i = 1; i <= steps; ++i) {
      const mechanics::NodalVectors x = test::make_curved_shape(mesh, from + (to - from) * i / steps);
      time += kDt;
      for (Sheet* sheet : {&built_in, &own}) {
        sheet->position = x;
        sheet->layer.compute_internal_forces(x, {.time = time, .dt = kDt}, sheet->force);
      }
    }
  }
};

TEST(VumatSheet, EqualsTheBuiltInJ2Law) {
  Twins twins;
  twins.follow(0, 1, 60);
  twins.follow(1, 0.6, 20);
  const double scale = twins.built_in.force.abs().maxCoeff();
  EXPECT_LT((twins.own.force - twins.built_in.force).abs().maxCoeff(), 1e-9 * scale);
  for (const char* name : {"thickness", "sigma_11", "sigma_22", "sigma_12"}) {
    const auto a = twins.own.field(name), b = twins.built_in.field(name);
    for (std::size_t e = 0; e < a.size(); ++e) ASSERT_NEAR(a[e], b[e], 1e-7) << name;
  }
  const auto state = twins.own.field("state_1");
  EXPECT_GT(*std::max_element(state.begin(), state.end()), 0.05);
  EXPECT_NEAR(twins.own.layer.internal_energy(), twins.built_in.layer.internal_energy(),
              1e-9 * twins.built_in.layer.internal_energy());
  EXPECT_NEAR(twins.own.layer.compute_nodal_thickness().minCoeff(),
              twins.built_in.layer.compute_nodal_thickness().minCoeff(), 1e-9);
}

/// nu = 0 in the bound: sqrt((1 - nu)/(1 - nu^2)) = 0.877 of the increment of the built-in law at most.
TEST(VumatSheet, StableIncrementIsSaferThanThatOfTheBuiltInLaw) {
  Twins twins;
  for (const double to : {0.0, 0.5, 1.0}) {
    if (to > 0) twins.follow(to - 0.5, to, 30);
    const double ratio = twins.own.layer.compute_stable_increment(twins.own.position) /
                         twins.built_in.layer.compute_stable_increment(twins.built_in.position);
    EXPECT_LT(ratio, 1);
    EXPECT_GT(ratio, 0.8);
  }
}

TEST(VumatSheet, StressThatIsNotANumberNamesLayerElementAndTime) {
  const auto mesh = mechanics::make_rectangle({0, 8}, {0, 8}, 4);
  Sheet sheet(make_own_sheet(interply::test::make_faulty_vumat(1000, 1, 5e-9)), mesh);
  try {
    sheet.layer.compute_internal_forces(mesh.reference * 1.001, {.time = kDt, .dt = kDt}, sheet.force);
    FAIL();
  } catch (const mechanics::Divergence& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("layer sheet, element 0"), HasSubstr("t = 1e-08 s"), HasSubstr("the vumat")));
  }
}

TEST(VumatSheet, PositionsOutsideAMotionMoveNothing) {
  const auto mesh = mechanics::make_rectangle({0, 8}, {0, 8}, 4);
  Sheet sheet(make_own_sheet(interply::test::make_faulty_vumat(1000)), mesh);
  sheet.advance(mesh.reference * 1.01);
  EXPECT_EQ(sheet.force.abs().maxCoeff(), 0);
  EXPECT_EQ(sheet.layer.internal_energy(), 0);
}

}  // namespace
}  // namespace interply::metal
