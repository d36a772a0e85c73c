#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/contact_layer.hpp"

namespace {

using namespace interply;
using namespace interply::contact;

const InterfaceLaw kLaw{.stiffness = 500, .tangential = 500, .damping = 0, .friction = 0.25};

struct Layer : test::ContactLayer {
  Layer(double h, double z, double thickness, double turn = 0, double size = 1)
      : ContactLayer(test::make_turned_rectangle(5 * size, 4 * size, h, z, turn), thickness) {}
};

using test::total;

TEST(LayerInterface, ForcesOnBothFacesCancel) {
  Layer lower(1.0, 0, 1), upper(0.7, 1, 1, 0.3);
  LayerInterface interface(kLaw, lower.geometry, upper.geometry);
  interface.update(0);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-0.05, 0.05);
  for (int n = 0; n < 20; ++n) {
    lower.move([&](Vector3 x) { return Vector3(x + Vector3(0.01 * n + unit(random), unit(random), unit(random))); });
    upper.move([&](Vector3 x) { return Vector3(x + Vector3(unit(random), unit(random), unit(random) - 0.05)); });
    interface.update(1e-6);
    const double scale = interface.force_on_lower().abs().sum();
    EXPECT_GT(scale, 1);
    EXPECT_LT((total(interface.force_on_lower()) + total(interface.force_on_upper())).norm(), 1e-12 * scale);
  }
}

TEST(LayerInterface, FlatPatchCarriesUniformPressureAcrossNonMatchingMeshes) {
  Layer lower(1.0, 0, 1), upper(0.6, 1, 1);
  LayerInterface interface(kLaw, lower.geometry, upper.geometry);
  upper.move([](Vector3 x) { return Vector3(x - Vector3(0, 0, 0.004)); });
  interface.update(0);
  EXPECT_NEAR(interface.points().pressure.minCoeff(), 2.0, 1e-10);
  EXPECT_NEAR(interface.points().pressure.maxCoeff(), 2.0, 1e-10);
  EXPECT_NEAR(total(interface.force_on_upper()).z(), 2.0 * 80, 1e-8);
}

TEST(LayerInterface, RigidMotionTogetherNeitherSlipsNorWorks) {
  Layer lower(1.0, 0, 1), upper(1.0, 1, 1);
  LayerInterface interface(kLaw, lower.geometry, upper.geometry);
  interface.update(0);
  for (int n = 1; n <= 100; ++n) {
    const auto shift = [&](Vector3 x) { return Vector3(x + 0.3 * n * Vector3(1, -2, 0.5)); };
    lower.move(shift);
    upper.move([&](Vector3 x) { return Vector3(shift(x) - Vector3(0, 0, 0.002)); });
    interface.update(1e-6);
  }
  EXPECT_NEAR(interface.points().slip.maxCoeff(), 0, 1e-10);
  EXPECT_NEAR(interface.energies().friction, 0, 1e-10);
}

/// Slides a wavy sheet under a wavy sheet of another mesh, without friction: what the forces do is what the springs
/// hold, with an error of second order in the step. Forces along n alone would miss the facets' slopes.
TEST(LayerInterface, SlidingOverCurvedFacetsConservesEnergyToSecondOrder) {
  const auto residual = [](int steps) {
    Layer lower(1.0, 0, 0.5), upper(0.9, 0.49, 0.5, 0.2, 1.6);
    const InterfaceLaw frictionless{.stiffness = 500, .tangential = 500};
    const auto wave = [](Vector3 x) {
      return Vector3(x.x(), x.y(), x.z() + 0.4 * std::sin(x.x()) * std::cos(0.8 * x.y()));
    };
    lower.move(wave);
    upper.move(wave);
    LayerInterface interface(frictionless, lower.geometry, upper.geometry);
    interface.update(0);
    const double before = interface.energies().stored, start = interface.energies().residual();
    double largest = 0;
    for (int n = 1; n <= steps; ++n) {
      const double s = 0.5 * n / steps;
      lower.move([&](Vector3 x) { return Vector3(wave(x) + Vector3(s, 0.4 * s, 0.02 * s)); });
      upper.move([&](Vector3 x) { return Vector3(wave(x) + Vector3(0, 0, 0.3 * s * std::sin(x.x()))); });
      interface.update(1e-6);
      largest = std::max(largest, std::abs(interface.energies().residual() - start));
    }
    return largest / before;
  };
  const double coarse = residual(200), fine = residual(400);
  EXPECT_LT(fine, 2e-3);
  EXPECT_LT(fine, 0.5 * coarse);  // second order between kinks of the facets
}

