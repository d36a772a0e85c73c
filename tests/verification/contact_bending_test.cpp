/// V14: friction between layers that bend: where it acts is right.
#include <gtest/gtest.h>

#include <cmath>

#include "support/contact_layer.hpp"
#include "support/results.hpp"

namespace {

using namespace interply;
using contact::Vector3;
using test::ContactLayer;

/// Two strips bent to concentric cylinders about the y axis, each without stretch of its own midsurface: node at arc
/// length s of the lower one at angle s kappa, of the upper one, h_now further in, at s kappa_u, 1/kappa_u =
/// 1/kappa - h_now.
struct BentStack {
  static constexpr double kHeight = 1.5, kDepth = 0.004, kLength = 20, kPressure = 500 * kDepth, kFriction = 0.2;
  ContactLayer lower, upper;
  contact::LayerInterface interface;

  BentStack(double h, double h_upper)
      : lower(mechanics::make_rectangle({-kLength, kLength}, {-6, 6}, h, 0), 1.0),
        upper(mechanics::make_rectangle({-1.3 * kLength, 1.3 * kLength}, {-9, 9}, h_upper, kHeight - kDepth), 2.0),
        interface({.stiffness = 500, .tangential = 5e4, .friction = kFriction}, lower.geometry, upper.geometry) {
    interface.update(0);
  }
  /// Bends from flat to `kappa` (1/mm, of the lower midsurface) in equal steps of curvature.
  void bend(double kappa, int steps) {
    const double apart = kHeight - kDepth;
    for (int n = 1; n <= steps; ++n) {
      const double k = kappa * n / steps, radius = 1 / k, inner = radius - apart;
      const auto roll = [&](double s, double y, double r) {
        return Vector3(r * std::sin(s / r), y, radius - r * std::cos(s / r));
      };
      lower.move([&](Vector3 x) { return roll(x.x(), x.y(), radius); });
      upper.move([&](Vector3 x) { return roll(x.x(), x.y(), inner); });
      interface.update(1e-3);
    }
  }
};

/// Slip of the material points that face each other, from kinematics: the lower surface at a_l above its midsurface
/// closes by s a_l dkappa, the upper one's opposite point at s_u = s kappa/kappa_u opens by s_u a_u dkappa_u. With
/// 1/kappa_u = 1/kappa - d that integrates to s (a_l kappa - (a_u/d) ln(1 - d kappa)), which is kappa d s for a thin
/// stack.
double compute_slip(double s, double kappa) {
  const double d = BentStack::kHeight - BentStack::kDepth, a_l = d / 3, a_u = 2 * d / 3;  // as half thicknesses 0.5, 1
  return s * (a_l * kappa - a_u / d * std::log(1 - d * kappa));
}

TEST(BendingOfTwoPlates, SlipIsCurvatureTimesDistanceOfTheMidsurfaces) {
  const double kappa = 1.0 / 100;
  std::vector<double> sizes{4, 2, 1}, slip_error, work_error;
  double slip_at_end = 0, work = 0, exact_work = 0;
  const double exact_slip = compute_slip(BentStack::kLength - 4, kappa);
  for (const double h : sizes) {
    BentStack stack(h, 0.7 * h);
    stack.bend(kappa, 400);
    const contact::Points& p = stack.interface.points();
    // a line of nodes 4 mm from the free end; the elastic stick belongs to the relative motion
    slip_at_end = exact_work = 0;
    int nodes = 0;
    for (int i = 0; i < p.size(); ++i) {
      const Vector3 x = mechanics::at(stack.lower.mesh.reference, i);
      exact_work += BentStack::kFriction * BentStack::kPressure * p.area(i) * compute_slip(std::abs(x.x()), kappa);
      if (std::abs(x.x() - (BentStack::kLength - 4)) > 1e-9 || std::abs(x.y()) > 3) continue;
      slip_at_end += p.slip(i) + mechanics::at(p.stick, i).norm();
      ++nodes;
    }
    slip_at_end /= nodes;
    const contact::InterfaceEnergies& e = stack.interface.energies();
    const double stuck = 0.5 * 5e4 * (p.area * p.stick.square().colwise().sum().transpose()).sum();
    work = e.friction + 2 * stuck;  // a spring that slides keeps half of what its first stretch cost
    slip_error.push_back(slip_at_end - exact_slip);
    work_error.push_back(work - exact_work);
  }
  test::expect_result({.row = "V14",
                       .quantity = "slip between two plates bent to a cylinder, 1/kappa = 100 mm",
                       .source = "kappa x distance of the midsurfaces x arc length",
                       .reference = exact_slip,
                       .ours = slip_at_end,
                       .unit = "mm",
                       .mesh = "1 mm against 0.7 mm"});
  test::expect_result({.row = "V14",
                       .quantity = "friction work of the same bending",
                       .source = "integral of mu p slip",
                       .reference = exact_work,
                       .ours = work,
                       .unit = "mJ",
                       .mesh = "1 mm against 0.7 mm",
                       .order = test::compute_order(sizes, work_error)});
  for (const double error : slip_error) EXPECT_LT(std::abs(error), 1e-3 * exact_slip);  // whatever the mesh
}

/// A pressed pair with friction turned by 90 degrees about an axis in its plane.
TEST(RigidRotation, OfAPressedPairCostsNoWork) {
  ContactLayer lower(mechanics::make_rectangle({-10, 10}, {-8, 8}, 2, 0), 1),
      upper(mechanics::make_rectangle({-12, 12}, {-10, 10}, 1.5, 0.996), 1);
  contact::LayerInterface interface({.stiffness = 500, .tangential = 500, .friction = 0.25}, lower.geometry,
                                    upper.geometry);
  interface.update(0);
  const Vector3 pressed = test::total(interface.force_on_upper());
  for (int n = 1; n <= 300; ++n) {
    const Eigen::AngleAxisd turn(M_PI / 2 * n / 300, Vector3(1, 0.4, 0).normalized());
    lower.move([&](Vector3 x) { return Vector3(turn * x); });
    upper.move([&](Vector3 x) { return Vector3(turn * x); });
    interface.update(1e-3);
  }
  const Vector3 turned = Eigen::AngleAxisd(M_PI / 2, Vector3(1, 0.4, 0).normalized()) * pressed;
  const double force = (test::total(interface.force_on_upper()) - turned).norm() / pressed.norm();
  const double wrong = pressed.norm() * 0.25 * M_PI / 2;  // mu N omega h, if slip were that of the midsurfaces
  test::expect_result({.row = "V14",
                       .quantity = "friction work of a pressed pair turned by 90 deg (mu N h pi/2 if wrong)",
                       .source = "rigid motion",
                       .reference = 0,
                       .ours = interface.energies().friction,
                       .unit = "mJ",
                       .tolerance = 1e-9 * wrong,
                       .absolute = true,
                       .mesh = "2 mm against 1.5 mm, 300 steps"});
  test::expect_result({.row = "V14",
                       .quantity = "force of the turned pair against the turned force, relative difference",
                       .source = "rigid motion",
                       .reference = 0,
                       .ours = force,
                       .tolerance = 1e-9,
                       .absolute = true,
                       .mesh = "2 mm against 1.5 mm, 300 steps"});
}

}  // namespace
