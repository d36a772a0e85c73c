/// The exact stability limit of contact in the lock-step exchange (services/contact/THEORY.md): that of the monolithic scheme.
#include <fmt/format.h>
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
/// fixed partner. Returns the safety factor at which dt would be exactly the limit: matching meshes whose nodes all
/// have the same mass and stiffness per area make the stack a chain of as many masses as layers, and x(n+1) - 2 x(n) +
/// x(n-1) + dt M^-1 C (x(n) - x(n-1)) + dt^2 M^-1 K x(n) = 0 has the root z = -1, by which it leaves the unit circle,
/// where the largest eigenvalue of M^-1 (dt^2 K + 2 dt C) is 4.
struct Limit {
  scene::Scene scene;
  double safety = 0;
};

Limit find_limit(int n_layers, double damping) {
  Limit limit{.scene = test::read_test_scene(
                  "flat_stack.yaml", {fmt::format("contact.damping={}", damping), "tools.blank_holder.damping=0",
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
  const auto inverse_mass = [&](int i) {  // per area
    if (i < 0 || i == n_layers) return 0.0;
    const scene::Layer& layer = scene.layers[static_cast<std::size_t>(i)];
    return 1 / (layer.thickness * layer.density);
  };
  const auto damper = [&](int lower, int upper) {  // fraction of what is critical for the two partners alone
    return 2 * damping * std::sqrt(stiffness(lower, upper) / (inverse_mass(lower) + inverse_mass(upper)));
  };
  const auto assemble = [&](const auto& of_interface) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n_layers, n_layers);
    for (int i = 0; i < n_layers; ++i) {
      a(i, i) = (of_interface(i - 1, i) + of_interface(i, i + 1)) * inverse_mass(i);
      if (i > 0) a(i, i - 1) = a(i - 1, i) = -of_interface(i - 1, i) * std::sqrt(inverse_mass(i - 1) * inverse_mass(i));
    }
    return a;
  };
  const Eigen::MatrixXd k = assemble(stiffness), c = assemble(damper);
  const auto largest = [&](double dt) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dt * dt * k + 2 * dt * c).eigenvalues().maxCoeff();
  };
  double exact = 0;
  for (double half = 1e-3; half > 1e-15; half *= 0.5)
    if (largest(exact + half) < 4) exact += half;
  // what the coordinator would take at safety 1
  coordinator::Stack stack(scene);
  stack.begin_step();
  for (int i = 0; i < n_layers; ++i) {
    stack.take_motion(i, solve::make_layer_mesh(scene, i).reference, {}, 1);
    stack.compute_contact_of(i, 0);
  }
  const double voted = stack.collect_votes().stack;
  EXPECT_LE(voted, exact) << "the bound in use is no bound";
  limit.safety = exact / voted;
  return limit;
}

void expect_stable_up_to_the_limit(double damping) {
  for (const int n_layers : {1, 2, 3}) {
    Limit limit = find_limit(n_layers, damping);
    limit.scene.time.safety = 0.985 * limit.safety;
    const auto below = test::run_in_process(limit.scene, {.factory = test::make_point_masses});
    EXPECT_EQ(below.outcome.exit_code, 0) << n_layers << ": " << below.outcome.message;
    EXPECT_LT(below.outcome.measures.largest_residual, 0.01);

    limit.scene.time.safety = 1.03 * limit.safety;
    const auto above = test::run_in_process(limit.scene, {.factory = test::make_point_masses});
    if ((n_layers == 1 || damping > 0) && above.outcome.exit_code == 0) {
      // Alone between rigid tools a layer parts from them before it has gone far, and dampers do not pull: contact that
      // opens holds the growth back, and the balance shows it without always passing its limit.
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

TEST(LockStep, CoordinatorIsStableUpToTheExactLimitOfContactAndStopsBeyondIt) { expect_stable_up_to_the_limit(0); }
TEST(LockStep, CoordinatorIsStableUpToTheExactLimitOfDampedContactAndStopsBeyondIt) {
  expect_stable_up_to_the_limit(0.3);
}

}  // namespace
