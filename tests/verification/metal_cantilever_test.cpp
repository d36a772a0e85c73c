/// The elastic cantilever at large rotation against the elastica.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/results.hpp"
#include "support/static_metal.hpp"

namespace interply::metal::test {
namespace {

using namespace interply::test;

constexpr double kLength = 50, kThickness = 1.5, kYoung = 210e3;

/// Elastica of a strip that stretches, with a dead transverse force P at its tip: EI theta'' = -P cos(theta) (1 + e),
/// e = P sin(theta)/(EA), theta(0) = 0, theta'(L) = 0; arc length and force scaled to 1. The stretch is 3e-4 of the
/// deflection at 80 deg for the strip of the tests.
struct Elastica {
  double load = 0;        ///< P L^2/(E I)
  double deflection = 0;  ///< across / L
  double shortening = 0;  ///< along / L
};

/// Integrates from the tip (theta = rotation, theta' = 0) to the clamp (theta = 0) by RK4, the scaled length by Newton.
/// @param slenderness  I/(A L^2)
Elastica solve_elastica(double rotation, double slenderness) {
  const int n = 2000;
  struct State {
    double theta, slope, across, along;
  };
  double length = std::sqrt(2 * rotation);  // L sqrt(P/EI)
  const auto rate = [&](const State& y) {
    const double stretch = 1 + slenderness * length * length * std::sin(y.theta);
    return State{y.slope, -std::cos(y.theta) * stretch, std::sin(y.theta) * stretch, std::cos(y.theta) * stretch};
  };
  const auto add = [](const State& y, double h, const State& k) {
    return State{y.theta + h * k.theta, y.slope + h * k.slope, y.across + h * k.across, y.along + h * k.along};
  };
  State y{};
  for (int iteration = 0; iteration < 50; ++iteration) {
    y = {rotation, 0, 0, 0};
    const double h = length / n;
    for (int i = 0; i < n; ++i) {
      const State k1 = rate(y), k2 = rate(add(y, h / 2, k1)), k3 = rate(add(y, h / 2, k2)), k4 = rate(add(y, h, k3));
      y = add(add(add(add(y, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
    }
    length -= y.theta / y.slope;
  }
  return {length * length, y.across / length, 1 - y.along / length};
}

TEST(Elastica, AgreesWithBeamTheoryWhereTheRotationIsSmall) {
  const double rotation = 1e-3;
  const Elastica e = solve_elastica(rotation, 0);
  EXPECT_NEAR(e.load, 2 * rotation, 1e-5 * rotation);
  EXPECT_NEAR(e.deflection, 2 * rotation / 3, 1e-5 * rotation);
}

struct Tip {
  double rotation = 0;    ///< of the chord of the last row of cells, deg
  double deflection = 0;  ///< mm
  double shortening = 0;  ///< mm
};

/// Strip along y, clamped by the plane of symmetry at y = 0; nu = 0, so that neither the width nor what holds it across
/// the clamp plays a part.
class Cantilever {
 public:
  Cantilever(Pattern pattern, double h)
      : width_(3 * h),
        sheet_(make_static_sheet(make_sheet(make_elastic(kYoung, 0), 3, kThickness),
                                 make_sheet_mesh(pattern, {0, 3 * h}, {0, kLength}, h, true,
                                                 [h](double, double y) { return y > kLength - 1.5 * h; }))) {
    sheet_.hold([](double, double y) { return y == 0; }, true, true, true);
    for (Eigen::Index i = 0; i < sheet_.mesh.n_nodes(); ++i) {
      const double x = sheet_.mesh.reference(0, i), y = sheet_.mesh.reference(1, i);
      const double weight = (x == 0 || x == width_ ? 0.5 : 1.0) * h / width_;
      if (y == kLength) tip_.push_back({i, weight});
      if (std::abs(y - kLength + h) < 1e-9) before_tip_.push_back({i, weight});
    }
  }

  /// Dead force across at the tip, P L^2/(E I) from `from` to `to`.
  Tip load(double from, double to) {
    const double inertia = width_ * std::pow(kThickness, 3) / 12;
    const double unit = kYoung * inertia / (kLength * kLength);
    const double frequency = 3.516 / (kLength * kLength) * std::sqrt(kYoung / (12 * kDensity)) * kThickness;
    sheet_.run({.force =
                    [&](double s, const NodalVectors&, NodalVectors& f) {
                      for (const auto& [node, weight] : tip_) f(2, node) += (from + s * (to - from)) * unit * weight;
                    },
                .damping = 2 * frequency,
                .ramp = 2 / frequency,
                .tolerance = 2e-5});
    const mechanics::Vector3 end = mean(tip_), before = mean(before_tip_), chord = end - before;
    return {std::atan2(chord.z(), chord.y()) * 180 / std::numbers::pi, end.z(), kLength - end.y()};
  }

 private:
  using Weighted = std::vector<std::pair<Eigen::Index, double>>;
  mechanics::Vector3 mean(const Weighted& nodes) const {
    mechanics::Vector3 sum = mechanics::Vector3::Zero();
    for (const auto& [node, weight] : nodes) sum += weight * mechanics::at(sheet_.position, node);
    return sum;
  }

  double width_;
  StaticSheet sheet_;
  Weighted tip_, before_tip_;
};

class LargeRotation : public testing::TestWithParam<Pattern> {};

TEST_P(LargeRotation, FollowsTheElasticaAndConverges) {
  const std::vector<double> sizes = {5, 10.0 / 3, 2.5};
  const std::vector<int> degrees = {10, 45, 80};
  std::vector<Elastica> exact;
  const double slenderness = std::pow(kThickness / kLength, 2) / 12;
  for (const int degree : degrees) exact.push_back(solve_elastica(degree * std::numbers::pi / 180, slenderness));
  std::vector<std::vector<Tip>> tips(degrees.size());
  for (const double h : sizes) {
    Cantilever beam(GetParam(), h);
    for (std::size_t i = 0; i < degrees.size(); ++i)
      tips[i].push_back(beam.load(i ? exact[i - 1].load : 0, exact[i].load));
  }
  for (std::size_t i = 0; i < degrees.size(); ++i) {
    const auto report = [&](const std::string& name, double reference, double Tip::*value, const std::string& unit) {
      std::vector<double> error;
      for (const Tip& tip : tips[i]) error.push_back(tip.*value - reference);
      const double order = compute_order(sizes, error);
      expect_result({.row = "V10",
                     .quantity = "cantilever, " + std::to_string(degrees[i]) + " deg: " + name,
                     .source = "elastica with stretch, RK4 in the test",
                     .reference = reference,
                     .ours = tips[i].back().*value,
                     .unit = unit,
                     .mesh = describe_mesh(sizes.back(), GetParam()),
                     .order = order});
      return order;
    };
    const double deflection = report("deflection of the tip", exact[i].deflection * kLength, &Tip::deflection, "mm");
    const double shortening = report("shortening", exact[i].shortening * kLength, &Tip::shortening, "mm");
    EXPECT_GT(deflection, 1.8);
    // of a second-order quantity: terms of (t kappa)^2/12 = 3e-4 that thin-shell theory drops are seen on the finest
    // mesh
    EXPECT_GT(shortening, 1.6);
    expect_result({.row = "V10",
                   .quantity = "cantilever, " + std::to_string(degrees[i]) + " deg: rotation of the last elements",
                   .source = "elastica with stretch, RK4 in the test",
                   .reference = static_cast<double>(degrees[i]),
                   .ours = tips[i].back().rotation,
                   .unit = "deg",
                   .mesh = describe_mesh(sizes.back(), GetParam())});
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, LargeRotation, testing::Values(Pattern::Alternating, Pattern::Unstructured), to_name);

}  // namespace
}  // namespace interply::metal::test
