/// A user's own law in a ply: equal to the built-in law where it has the same equations, and safe where it fails.
#include "solve/vumat.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <filesystem>
#include <fstream>

#include "scene/read_scene.hpp"
#include "solver_fabric/fabric_layer.hpp"
#include "support/fabric_cases.hpp"
#include "support/vumat_laws.hpp"

namespace interply {
namespace {

using namespace fabric_cases;
using fabric::FabricLayer;
using mechanics::Matrix2;
using mechanics::NodalVectors;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kDt = 1e-7;

scene::Layer make_own_layer(const scene::VumatLaw& law, double orientation_deg = 0) {
  scene::Layer layer = make_layer(soft(), orientation_deg);
  layer.law = law;
  return layer;
}

/// Smooth stretched, sheared, bent shape along a closed curve of amplitudes.
NodalVectors make_shape(const mechanics::TriangleMesh& mesh, double t) {
  const double a = 0.04 * std::sin(t), b = 0.03 * std::sin(1.7 * t), c = 0.25 * std::sin(0.6 * t);
  NodalVectors x = mesh.reference;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const double u = mesh.reference(0, i), v = mesh.reference(1, i);
    x(0, i) += a * u + c * v + 0.002 * a * u * v;
    x(1, i) += b * v + 0.003 * b * u * u;
    x(2, i) += 0.05 * std::sin(t) * (0.1 * u * u - 0.2 * u * v);
  }
  return x;
}

/// Two layers on the same way.
class Twins {
 public:
  Twins(const scene::WovenLaw& law, const mechanics::TriangleMesh& mesh, double orientation_deg = 30)
      : mesh_(mesh),
        position(mesh.reference),
        built_in(make_layer(law, orientation_deg), 1, mesh),
        own(make_own_layer(test::make_woven_vumat(law), orientation_deg), 1, mesh) {}

  void move(const NodalVectors& x) {
    time_ += kDt;
    position = x;
    built_in.compute_internal_forces(x, {.time = time_, .dt = kDt}, built_in_force);
    own.compute_internal_forces(x, {.time = time_, .dt = kDt}, own_force);
  }
  void follow(double from, double to, int steps) {
    for (int i = 1; i <= steps; ++i) move(make_shape(mesh_, from + (to - from) * i / steps));
  }

 private:
  const mechanics::TriangleMesh& mesh_;
  double time_ = 0;

 public:
  NodalVectors position;
  FabricLayer built_in, own;
  NodalVectors built_in_force, own_force;
};

std::vector<double> find_field(const FabricLayer& layer, const NodalVectors& x, const std::string& name) {
  for (const auto& f : layer.compute_fields(x))
    if (f.name == name) return f.values;
  throw std::out_of_range(name);
}

TEST(VumatPly, ForcesEqualThoseOfTheBuiltInLawOverARandomWalk) {
  const auto mesh = distort(mechanics::make_rectangle({0, 60}, {0, 40}, 4), 0.6);
  for (const auto variant : {scene::Variant::Uncoupled, scene::Variant::Full, scene::Variant::Biaxial}) {
    Twins twins(lopsided(variant), mesh);
    double t = 0;
    std::mt19937 random(2);
    for (int i = 0; i < 60; ++i) {
      t += std::uniform_real_distribution<double>(-0.1, 0.3)(random);
      twins.move(make_shape(mesh, t));
      const double scale = twins.built_in_force.abs().maxCoeff();
      ASSERT_GT(scale, 0);
      ASSERT_LT((twins.own_force - twins.built_in_force).abs().maxCoeff(), 1e-10 * scale) << i;
    }
    for (const char* name : {"S11", "S22", "S12", "shear_angle", "stretch_warp", "stretch_weft"}) {
      const auto a = find_field(twins.own, twins.position, name), b = find_field(twins.built_in, twins.position, name);
      for (std::size_t e = 0; e < a.size(); ++e) ASSERT_NEAR(a[e], b[e], 1e-9 * (1 + std::abs(b[e]))) << name;
    }
    const auto state = find_field(twins.own, twins.position, "state_1"),
               gamma = find_field(twins.built_in, twins.position, "shear_angle");
    for (std::size_t e = 0; e < state.size(); ++e) ASSERT_NEAR(state[e], gamma[e], 1e-12);
    EXPECT_TRUE((twins.own.compute_nodal_thickness() == 1.2).all());
  }
}

TEST(VumatPly, BookedWorkConvergesToTheStrainEnergyAtSecondOrder) {
  const auto mesh = mechanics::make_rectangle({0, 20}, {0, 20}, 5);
  const auto error = [&](int steps) {
    Twins twins(lopsided(), mesh);
    twins.follow(0, 1.2, steps);
    return std::abs(twins.own.internal_energy() / twins.built_in.internal_energy() - 1);
  };
  const double coarse = error(40), fine = error(80);
  EXPECT_LT(fine, 1e-3);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.2);
}

