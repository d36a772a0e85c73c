/// The distances of the kernel of tools against the plain form, and its targets against each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "contact/rows.hpp"
#include "contact/signed_distance.hpp"
#include "support/simd_target.hpp"

namespace {

using namespace interply::contact;
using interply::mechanics::NodalVectors;
using interply::mechanics::Scalars;
using interply::test::is_on_this_machine;
using interply::test::Target;

constexpr double kMargin = 0.25;

/// Nodes at given places against a frictionless tool of unit stiffness, so that the force on a node is its penetration.
struct Nodes {
  std::vector<Node> node;
  Scalars slack;
  Points points;
  std::vector<Quad> force;
  double half_thickness;

  Nodes(const std::vector<Vector3>& x, double half_thickness)
      : node(x.size()),
        slack(Scalars::Zero(size())),
        points(Scalars::Ones(size()), 1),
        force(2 * x.size()),
        half_thickness(half_thickness) {
    for (std::size_t i = 0; i < x.size(); ++i) node[i].position = {x[i].x(), x[i].y(), x[i].z(), half_thickness};
    points.gap.setConstant(100);
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(node.size()); }
  /// @param z  of the tool    @param increment  of the same
  bool advance(const SignedDistance& tool, double z = 0, double increment = 0) {
    return choose_tool_kernels()
        .advance(tool.to_shape(),
                 {.law = {.stiffness = 1, .tangential = 1},
                  .dt = 1,
                  .z = z,
                  .increment = increment,
                  .margin = kMargin,
                  .layer = node.data(),
                  .slack = slack.data(),
                  .points = get_rows(points),
                  .force = force.data()},
                 0, size())
        .touches;
  }
  Distance distance(Eigen::Index i) const {
    const Quad& f = force[static_cast<std::size_t>(2 * i)];
    return {points.gap(i) + half_thickness, Vector3(f.x, f.y, f.z) / -points.gap(i)};
  }
  Scalars collect() const {
    Scalars all(5 * size());
    for (Eigen::Index i = 0; i < size(); ++i) {
      const Quad& f = force[static_cast<std::size_t>(2 * i)];
      all.segment(5 * i, 5) << slack(i), points.gap(i), f.x, f.y, f.z;
    }
    return all;
  }
};
constexpr double kThick = 1000;  ///< half thickness at which all nodes touch wherever they are, mm
constexpr double kThin = 0.5;

/// A tool that the kernel does not know.
class Plain : public SignedDistance {
 public:
  Distance evaluate(const Vector3& x) const override { return punch_.evaluate(x); }

 private:
  PyramidPunch punch_{100, 50, 15};
};

struct Case {
  std::string name;
  std::function<std::unique_ptr<SignedDistance>()> make;
  double sharp;   ///< value where the gradient is that of a line or of a sharp body's surface, mm
  bool is_punch;  ///< else a plate, whose gradient jumps in the middle of the opening
};
const Case kCases[] = {
    {"punch", [] { return std::make_unique<PyramidPunch>(100, 50, 15); }, -15, true},
    {"flat_punch", [] { return std::make_unique<PyramidPunch>(100, 10, 5); }, -5, true},  // obtuse at the apex
    {"steep_punch", [] { return std::make_unique<PyramidPunch>(60, 150, 8); }, -8, true},
    {"die", [] { return std::make_unique<OpeningPlate>(100, 22, 10, true); }, -10, false},
    {"blank_holder", [] { return std::make_unique<OpeningPlate>(100, 22, 10, false); }, -10, false},
    {"sharp_opening", [] { return std::make_unique<OpeningPlate>(100, 0, 10, true); }, -10, false},
    {"no_kernel", [] { return std::make_unique<Plain>(); }, -15, true},
};

/// Those of make_points() that may lie between two sides of the triangle.
bool is_in_the_middle(Eigen::Index i) { return i % 5 == 1 || i % 5 == 2; }

/// Points all around the tools: at random; on the plane of symmetry and in those of the other corners; near the planes
/// in which the bases of the pyramids and the flat land lie; near the tip.
std::vector<Vector3> make_points(int n) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> across(-150, 150), up(-60, 120), near(-1, 1);
  std::vector<Vector3> x;
  for (int i = 0; i < n; ++i) {
    Vector3 p(across(random), across(random), up(random));
    if (i % 5 == 1) p.y() = 0;
    if (i % 5 == 2) p.head<2>() = std::abs(p.x()) * Vector2(-0.5, (i % 2 ? 1 : -1) * std::sqrt(0.75));
    if (i % 5 == 3) p.z() = (i % 2 ? 65 : 0) + near(random);
    if (i % 5 == 4) p *= 0.2;
    x.push_back(p);
  }
  return x;
}

