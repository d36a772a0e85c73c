/// Friction acts at one point that both sides share: momentum, rigid motion, energy at edges.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "support/contact_layer.hpp"

namespace {

using namespace interply;
using namespace interply::contact;
using test::ContactLayer;
using test::make_turned_rectangle;
using test::Moment;
using test::total;

const InterfaceLaw kLaw{.stiffness = 500, .tangential = 400, .damping = 1e-5, .friction = 0.25};

/// Two sheets of other meshes on a bowl, pressed and dragged over each other, friction and damping on: every step both
/// momenta of the interface close to round-off, the nodes that leave the partner's edge included.
TEST(LayerInterface, LinearAndAngularMomentumCloseWithFrictionAndDampingAndAtEdges) {
  ContactLayer lower(make_turned_rectangle(5, 4, 1.0, 0), 1), upper(make_turned_rectangle(4, 3, 0.7, 0.99, 0.3), 1.2);
  const auto bowl = [](const Vector3& x) { return Vector3(x.x(), x.y(), x.z() + 0.03 * x.squaredNorm()); };
  LayerInterface interface(kLaw, lower.geometry, upper.geometry);
  interface.update(0);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-0.02, 0.02);
  int at_edges = 0, stuck = 0, sliding = 0;
  for (int n = 1; n <= 60; ++n) {
    const double s = 0.02 * n;
    lower.move([&](Vector3 x) { return Vector3(bowl(x) + Vector3(s + unit(random), 0.3 * s, 0.3 * unit(random))); });
    upper.move([&](Vector3 x) { return Vector3(bowl(x) + Vector3(0, unit(random), -0.1 + 0.2 * s)); });
    interface.update(1e-5);
    Moment moment;
    moment.add(lower.geometry.positions(), interface.force_on_lower());
    moment.add(upper.geometry.positions(), interface.force_on_upper());
    const double scale = interface.force_on_lower().abs().sum();
    ASSERT_GT(scale, 1);
    EXPECT_LT((total(interface.force_on_lower()) + total(interface.force_on_upper())).norm(), 1e-12 * scale);
    EXPECT_LT(moment.sum.norm(), 1e-12 * moment.scale);
    const Points& p = interface.points();
    for (int i = 0; i < p.size(); ++i) at_edges += p.gap(i) < 0 && p.weight(i) > 0 && p.weight(i) < 1;
    stuck += (p.state == static_cast<int>(State::Stick)).count();
    sliding += (p.state == static_cast<int>(State::Slide)).count();
  }
  EXPECT_GT(at_edges, 20);
  EXPECT_GT(stuck, 20);
  EXPECT_GT(sliding, 20);
}