/// 2 / omega_max of the tangent by differences of the force, the built-in layer having no history.
double compute_exact_increment(FabricLayer& layer, const mechanics::TriangleMesh& mesh, const NodalVectors& x) {
  const Eigen::Index n = x.cols();
  const auto mass = mechanics::compute_lumped_mass(mesh, 1.2, 6.19e-10);
  Eigen::MatrixXd k(3 * n, 3 * n);
  NodalVectors moved = x, above, below;
  for (int c = 0; c < 3; ++c)
    for (Eigen::Index i = 0; i < n; ++i) {
      moved(c, i) = x(c, i) + 1e-5;
      layer.compute_internal_forces(moved, {}, above);
      moved(c, i) = x(c, i) - 1e-5;
      layer.compute_internal_forces(moved, {}, below);
      moved(c, i) = x(c, i);
      for (int d = 0; d < 3; ++d)
        for (Eigen::Index j = 0; j < n; ++j)
          k(d * n + j, c * n + i) = (above(d, j) - below(d, j)) / 2e-5 / std::sqrt(mass(i) * mass(j));
    }
  layer.compute_internal_forces(x, {}, above);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver((k + k.transpose()) / 2, Eigen::EigenvaluesOnly);
  return 2 / std::sqrt(solver.eigenvalues().maxCoeff());
}

TEST(VumatPly, StableIncrementIsASafeBound) {
  const auto mesh = distort(mechanics::make_rectangle({0, 16}, {0, 16}, 4), 0.5);
  Twins twins(lopsided(), mesh, 0);
  EXPECT_NEAR(twins.own.compute_stable_increment(twins.position),
              twins.built_in.compute_stable_increment(twins.position),
              0.03 * twins.built_in.compute_stable_increment(twins.position));
  for (int i = 1; i <= 8; ++i) {
    twins.follow(0.4 * (i - 1), 0.4 * i, 10);
    const double exact = compute_exact_increment(twins.built_in, mesh, make_shape(mesh, 0.4 * i));
    const double own = twins.own.compute_stable_increment(twins.position);
    EXPECT_LT(own, exact * 1.001);
    EXPECT_GT(own, 0.6 * twins.built_in.compute_stable_increment(twins.position));
  }
}

TEST(VumatPly, LooksAtTheTangentWithoutTouchingTheHistory) {
  const auto mesh = mechanics::make_rectangle({0, 20}, {0, 20}, 5);
  Twins a(lopsided(), mesh), b(lopsided(), mesh);
  a.follow(0, 1, 20);
  for (int i = 1; i <= 20; ++i) {
    b.follow((i - 1) / 20.0, i / 20.0, 1);
    b.own.compute_stable_increment(b.position);
  }
  EXPECT_TRUE((a.own_force == b.own_force).all());
}

