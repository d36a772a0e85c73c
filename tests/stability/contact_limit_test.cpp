/// The exact stability limit of contact in the lock-step exchange (MECHANICS 3): that of the monolithic scheme.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "contact/tool_interface.hpp"
#include "coordinator/stack.hpp"
#include "support/free_layers.hpp"
#include "support/in_process_run.hpp"
#include "support/point_masses.hpp"

namespace {

using namespace interply;
using testing::HasSubstr;

/// A half space: z <= 0 is tool (faces up), or z >= 0 (faces down).
class Plane : public contact::SignedDistance {
 public:
  explicit Plane(bool faces_up) : up_(faces_up ? 1 : -1) {}
  contact::Distance evaluate(const mechanics::Vector3& x) const override {
    return {.value = up_ * x.z(), .gradient = mechanics::Vector3(0, 0, up_)};
  }

 private:
  double up_;
};

/// Point masses squeezed between two rigid plates: k = 2 k_c A per node whatever the mesh. Started from rest at an
/// offset, u(n) follows the map z^2 - (2 - kappa) z + 1 = 0 with kappa = k dt^2/m.
class SqueezedMasses {
 public:
  SqueezedMasses(double kappa, double offset) {
    const double k = 500, thickness = 1, density = 1e-9;
    dt_ = std::sqrt(kappa * density * thickness / (2 * k));
    mesh_ = mechanics::make_rectangle({0, 20}, {0, 20}, 5, 0.5 * thickness);
    layer_ = std::make_unique<test::FreeLayer>(mesh_, std::make_unique<test::PointMasses>(mesh_.n_nodes()), thickness,
                                               density, mechanics::Vector3::Zero());
    layer_->position.row(2) += offset;
    layer_->geometry.move_to(layer_->position);
    below_ = {.name = "below", .shape = std::make_unique<Plane>(true), .z = kPressedIn};
    above_ = {.name = "above", .shape = std::make_unique<Plane>(false), .z = thickness - kPressedIn};
    const contact::InterfaceLaw law{.stiffness = k, .tangential = k};
    lower_ = std::make_unique<contact::ToolInterface>(law, layer_->geometry, below_);
    upper_ = std::make_unique<contact::ToolInterface>(law, layer_->geometry, above_);
    lower_->update(0);
    upper_->update(0);
    kick(0);
  }
  void step() {
    layer_->drift(dt_);
    lower_->update(dt_);
    upper_->update(dt_);
    kick(dt_);
  }
  /// Displacement of node i from the middle, mm.
  double u(Eigen::Index i) const { return layer_->position(2, i) - 0.5; }
  Eigen::Index size() const { return mesh_.n_nodes(); }