/// A pressed and sheared pair is turned by 90 degrees about a slanted axis: no slip, no work, and the forces turn with
/// it exactly, however large the steps.
TEST(LayerInterface, RigidRotationOfAPressedPairNeitherSlipsNorWorksAndTurnsTheForces) {
  for (const int steps : {10, 500}) {
    ContactLayer lower(make_turned_rectangle(5, 4, 1.0, 0), 1), upper(make_turned_rectangle(6, 5, 0.7, 1, 0.3), 1.4);
    const auto bowl = [](const Vector3& x) { return Vector3(x.x(), x.y(), 0.02 * x.squaredNorm()); };
    const auto placed = [&](const Vector3& x, const Vector3& shift) {
      return Vector3(bowl({x.x(), x.y(), 0}) + shift);
    };
    const Vector3 rest(0, 0, 1.18), pressed(0.0006, -0.0004, 1.19);
    lower.move([&](Vector3 x) { return placed(x, Vector3::Zero()); });
    upper.move([&](Vector3 x) { return placed(x, rest); });
    LayerInterface interface({.stiffness = 500, .tangential = 400, .damping = 1e-5, .friction = 0.25}, lower.geometry,
                             upper.geometry);
    interface.update(0);
    upper.move([&](Vector3 x) { return placed(x, pressed); });
    interface.update(1e-4);
    lower.move([&](Vector3 x) { return placed(x, Vector3::Zero()); });
    upper.move([&](Vector3 x) { return placed(x, pressed); });
    interface.update(1e-4);
    const NodalVectors start = interface.force_on_lower();
    const Scalars slip = interface.points().slip;
    const InterfaceEnergies before = interface.energies();
    ASSERT_GT(interface.points().acting_traction().abs().maxCoeff(), 0.1);
    const Vector3 axis = Vector3(0.3, -0.5, 0.8).normalized();
    for (int n = 1; n <= steps; ++n) {
      const Eigen::AngleAxisd turn(M_PI / 2 * n / steps, axis);
      lower.move([&](Vector3 x) { return Vector3(turn * placed(x, Vector3::Zero())); });
      upper.move([&](Vector3 x) { return Vector3(turn * placed(x, pressed)); });
      interface.update(1e-4);
    }
    NodalVectors turned(3, start.cols());
    turned.matrix() = Eigen::AngleAxisd(M_PI / 2, axis).toRotationMatrix() * start.matrix();
    EXPECT_LT((interface.force_on_lower() - turned).abs().maxCoeff(), 1e-9 * start.abs().maxCoeff());
    EXPECT_LT((interface.points().slip - slip).abs().maxCoeff(), 1e-11);
    const InterfaceEnergies& after = interface.energies();
    EXPECT_NEAR(after.friction, before.friction, 1e-9 * before.stored);
    EXPECT_NEAR(after.stored, before.stored, 1e-9 * before.stored);
  }
}

/// Energy of nodes that leave and re-enter over the partner's edge: the books close to second order in the step, for
/// only what a change of triangle or of the stick spring's share puts in is booked as `edge`.
TEST(LayerInterface, PassingThePartnersEdgeAndComingBackClosesTheBooksToSecondOrder) {
  const auto residual = [](int steps) {
    ContactLayer lower(make_turned_rectangle(6, 6, 1.1, 0), 1), upper(make_turned_rectangle(4, 3, 0.9, 1, 0.2), 1);
    LayerInterface interface(kLaw, lower.geometry, upper.geometry);
    const auto press = [](double s) { return Vector3(s, 0.7 * s, -0.02); };
    upper.move([&](Vector3 x) { return Vector3(x + press(0)); });
    interface.update(0);
    const double before = interface.energies().stored, start = interface.energies().residual();
    double largest = 0;
    for (int n = 1; n <= steps; ++n) {
      const double s = 0.6 * std::sin(2 * M_PI * n / steps);
      lower.move([](Vector3 x) { return x; });
      upper.move([&](Vector3 x) { return Vector3(x + press(s)); });
      interface.update(1.0 / steps);
      largest = std::max(largest, std::abs(interface.energies().residual() - start));
    }
    EXPECT_GT(interface.energies().friction, before);
    return largest / before;
  };
  const double coarse = residual(500), fine = residual(1000);
  EXPECT_LT(fine, 1e-3);
  EXPECT_LT(fine, 0.6 * coarse);
}

/// A cylinder of radius R about the y axis.
class Cylinder : public SignedDistance {
 public:
  explicit Cylinder(double radius) : radius_(radius) {}
  Distance evaluate(const Vector3& x) const override {
    const double r = std::hypot(x.x(), x.z());
    return {.value = r - radius_, .gradient = Vector3(x.x() / r, 0, x.z() / r)};
  }

 private:
  double radius_;
};