/// sigma = E sum of strainInc: in a stretch with fixed axes that is E ln(lambda), whatever rotates with it.
TEST(VumatPly, StrainIncrementsAddUpToTheLogarithmicStrainAndFollowRotation) {
  const auto mesh = mechanics::make_rectangle({0, 8}, {0, 8}, 4);
  FabricLayer layer(make_own_layer(test::make_faulty_vumat(1000)), 1, mesh);
  NodalVectors x, force;
  const int steps = 400;
  for (int i = 1; i <= steps; ++i) {
    Matrix2 F = Matrix2::Identity();
    F(0, 0) = std::exp(0.2 * i / steps);
    x = map_in_plane(mesh, F);
    x = (slanted_rotation(2.0 * i / steps) * x.matrix()).array();
    layer.compute_internal_forces(x, {.time = i * kDt, .dt = kDt}, force);
  }
  const double stretch = std::exp(0.2);
  // S11 = J sigma / lambda^2 with F33 = 1
  for (const double s : find_field(layer, x, "S11")) EXPECT_NEAR(s, 1000 * 0.2 * stretch / (stretch * stretch), 1e-3);
  for (const double s : find_field(layer, x, "S22")) EXPECT_NEAR(s, 0, 1e-9);
  for (const double s : find_field(layer, x, "S12")) EXPECT_NEAR(s, 0, 1e-9);
}

TEST(Vumat, RelativeSpinOfSimpleShear) {
  // the polar frame turns by -atan(k/2), the material at -1/2 per k
  const auto stretch_of = [](double k) {
    Matrix2 F;
    F << 1, k, 0, 1;
    return solve::compute_stretch(F.transpose() * F);
  };
  const double k = 0.6, dk = 1e-4;
  const Matrix2 old_stretch = stretch_of(k - dk / 2), now = stretch_of(k + dk / 2);
  const auto increment = solve::compute_vumat_increment(old_stretch, now * now);
  EXPECT_NEAR(increment.spin / dk, -0.5 + 0.5 / (1 + k * k / 4), 1e-6);
  EXPECT_NEAR(increment.strain.trace(), 0, 1e-10);
}

std::string refuse(const scene::VumatLaw& law) {
  try {
    FabricLayer(make_own_layer(law), 1, mechanics::make_rectangle({0, 8}, {0, 8}, 4));
  } catch (const scene::SceneError& e) {
    return e.what();
  }
  return "";
}

TEST(Vumat, LibrariesThatCannotBeUsedAreNamedWithACure) {
  EXPECT_THAT(refuse(test::make_vumat("missing", {})),
              AllOf(HasSubstr("layer ply_2: law.vumat.library"), HasSubstr("libmissing.so"), HasSubstr("gfortran")));
  EXPECT_THAT(refuse(test::make_vumat("umat", {})), HasSubstr("has neither the symbol vumat_ nor vumat"));
  EXPECT_THAT(refuse(test::make_faulty_vumat(0)), HasSubstr("must resist small strains"));
  auto changed = test::make_faulty_vumat(1000);
  changed.library.digest = "0123456789abcdef";
  EXPECT_THAT(refuse(changed), HasSubstr("has changed since the scene was resolved"));
}

TEST(Vumat, StressThatIsNotANumberNamesLayerElementAndTime) {
  const auto mesh = mechanics::make_rectangle({0, 8}, {0, 8}, 4);
  FabricLayer layer(make_own_layer(test::make_faulty_vumat(1000, 1, 2.5e-7)), 1, mesh);
  NodalVectors force;
  const auto step = [&](int i) {
    layer.compute_internal_forces(mesh.reference * (1 + 1e-4 * i), {.time = i * kDt, .dt = kDt}, force);
  };
  step(1);
  step(2);
  try {
    step(3);
    FAIL();
  } catch (const mechanics::Divergence& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("layer ply_2, element 0"), HasSubstr("t = 3e-07 s"),
                                HasSubstr("the vumat returned the stress (nan")));
  }
}

TEST(Vumat, PositionsOutsideAMotionMoveNothing) {
  const auto mesh = mechanics::make_rectangle({0, 8}, {0, 8}, 4);
  FabricLayer layer(make_own_layer(test::make_faulty_vumat(1000)), 1, mesh);
  NodalVectors force;
  layer.compute_internal_forces(mesh.reference * 1.1, {}, force);
  EXPECT_EQ(force.abs().maxCoeff(), 0);
  EXPECT_EQ(layer.internal_energy(), 0);
}

}  // namespace
}  // namespace interply