 private:
  static constexpr double kPressedIn = 0.02;  ///< mm
  void kick(double dt) {
    layer_->motion.dt = dt;
    layer_->kick(dt_, 0, lower_->force_on_layer() + upper_->force_on_layer());
  }
  double dt_ = 0;
  mechanics::TriangleMesh mesh_;
  std::unique_ptr<test::FreeLayer> layer_;
  contact::Tool below_, above_;
  std::unique_ptr<contact::ToolInterface> lower_, upper_;
};

TEST(LockStep, ContactFollowsTheExactMapOfTheMonolithicScheme) {
  for (const double kappa : {0.1, 1.0, 2.5, 3.9}) {
    const double start = 1e-4;
    SqueezedMasses masses(kappa, start);
    // u(0) = start, u(1) = (1 - kappa/2) start from rest, then u(n+1) = (2 - kappa) u(n) - u(n-1) = start cos(n theta)
    const double theta = std::acos(1 - 0.5 * kappa);
    for (int n = 1; n <= 2000; ++n) {
      masses.step();
      for (Eigen::Index i = 0; i < masses.size(); i += 7)
        ASSERT_NEAR(masses.u(i), start * std::cos(n * theta), 1e-3 * start) << kappa << " step " << n;
    }
  }
}

TEST(LockStep, ContactGrowsAtTheExactRateBeyondKappaFour) {
  for (const double kappa : {4.1, 4.5}) {
    const double start = 1e-9, s = 0.5 * kappa - 1, rate = s + std::sqrt(s * s - 1);  // |z| > 1 of the pair z, 1/z
    SqueezedMasses masses(kappa, start);
    int n = 0;
    for (; n < 1000 && std::abs(masses.u(0)) < 1e-3; ++n) masses.step();
    ASSERT_LT(std::abs(masses.u(0)), 1e-2);
    // from rest u(n) = start (-1)^n cosh(n ln rate)
    EXPECT_NEAR(std::log(std::abs(masses.u(0)) / start), std::log(std::cosh(n * std::log(rate))), 1e-3) << kappa;
    EXPECT_EQ(masses.u(0) > 0, n % 2 == 0);
  }
}

/// Stand-in layers between the tools through the whole coordinator. The blank holder is made so heavy that it is a
/// fixed partner. Returns the safety factor at which dt would be exactly 2/omega_max: matching meshes whose nodes all
/// have the same mass and stiffness per area make that a chain of as many masses as layers.
struct Limit {
  scene::Scene scene;
  double safety = 0;
};

Limit find_limit(int n_layers) {
  Limit limit{.scene = test::read_test_scene("flat_stack.yaml", {"contact.damping=0", "tools.blank_holder.damping=0",
                                                                 "motion.forming_time=3e-3", "record.frames=1"})};
  scene::Scene& scene = limit.scene;
  scene.layers.resize(static_cast<std::size_t>(n_layers));
  for (scene::Layer& layer : scene.layers) layer.law = scene::WovenLaw{};  // one kind of layer, one mesh
  scene.tools.punch.reset();
  scene.tools.blank_holder.mass_ratio = 1e4;
  scene.time.energy_limit = 0.02;
  const auto stiffness = [&](int lower, int upper) {  // per area, of the interface between two layers or with a tool
    double thinner = 1e300;
    for (const int i : {lower, upper})
      if (i >= 0 && i < n_layers) thinner = std::min(thinner, scene.layers[static_cast<std::size_t>(i)].thickness);
    return scene.contact.reference_pressure / (scene.contact.penetration * thinner);
  };
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n_layers, n_layers);
  Eigen::VectorXd inverse_root_mass(n_layers);
  for (int i = 0; i < n_layers; ++i) {
    const scene::Layer& layer = scene.layers[static_cast<std::size_t>(i)];
    inverse_root_mass(i) = 1 / std::sqrt(layer.thickness * layer.density);
    k(i, i) = stiffness(i - 1, i) + stiffness(i, i + 1);
    if (i > 0) k(i, i - 1) = k(i - 1, i) = -stiffness(i - 1, i);
  }
  const Eigen::MatrixXd a = inverse_root_mass.asDiagonal() * k * inverse_root_mass.asDiagonal();
  const double exact = 2 / std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a).eigenvalues().maxCoeff());
  // what the coordinator would take at safety 1
  coordinator::Stack stack(scene);
  stack.begin_step();
  for (int i = 0; i < n_layers; ++i)
    stack.accept(i, {.vote = 1, .position = solve::make_layer_mesh(scene, i).reference}, 0);
  double voted = 1;
  for (const coordinator::Vote& vote : stack.collect_votes())
    voted = std::min(voted, coordinator::compute_increment(vote));
  EXPECT_LE(voted, exact) << "the bound in use is no bound";
  limit.safety = exact / voted;
  return limit;
}

TEST(LockStep, CoordinatorIsStableUpToTheExactLimitOfContactAndStopsBeyondIt) {
  for (const int n_layers : {1, 2, 3}) {
    Limit limit = find_limit(n_layers);
    limit.scene.time.safety = 0.985 * limit.safety;
    const auto below = test::run_in_process(limit.scene, {.factory = test::make_point_masses});
    EXPECT_EQ(below.outcome.exit_code, 0) << n_layers << ": " << below.outcome.message;
    EXPECT_LT(below.outcome.measures.largest_residual, 0.01);

    limit.scene.time.safety = 1.03 * limit.safety;
    const auto above = test::run_in_process(limit.scene, {.factory = test::make_point_masses});
    if (n_layers == 1 && above.outcome.exit_code == 0) {
      // Alone between rigid tools the layer parts from them before it has gone far: contact that opens holds the growth
      // back, and the balance shows it without always passing its limit.
      EXPECT_GT(above.outcome.measures.largest_residual, 20 * below.outcome.measures.largest_residual);
      continue;
    }
    EXPECT_EQ(above.outcome.exit_code, 3) << n_layers;
    EXPECT_THAT(above.outcome.message, HasSubstr("energy residual"));
    EXPECT_THAT(above.outcome.message, testing::AnyOf(HasSubstr("interface "), HasSubstr("layer ")));
    EXPECT_THAT(above.outcome.message, HasSubstr("time.safety"));
    EXPECT_EQ(above.sink->end.status, "diverged");
  }
}

}  // namespace