/// What a tool feels is what its layer does not: force and moment, friction included.
TEST(ToolInterface, ForceAndMomentOnTheToolAreMinusThoseOnTheLayer) {
  ContactLayer sheet(make_turned_rectangle(6, 4, 0.8, 0, 0.3), 1);
  Tool tool{.name = "drum", .shape = std::make_unique<Cylinder>(20), .z = -20.4};
  ToolInterface interface(kLaw, sheet.geometry, tool);
  sheet.move([](Vector3 x) { return Vector3(x.x(), x.y(), -x.x() * x.x() / 40); });
  interface.update(0);
  for (int n = 1; n <= 20; ++n) {
    sheet.move([&](Vector3 x) { return Vector3(x.x() + 0.01 * n, x.y() - 0.02 * n, -x.x() * x.x() / 40 - 0.002 * n); });
    interface.update(1e-4);
    Moment moment;
    moment.add(sheet.geometry.positions(), interface.force_on_layer());
    EXPECT_GT(tool.force.norm(), 1);
    EXPECT_GT(interface.points().acting_traction().abs().maxCoeff(), 0.1);
    EXPECT_LT((total(interface.force_on_layer()) + tool.force).norm(), 1e-12 * tool.force.norm());
    EXPECT_LT((moment.sum + tool.moment).norm(), 1e-12 * moment.scale);
  }
}

/// add_rates_to() bounds the largest eigenvalue of M^-1 K, K by central differences of the forces: with the normals'
/// turning, for layers of unlike thickness and meshes about as fine as they are thick.
TEST(LayerInterface, RatesBoundTheStiffnessWithTurningNormals) {
  for (const double thickness : {0.3, 1.0, 2.0}) {
    ContactLayer lower(make_turned_rectangle(4, 4, 1.0, 0), thickness),
        upper(make_turned_rectangle(4, 4, 1.0, 0.5 * thickness + 0.5), 1);
    const InterfaceLaw law{.stiffness = 500, .tangential = 500, .friction = 100};
    const auto n_lower = static_cast<int>(lower.mesh.n_nodes()), n = n_lower + static_cast<int>(upper.mesh.n_nodes());
    const auto compute_forces = [&](int dof, double amount) {
      LayerInterface interface(law, lower.geometry, upper.geometry);
      const auto place = [&](double by) {
        NodalVectors x = lower.mesh.reference, y = upper.mesh.reference;
        y.row(2) -= 0.004;
        (dof < 3 * n_lower ? x(dof % 3, dof / 3) : y(dof % 3, dof / 3 - n_lower)) += by;
        lower.geometry.move_to(x);
        upper.geometry.move_to(y);
      };
      place(0);
      place(0);  // at rest: an increment left from the last column would load the stick springs
      interface.update(0);
      place(amount);
      interface.update(1e-3);
      Eigen::VectorXd f(3 * n);
      for (int i = 0; i < n; ++i)
        for (int d = 0; d < 3; ++d)
          f(3 * i + d) = i < n_lower ? interface.force_on_lower()(d, i) : interface.force_on_upper()(d, i - n_lower);
      return f;
    };
    const double step = 1e-5;
    Eigen::MatrixXd k(3 * n, 3 * n);
    Eigen::VectorXd inverse_root_mass(3 * n);
    for (int dof = 0; dof < 3 * n; ++dof) {
      k.col(dof) = (compute_forces(dof, -step) - compute_forces(dof, step)) / (2 * step);
      const int i = dof / 3;
      inverse_root_mass(dof) =
          1 / std::sqrt(i < n_lower ? lower.geometry.mass()(i) : upper.geometry.mass()(i - n_lower));
    }
    const Eigen::MatrixXd a =
        inverse_root_mass.asDiagonal() * (0.5 * (k + k.transpose())) * inverse_root_mass.asDiagonal();
    const double largest = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a).eigenvalues().maxCoeff();
    Rates lower_rates(lower.mesh.n_nodes()), upper_rates(upper.mesh.n_nodes());  // of rows over both layers
    LayerInterface interface(law, lower.geometry, upper.geometry);
    interface.update(0);
    interface.add_rates_to({lower_rates, lower_rates}, {upper_rates, upper_rates});
    const double bound = std::max(lower_rates.stiffness.maxCoeff(), upper_rates.stiffness.maxCoeff());
    EXPECT_LE(largest, bound) << thickness;
    EXPECT_GT(largest, 0.2 * bound) << thickness;
  }
}

}  // namespace