class ToolKernels : public testing::TestWithParam<const char*> {
  void SetUp() override {
    if (!is_on_this_machine(GetParam())) GTEST_SKIP() << "not on this machine";
  }
};
INSTANTIATE_TEST_SUITE_P(Targets, ToolKernels, testing::Values("scalar", "avx2", "avx512"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(ToolKernels, AgreeWithThePlainForm) {
  const Target target(GetParam());
  const std::vector<Vector3> x = make_points(20003);
  for (const Case& c : kCases) {
    const auto tool = c.make();
    Nodes nodes(x, kThick);
    EXPECT_TRUE(nodes.advance(*tool));
    int land = 0, slanted = 0, inside = 0;
    for (Eigen::Index i = 0; i < nodes.size(); ++i) {
      const Vector3& p = x[static_cast<std::size_t>(i)];
      const Distance d = tool->evaluate(p), fast = nodes.distance(i);
      ASSERT_NEAR(fast.value, d.value, 1e-12) << c.name << " at " << p.transpose();
      ASSERT_NEAR(fast.gradient.norm(), 1, 1e-12);
      ASSERT_EQ(nodes.slack(i), 0);
      double arm = std::abs(d.value - c.sharp);  // the gradient is a difference of points over it
      if (!c.is_punch) {
        Vector2 outward;  // across the opening it is one from its triangle
        const double outside = Triangle2(100).distance(p.head<2>(), outward);
        if (outside > 0) arm = std::min(arm, outside);
      }
      const bool is_deep = c.is_punch ? d.value <= c.sharp : d.value > 0;
      if (!is_deep || !is_in_the_middle(i)) {
        ASSERT_LT((fast.gradient - d.gradient).norm(), 1e-12 * std::max(1.0, 0.1 / arm))
            << c.name << " at " << p.transpose();
      }
      land += std::abs(d.gradient.z()) == 1;
      slanted += std::abs(d.gradient.z()) > 0.01 && std::abs(d.gradient.z()) < 0.99;
      inside += d.value < c.sharp;
    }
    EXPECT_GT(slanted, 300) << c.name;
    EXPECT_GT(inside, 300) << c.name;
    if (!c.is_punch) {
      EXPECT_GT(land, 300) << c.name;
    }
  }
}

TEST_P(ToolKernels, LookOnlyAtNodesWithoutSlackAndSayWhetherOneTouches) {
  const Target target(GetParam());
  for (const Case& c : kCases) {
    const auto tool = c.make();
    Nodes nodes(make_points(1003), kThin);
    for (Eigen::Index i = 0; i < nodes.size(); ++i) {
      nodes.slack(i) = i % 3 == 0 || i >= 512 ? 10 : i % 3 == 1 ? 0.05 : 0;
      nodes.node[static_cast<std::size_t>(i)].increment = {0.03, -0.04, 0.02, 0};
    }
    nodes.advance(*tool, 3, -0.10);  // the path is |(0.03, -0.04, 0.12)| = 0.13
    for (Eigen::Index i = 0; i < nodes.size(); ++i) {
      if (i % 3 == 0 || i >= 512) {
        ASSERT_NEAR(nodes.slack(i), 9.87, 1e-12);
        ASSERT_EQ(nodes.points.gap(i), 100);
        ASSERT_EQ(nodes.distance(i).gradient.norm(), 0);
      } else {
        const Quad& x = nodes.node[static_cast<std::size_t>(i)].position;
        ASSERT_NEAR(nodes.points.gap(i), tool->evaluate({x.x, x.y, x.z - 3}).value - kThin, 1e-12);
        ASSERT_EQ(nodes.slack(i), std::max(nodes.points.gap(i) - kMargin, 0.0));
      }
    }
  }
  // one node after the other comes to the land of a die
  const OpeningPlate die(100, 22, 10, true);
  for (std::size_t touching = 0; touching < 19; ++touching) {
    Nodes nodes(std::vector<Vector3>(19, Vector3(140, 0, 2)), kThin);
    EXPECT_FALSE(nodes.advance(die));
    nodes.slack.setZero();
    nodes.node[touching].position.z = kThin - 0.01;
    EXPECT_TRUE(nodes.advance(die)) << touching;
    for (std::size_t i = 0; i < 19; ++i) EXPECT_NEAR(nodes.force[2 * i].z, i == touching ? 0.01 : 0, 1e-12);
    nodes.node[touching].position.z = 2;
    EXPECT_TRUE(nodes.advance(die)) << touching;  // it did
    EXPECT_FALSE(nodes.advance(die)) << touching;
  }
}

const char* const kTargets[] = {"scalar", "avx2", "avx512"};

TEST(ToolKernelWidth, DoesNotChangeABitOfADistance) {
  for (const Case& c : kCases)
    for (const double half_thickness : {kThin, kThick}) {
      std::vector<Scalars> all;
      for (const char* name : kTargets) {
        if (!is_on_this_machine(name)) continue;
        const Target target(name);
        const auto tool = c.make();
        Nodes nodes(make_points(3007), half_thickness);
        for (Eigen::Index i = 0; i < nodes.size(); ++i) {
          nodes.slack(i) = i % 7 == 0 ? 0.6 : 0;
          const double t = static_cast<double>(i);
          nodes.node[static_cast<std::size_t>(i)].increment = {0.03 * std::sin(t), -0.04, 0.02 * std::cos(t), 0};
        }
        for (int n = 0; n < 20; ++n) nodes.advance(*tool, -0.04 * n, -0.04);
        all.push_back(nodes.collect());
      }
      for (const Scalars& other : all) EXPECT_TRUE((other == all[0]).all()) << c.name;
    }
}

/// Each number of nodes that leaves a pack partly filled.
TEST(ToolKernelWidth, DoesNotChangeABitOfADistanceInPacksThatAreNotFull) {
  const std::vector<Vector3> x = make_points(400);
  for (const Case& c : kCases) {
    const auto tool = c.make();
    for (int n = 1; n < 17; ++n)
      for (int first = 0; first + n < 400; first += n) {
        std::vector<Scalars> all;
        for (const char* name : kTargets) {
          if (!is_on_this_machine(name)) continue;
          const Target target(name);
          Nodes nodes({x.begin() + first, x.begin() + first + n}, kThick);
          nodes.advance(*tool);
          all.push_back(nodes.collect());
        }
        for (const Scalars& other : all) ASSERT_TRUE((other == all[0]).all()) << c.name << " " << first << " " << n;
      }
  }
}

}  // namespace