/// Tracked pairs agree with trying every triangle, on curved sheets that slide over each other.
TEST(Pairing, WalkingAgreesWithSearchingEverywhere) {
  Layer lower(0.8, 0, 0.2), upper(0.5, 0.2, 0.2, 0.4);
  const auto bend = [](const Vector3& x, double lift) {
    return Vector3(x.x(), x.y(), lift + 2 * std::exp(-0.1 * (x.x() * x.x() + x.y() * x.y())));
  };
  std::vector<int> tracked(static_cast<std::size_t>(lower.mesh.n_nodes()));
  for (int i = 0; i < lower.mesh.n_nodes(); ++i)
    tracked[static_cast<std::size_t>(i)] = search_facing(upper.geometry, lower.geometry.position(i), Vector3::UnitZ());
  int compared = 0;
  for (int n = 1; n <= 30; ++n) {
    lower.move([&](Vector3 x) { return bend(x, 0); });
    upper.move([&](Vector3 x) { return bend(x + Vector3(0.05 * n, 0.03 * n, 0), 0.2); });
    for (int i = 0; i < lower.mesh.n_nodes(); ++i) {
      const Vector3 x = lower.geometry.position(i), normal = lower.geometry.normal(i);
      int& triangle = tracked[static_cast<std::size_t>(i)];
      const Facing walked = find_facing(upper.geometry, x, normal, triangle);
      triangle = walked.triangle;
      if (walked.share < 1) continue;  // beyond the edge
      const Facing searched = find_facing(upper.geometry, x, normal, search_facing(upper.geometry, x, normal));
      EXPECT_NEAR(walked.projection.distance, searched.projection.distance, 1e-9);
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
}

/// The quick search is the plain one: on equal meshes, where six triangles hold a node, on others, beyond the edge, and
/// on curved partners.
TEST(Pairing, FlatSearchFindsWhatTryingEveryTriangleFinds) {
  Layer lower(0.5, 0, 1);
  for (const double h : {0.5, 0.37, 0.9, 20.0})
    for (const double turn : {0.0, 0.4}) {
      Layer upper(h, 0.7, 1, turn, turn > 0 ? 0.6 : 1);
      for (const bool is_flat : {true, false}) {
        if (!is_flat) upper.move([](Vector3 x) { return Vector3(x + Vector3(0, 0, 0.2 * std::sin(x.x() + x.y()))); });
        const FlatSearch search(upper.geometry);
        for (int i = 0; i < lower.mesh.n_nodes(); ++i) {
          const Vector3 x = lower.geometry.position(i), tilted = Vector3(0.3, 0.1, 1).normalized();
          ASSERT_EQ(search.find(x, Vector3::UnitZ()), search_facing(upper.geometry, x, Vector3::UnitZ())) << h;
          ASSERT_EQ(search.find(x, tilted), search_facing(upper.geometry, x, tilted)) << h;
        }
      }
    }
}

TEST(Pairing, IsFoundWhateverTheThicknessAgainstTheMesh) {
  Layer lower(0.5, 0, 1), upper(0.4, 30, 1);  // sixty elements apart
  for (int i = 0; i < lower.mesh.n_nodes(); ++i) {
    const Vector3 x = lower.geometry.position(i);
    const int t = search_facing(upper.geometry, x, Vector3::UnitZ());
    ASSERT_GE(t, 0);
    const Facing f = find_facing(upper.geometry, x, Vector3::UnitZ(), t);
    EXPECT_EQ(f.triangle, t);
    EXPECT_NEAR(f.projection.distance, 30, 1e-12);
    EXPECT_EQ(f.share, 1);
  }
}

TEST(Pairing, NodeBeyondTheEdgeIsLetGoGentlyAndTakenBack) {
  Layer upper(1.0, 1, 1);
  const auto share = [&](double beyond) {
    const Vector3 x(5 + beyond, 0.2, 0);
    const int start = search_facing(upper.geometry, Vector3(4.9, 0.2, 0), Vector3::UnitZ());
    const Facing f = find_facing(upper.geometry, x, Vector3::UnitZ(), start);
    EXPECT_NEAR(f.projection.weight[0] + f.projection.weight[1] + f.projection.weight[2], 1, 1e-14);
    return f.share;
  };
  EXPECT_EQ(share(-0.01), 1.0);
  EXPECT_NEAR(share(0.15), 0.5, 1e-9);
  EXPECT_EQ(share(0.31), 0.0);
}

/// A layer leaves its partner sideways, rises past it, comes back above it, and goes round to its own side again.
TEST(LayerInterface, NodesThatHavePassedTheEdgeAreFreeUntilTheyAreBackOnTheirSide) {
  for (const bool plainly : {false, true}) {
    Layer lower(1.0, 0, 1, 0.2), upper(0.7, 1.01, 1);
    LayerInterface interface(kLaw, lower.geometry, upper.geometry);
    const auto update = [&](double dt) { plainly ? interface.update_plainly(dt) : interface.update(dt); };
    update(0);
    const auto move = [&](const Vector3& from, const Vector3& to) {
      constexpr int kSteps = 120;
      double largest = 0;
      for (int n = 1; n <= kSteps; ++n) {
        const double s = static_cast<double>(n) / kSteps;
        lower.move([&](Vector3 x) { return Vector3(x + (1 - s) * from + s * to); });
        update(1e-6);
        largest = std::max(largest, interface.force_on_lower().abs().maxCoeff());
      }
      return largest;
    };
    const Vector3 home(0, 0, 0), out(13, 0, 0), past(13, 0, 3), above(0, 0, 3);
    EXPECT_EQ(move(home, out) + move(out, past) + move(past, above), 0);
    EXPECT_TRUE((interface.points().state == static_cast<int>(State::Passed)).all());
    EXPECT_EQ(interface.energies().stored + interface.energies().edge, 0);
    EXPECT_EQ(move(above, past) + move(past, out) + move(out, home), 0);
    EXPECT_TRUE((interface.points().state == static_cast<int>(State::Open)).all());
    move(home, {0, 0, 0.014});
    const auto inside = interface.points().weight == 1;
    EXPECT_GT(inside.count(), 50);
    EXPECT_LT((inside.cast<double>() * (interface.points().pressure - 2).abs()).maxCoeff(), 1e-10);
  }
}

TEST(VertexNormals, OfASphereArePointingOutwards) {
  Layer cap(0.5, 0, 1);
  const double radius = 12;
  cap.move(
      [&](Vector3 x) { return Vector3(x.x(), x.y(), std::sqrt(radius * radius - x.x() * x.x() - x.y() * x.y())); });
  for (int i = 0; i < cap.mesh.n_nodes(); ++i) {
    const Vector3 x = cap.geometry.position(i);
    if (std::abs(x.x()) > 4.4 || std::abs(x.y()) > 3.4) continue;
    EXPECT_LT((cap.geometry.normal(i) - x / radius).norm(), 5e-3);
  }
}

TEST(ToolInterface, SkippingFarNodesChangesNothing) {
  // a sheet under a sinking punch: forces must equal those of an interface that starts fresh at the same place
  Layer sheet(0.5, -0.5, 1);
  Tool tool{.name = "punch", .shape = std::make_unique<PyramidPunch>(10, 5, 2), .z = 0};
  Tool fresh_tool{.name = "punch", .shape = std::make_unique<PyramidPunch>(10, 5, 2), .z = 0};
  const InterfaceLaw frictionless{.stiffness = 500, .tangential = 500};
  ToolInterface tracked(frictionless, sheet.geometry, tool);
  tracked.update(0);
  for (int n = 1; n <= 300; ++n) {
    tool.increment = -0.01;
    tool.z -= 0.01;
    sheet.move([&](Vector3 x) { return Vector3(x - Vector3(0, 0, 0.0099 * n * std::exp(-0.05 * x.squaredNorm()))); });
    tracked.update(1e-6);
    if (n % 50) continue;
    fresh_tool.z = tool.z;
    ToolInterface fresh(frictionless, sheet.geometry, fresh_tool);
    fresh.update(0);
    EXPECT_GT(tool.force.z(), 0);
    EXPECT_TRUE((tracked.force_on_layer() == fresh.force_on_layer()).all());
  }
}

}  // namespace
