/// The kernels of contact against the plain form of its equations, and against each other.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <thread>

#include "support/contact_layer.hpp"
#include "support/simd_target.hpp"

namespace {

using namespace interply;
using namespace interply::contact;
using test::ContactLayer;
using test::make_turned_rectangle;
using test::Target;

const InterfaceLaw kLaw{.stiffness = 500, .tangential = 400, .damping = 1e-5, .friction = 0.25};

/// Two sheets of other meshes on a bowl, pressed and dragged over each other; part of the lower one is beyond the edge
/// of the upper one, part of the sheets does not touch. Neither has a number of nodes that fills whole packs or blocks.
struct SlidingPair {
  ContactLayer lower{make_turned_rectangle(10, 8, 0.8, 0), 1}, upper{make_turned_rectangle(9, 7, 0.7, 0.99, 0.3), 1.2};
  std::mt19937 random{3};

  void move(int n) {
    std::uniform_real_distribution<double> unit(-0.01, 0.01);
    const auto bowl = [](const Vector3& x) { return Vector3(x.x(), x.y(), x.z() + 0.03 * x.squaredNorm()); };
    const double s = 0.02 * n;
    lower.move([&](Vector3 x) { return Vector3(bowl(x) + Vector3(s + unit(random), 0.3 * s, unit(random))); });
    upper.move([&](Vector3 x) {
      return Vector3(bowl(x) + Vector3(0, unit(random), -0.1 + 0.3 * s + (x.x() > 4 ? 0.2 : 0.0)));
    });
    lower.geometry.set_half_thickness(Scalars::Constant(lower.mesh.n_nodes(), 0.5 - 1e-4 * n));
  }
};

/// Largest difference of two arrays, as a part of the largest value.
template <class Array>
double compare(const Array& a, const Array& b) {
  const double scale = b.abs().maxCoeff();
  return scale > 0 ? (a - b).abs().maxCoeff() / scale : a.abs().maxCoeff();
}

double compare(const Points& a, const Points& b) {
  double largest = 0;
  for (const auto field :
       {&Points::gap, &Points::weight, &Points::pressure, &Points::slip, &Points::friction_work, &Points::height})
    largest = std::max(largest, compare(a.*field, b.*field));
  return std::max(largest, compare(a.stick, b.stick));
}

double compare(const InterfaceEnergies& a, const InterfaceEnergies& b) {
  double largest = 0;
  for (const auto part : {&InterfaceEnergies::stored, &InterfaceEnergies::friction, &InterfaceEnergies::damping,
                          &InterfaceEnergies::thinning, &InterfaceEnergies::edge, &InterfaceEnergies::work})
    largest = std::max(largest, std::abs(a.*part - b.*part) / (std::abs(b.*part) + 1e-3 * std::abs(b.stored)));
  return largest;
}

class ContactKernels : public testing::TestWithParam<const char*> {
  void SetUp() override {
    if (!test::is_on_this_machine(GetParam())) GTEST_SKIP() << "not on this machine";
  }
};
INSTANTIATE_TEST_SUITE_P(Targets, ContactKernels, testing::Values("scalar", "avx2", "avx512"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(ContactKernels, OfLayersAgreeWithThePlainForm) {
  const Target target(GetParam());
  SlidingPair pair;
  LayerInterface fast(kLaw, pair.lower.geometry, pair.upper.geometry);
  LayerInterface plain(kLaw, pair.lower.geometry, pair.upper.geometry);
  fast.update(0);
  plain.update_plainly(0);
  int at_edges = 0, stuck = 0, sliding = 0, open = 0;
  for (int n = 1; n <= 150; ++n) {
    pair.move(n);
    fast.update(1e-5);
    plain.update_plainly(1e-5);
    const Points& p = fast.points();
    ASSERT_LT(compare(fast.force_on_lower(), plain.force_on_lower()), 1e-11) << n;
    ASSERT_LT(compare(fast.force_on_upper(), plain.force_on_upper()), 1e-11) << n;
    ASSERT_LT(compare(p, plain.points()), 1e-11) << n;
    ASSERT_LT(compare(fast.energies(), plain.energies()), 1e-11) << n;
    ASSERT_TRUE((p.state == plain.points().state).all()) << n;
    for (int i = 0; i < p.size(); ++i) at_edges += p.gap(i) < 0 && p.weight(i) > 0 && p.weight(i) < 1;
    stuck += (p.state == static_cast<int>(State::Stick)).count();
    sliding += (p.state == static_cast<int>(State::Slide)).count();
    open += (p.state == static_cast<int>(State::Open)).count();
  }
  for (const int seen : {at_edges, stuck, sliding, open}) EXPECT_GT(seen, 100);
}

TEST_P(ContactKernels, OfToolsAgreeWithThePlainForm) {
  const Target target(GetParam());
  ContactLayer sheet(make_turned_rectangle(10, 8, 0.5, -0.5, 0.2), 1);
  const auto make = [] { return Tool{.name = "punch", .shape = std::make_unique<PyramidPunch>(10, 5, 2), .z = 0}; };
  Tool fast_tool = make(), plain_tool = make();
  ToolInterface fast(kLaw, sheet.geometry, fast_tool), plain(kLaw, sheet.geometry, plain_tool);
  fast.update(0);
  plain.update_plainly(0);
  int touching = 0;
  for (int n = 1; n <= 200; ++n) {
    for (Tool* tool : {&fast_tool, &plain_tool}) {
      tool->increment = n < 150 ? -0.01 : 0.05;  // down, and off again
      tool->z += tool->increment;
    }
    sheet.move([&](Vector3 x) {
      return Vector3(x + Vector3(0.003 * n, 0, -0.007 * std::min(n, 150) * std::exp(-0.02 * x.squaredNorm())));
    });
    fast.update(1e-5);
    plain.update_plainly(1e-5);
    const double scale = plain_tool.force.norm() + 1e-3;
    ASSERT_LT(compare(fast.force_on_layer(), plain.force_on_layer()), 1e-11) << n;
    ASSERT_LT((fast_tool.force - plain_tool.force).norm(), 1e-11 * scale) << n;
    ASSERT_LT((fast_tool.moment - plain_tool.moment).norm(), 1e-10 * scale) << n;
    ASSERT_LT(compare(fast.points().slip, plain.points().slip), 1e-11) << n;
    ASSERT_LT(compare(fast.energies(), plain.energies()), 1e-11) << n;
    touching += (fast.points().gap < 0).count();
  }
  EXPECT_GT(touching, 1000);
  EXPECT_EQ(plain_tool.force.norm(), 0);
}

/// All that an interface gives, in one array.
Scalars collect(const LayerInterface& interface) {
  const Points& p = interface.points();
  const InterfaceEnergies& e = interface.energies();
  const Eigen::Index n = p.size(), m = interface.force_on_upper().size();
  Scalars all(9 * n + m + 6);
  all << interface.force_on_lower().reshaped(), interface.force_on_upper().reshaped(), p.stick.reshaped(), p.pressure,
      p.gap, p.slip, e.stored, e.friction, e.damping, e.thinning, e.edge, e.work;
  return all;
}

/// A sliding pair after some steps.
Scalars slide(const char* name, const BlockRunner& run) {
  const Target target(name);
  SlidingPair pair;
  LayerInterface interface(kLaw, pair.lower.geometry, pair.upper.geometry);
  interface.update(0, run);
  for (int n = 1; n <= 60; ++n) {
    pair.move(n);
    interface.update(1e-5, run);
  }
  return collect(interface);
}

/// Packs of four against packs of eight.
class ContactKernelWidth : public testing::Test {
  void SetUp() override {
    if (!test::is_on_this_machine("avx512")) GTEST_SKIP() << "not on this machine";
  }
};

TEST_F(ContactKernelWidth, DoesNotChangeABit) { EXPECT_TRUE((slide("avx2", {}) == slide("avx512", {})).all()); }

/// Two matching bowls that lie in each other, dragged and pressed: all nodes touch, those of packs that are not full
/// too.
Scalars drag(const char* name, double length) {
  const Target target(name);
  ContactLayer lower(mechanics::make_rectangle({0, length}, {0, 4}, 1, 0), 1);
  ContactLayer upper(mechanics::make_rectangle({0, length}, {0, 4}, 1, 0.99), 1);
  LayerInterface interface(kLaw, lower.geometry, upper.geometry);
  interface.update(0);
  const auto bowl = [](const Vector3& x, double s) { return Vector3(0.003 * s, 0.001 * s, 0.02 * x.squaredNorm()); };
  for (int n = 1; n <= 40; ++n) {
    lower.move([&](const Vector3& x) { return Vector3(x + bowl(x, n)); });
    upper.move([&](const Vector3& x) { return Vector3(x + bowl(x, 0) - Vector3(0, 0, 1e-3 * n)); });
    interface.update(1e-5);
  }
  return collect(interface);
}

TEST_F(ContactKernelWidth, DoesNotChangeABitInPacksThatAreNotFull) {
  for (int length = 2; length < 10; ++length)
    EXPECT_TRUE((drag("avx2", length) == drag("avx512", length)).all()) << length;
}

/// A sheet pressed by a punch, after some steps: forces, springs, slip and energies.
Scalars press(const char* name) {
  const Target target(name);
  ContactLayer sheet(make_turned_rectangle(10, 8, 0.5, -0.5, 0.2), 1);
  Tool tool{.name = "punch", .shape = std::make_unique<PyramidPunch>(10, 5, 2), .z = 0};
  ToolInterface interface(kLaw, sheet.geometry, tool);
  interface.update(0);
  for (int n = 1; n <= 60; ++n) {
    tool.increment = -0.01;
    tool.z += tool.increment;
    sheet.move(
        [&](Vector3 x) { return Vector3(x + Vector3(0.003 * n, 0, -0.007 * n * std::exp(-0.02 * x.squaredNorm()))); });
    interface.update(1e-5);
  }
  const Points& p = interface.points();
  const InterfaceEnergies& e = interface.energies();
  Scalars all(6 * p.size() + p.size() + 11);
  all << interface.force_on_layer().reshaped(), p.stick.reshaped(), p.slip, e.stored, e.friction, e.damping, e.thinning,
      e.work, tool.force.array(), tool.moment.array();
  return all;
}

TEST_F(ContactKernelWidth, OfToolsDoesNotChangeABit) { EXPECT_TRUE((press("avx2") == press("avx512")).all()); }

TEST(ContactBlocks, GiveTheSameBitsInAnyOrderAndByAnyThreads) {
  const auto backwards = [](Eigen::Index n, const std::function<void(Eigen::Index)>& body) {
    for (Eigen::Index i = n; i-- > 0;) body(i);
  };
  const auto two_threads = [](Eigen::Index n, const std::function<void(Eigen::Index)>& body) {
    std::jthread odd([&] {
      for (Eigen::Index i = 1; i < n; i += 2) body(i);
    });
    for (Eigen::Index i = 0; i < n; i += 2) body(i);
  };
  for (const char* target : {"avx2", "avx512"}) {
    if (!test::is_on_this_machine(target)) continue;
    const Scalars serial = slide(target, {});
    EXPECT_TRUE((slide(target, {backwards, 1}) == serial).all());
    EXPECT_TRUE((slide(target, {two_threads, 2}) == serial).all());
  }
}

}  // namespace
