/// V7: a net of inextensible fibres on a hemisphere with its two generators through the pole.
///
/// Such a net is a Chebyshev net: metric dx^2 + dy^2 + 2 sin(gamma) dx dy on the Gauss curvature 1/R^2, so that
///   gamma,xy = cos(gamma)/R^2,
/// and with both generators geodesic, gamma depends on z = x y/R^2 alone: z g'' + g' = cos g, g(0) = 0 (V7).
#include <gtest/gtest.h>

#include <memory>

#include "support/fabric_cases.hpp"
#include "support/results.hpp"
#include "support/static_ply.hpp"

namespace interply {
namespace {

using namespace fabric_cases;
using test::StaticPly;

/// Shear angle of the net on the bisector of the generators, at the polar angle `polar`, both rad: x = y = R u, so with
/// z = u^2 the equation is g_uu + g_u/u = 4 cos g, and the arc along the bisector has d(polar)/du = sqrt(2 (1 + sin
/// g)). Runge-Kutta of fourth order from the series g = u^2 near the pole.
double compute_net_shear(double polar) {
  const auto rate = [](double u, const Eigen::Array3d& y) {  // g, g_u, polar angle
    return Eigen::Array3d(y(1), 4 * std::cos(y(0)) - y(1) / u, std::sqrt(2 * (1 + std::sin(y(0)))));
  };
  const double h = 1e-5;
  double u = 1e-4;
  Eigen::Array3d y(u * u, 2 * u, std::sqrt(2.0) * u), before = y;
  while (y(2) < polar) {
    before = y;
    const Eigen::Array3d k1 = rate(u, y), k2 = rate(u + h / 2, y + h / 2 * k1), k3 = rate(u + h / 2, y + h / 2 * k2),
                         k4 = rate(u + h, y + h * k3);
    y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    u += h;
  }
  return before(0) + (y(0) - before(0)) * (polar - before(2)) / (y(2) - before(2));
}

TEST(Hemisphere, EquationOfTheNetGivesTheAnglesOfMechanicsV7) {
  for (const auto& [polar, shear] : {std::pair{30, 7.5}, std::pair{45, 16.1}, std::pair{60, 27.0}, std::pair{75, 39.3}})
    EXPECT_NEAR(compute_net_shear(polar * kDegree) / kDegree, shear, 0.06) << polar;  // 26.95 printed as 27.0
}

constexpr double kRadius = 50;  // mm

/// One quadrant of a ply draped over the hemisphere: springs hold every node to a sphere through the pole, which starts
/// flat and closes in ten steps, each to its equilibrium; the two generators stay in their planes of symmetry. Without
/// shear stiffness the net alone decides: with it, the edges and the generators carry the shear stress of their
/// neighbourhood as a finite force in a row of cells, which kinks where it is compression.
/// @param n  cells along a generator, which ends at 51.6 deg
std::unique_ptr<StaticPly> drape_quadrant(int n) {
  const double length = 0.9 * kRadius;
  const auto mesh = mechanics::make_rectangle({0, length}, {0, length}, length / n);
  scene::WovenLaw law = test::make_net_law(1e4);
  law.s = {0, 0, 0};
  auto draped = std::make_unique<StaticPly>(mesh, law, 0);
  StaticPly& ply = *draped;
  ply.free.row(0) = (mesh.reference.row(0) > 0).cast<double>();
  ply.free.row(1) = (mesh.reference.row(1) > 0).cast<double>();
  ply.free(2, 0) = 0;  // the pole, at the origin
  double radius = 0;
  test::Support sphere{1000, {}};  // N/mm
  sphere.add_to = [&](const mechanics::NodalVectors& x, mechanics::NodalVectors& force) {
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const Eigen::Vector3d p = mechanics::at(x, i) + Eigen::Vector3d(0, 0, radius);
      mechanics::add_at(force, i, sphere.stiffness * (1 - radius / p.norm()) * p);
    }
  };
  for (int i = 1, closing = 10; i <= closing; ++i) {
    radius = kRadius * closing / i;
    for (Eigen::Index k = 1; k < mesh.n_nodes(); ++k) {
      const Eigen::Vector3d p = mechanics::at(ply.position, k) + Eigen::Vector3d(0, 0, radius);
      ply.position.col(k) = radius * p.normalized().array() - Eigen::Array3d(0, 0, radius);
    }
    ply.relax(i < closing ? 1e-2 : 1e-4, sphere);
  }
  ply.position.row(2) += kRadius;  // centre of the sphere at the origin
  EXPECT_LT((ply.position.matrix().colwise().norm().array() - kRadius).abs().maxCoeff(), 1e-6 * kRadius);
  EXPECT_LT(ply.largest_fibre_strain(), 1e-6);
  return draped;
}

/// Shear angle at a polar angle on the bisector, rad: the mean of both triangles stands for the middle of its cell;
/// between the cells (0, -, gamma even about the pole) a parabola through the nearest three.
double read_bisector(const StaticPly& ply, int n, double polar) {
  const auto gamma = ply.field("shear_angle");
  std::vector<double> at, value;
  for (int i = 0; i < n; ++i) {
    const auto cell = static_cast<std::size_t>(i * n + i);
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const int node : {i * (n + 2), (i + 1) * (n + 2)}) middle += mechanics::at(ply.position, node) / 2;
    at.push_back(std::atan2(middle.head(2).norm(), middle.z()));
    value.push_back((gamma[2 * cell] + gamma[2 * cell + 1]) / 2);
  }
  std::size_t k = 1;
  while (k + 2 < at.size() && at[k] < polar) ++k;
  double sum = 0;
  for (std::size_t i = k - 1; i <= k + 1; ++i) {
    double weight = 1;
    for (std::size_t j = k - 1; j <= k + 1; ++j)
      if (j != i) weight *= (polar - at[j]) / (at[i] - at[j]);
    sum += weight * value[i];
  }
  return sum;
}

TEST(Hemisphere, NetOfStiffFibresShearsAsTheInextensibleNet) {
  const std::vector<int> cells{8, 16, 32};
  std::vector<double> h;
  std::vector<std::vector<double>> shear;
  for (const int n : cells) {
    const auto draped = drape_quadrant(n);
    const StaticPly& ply = *draped;
    h.push_back(0.9 * kRadius / n);
    shear.emplace_back();
    for (const int polar : {30, 45, 60, 75}) shear.back().push_back(read_bisector(ply, n, polar * kDegree) / kDegree);
  }
  std::size_t k = 0;
  for (const int polar : {30, 45, 60, 75}) {
    const double exact = compute_net_shear(polar * kDegree) / kDegree;
    std::vector<double> error;
    for (const auto& s : shear) error.push_back(s[k] - exact);
    const double order = test::compute_order(h, error);
    EXPECT_NEAR(order, 2, 0.3) << polar << " deg";
    test::expect_result(
        {.row = "V7",
         .quantity = "shear angle of the net on a hemisphere, bisector, polar angle " + std::to_string(polar) + " deg",
         .source = "z g'' + g' = cos g, Runge-Kutta in the test",
         .reference = exact,
         .ours = shear.back()[k],
         .unit = "deg",
         .mesh = "R/36, aligned",
         .order = order});
    ++k;
  }
}

}  // namespace
}  // namespace interply
