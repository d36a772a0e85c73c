/// V12: Coulomb friction between layers, in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/layer_interface.hpp"
#include "contact/tool_interface.hpp"
#include "support/results.hpp"

namespace {

using namespace interply;
using contact::LayerGeometry;
using mechanics::NodalVectors;
using mechanics::Scalars;
using mechanics::Vector3;

/// A rigid plate of 1 mm thickness that is moved as a whole.
struct Plate {
  mechanics::TriangleMesh mesh;
  LayerGeometry geometry;
  double area;
  Plate(double half_length, double half_width, double h, double z)
      : mesh(mechanics::make_rectangle({-half_length, half_length}, {-half_width, half_width}, h, z)),
        geometry(mesh, 1, 1e-9),
        area(4 * half_length * half_width) {}
  void move(const Vector3& step) { geometry.move_to(geometry.positions().colwise() + step.array()); }
};

Vector3 total(const NodalVectors& f) { return {f.row(0).sum(), f.row(1).sum(), f.row(2).sum()}; }

/// A block (the lower partner, so that all its nodes are contact points) hanging under gravity g cos(a) that presses it
/// against a plane above, and g sin(a) along it: an incline of angle a. Turned slowly to `ratio` x the friction angle.
struct Incline {
  static constexpr double kFriction = 0.25, kMass = 1e-3, kGravity = 1e5;  // -, t, mm/s2
  double slipped = 0, moved = 0, velocity = 0, angle = 0, elastic = 0, expected_velocity = 0;

  explicit Incline(double ratio) {
    const contact::InterfaceLaw law{.stiffness = 500,
                                    .tangential = 500,
                                    .damping = contact::compute_damping(0.2, 500, kMass / 80, 1e300),
                                    .friction = kFriction};
    Plate block(5, 4, 1, 0), plane(40, 20, 3, 1);
    contact::LayerInterface interface(law, block.geometry, plane.geometry);
    const double area = block.area, dt = 0.1 * std::sqrt(kMass / (law.stiffness * area));
    const double press = kMass * kGravity;
    angle = std::atan(kFriction) * ratio;
    block.move(Vector3(0, 0, press / (law.stiffness * area)));  // starts in equilibrium on a level plane
    interface.update(0);
    Vector3 v = Vector3::Zero();
    const int ramp = 4000, steps = 6000;
    double start = 0;
    for (int n = 1; n <= steps; ++n) {
      const double a = angle * std::min(1.0, double(n) / ramp);
      const Vector3 weight = press * Vector3(std::sin(a), 0, std::cos(a));
      block.move(dt * v);
      interface.update(dt);
      v += dt / kMass * (total(interface.force_on_lower()) + weight);
      if (n == ramp) start = v.x();
    }
    slipped = interface.points().slip.maxCoeff();
    moved = block.geometry.position(0).x() + 5;
    velocity = v.x();
    elastic = press * std::sin(angle) / (law.tangential * area);
    expected_velocity = start + (steps - ramp) * dt * kGravity *
                                    (std::sin(angle) - kFriction * std::cos(angle));  // a = g (sin - mu cos)
  }
};

TEST(InclinedPlane, BlockSticksJustBelowTheFrictionAngle) {
  const Incline incline(0.98);
  test::expect_result({.row = "V12",
                       .quantity = "slip of a block on an incline, 2 % below the friction angle",
                       .source = "tan a < mu",
                       .reference = 0,
                       .ours = incline.slipped,
                       .unit = "mm",
                       .tolerance = 0,
                       .absolute = true,
                       .mesh = "1 mm against 3 mm"});
  EXPECT_NEAR(incline.moved, incline.elastic,
              0.1 * incline.elastic);  // only the elastic stick, still swinging a little
}

TEST(InclinedPlane, BlockSlidesJustAboveTheFrictionAngleAsNewtonSays) {
  const Incline incline(1.02);
  EXPECT_GT(incline.slipped, 0);
  EXPECT_GT(incline.moved, 2 * incline.elastic);
  EXPECT_GT(incline.velocity, 0);
  test::expect_result({.row = "V12",
                       .quantity = "speed of a block on an incline, 2 % above the friction angle",
                       .source = "g (sin a - mu cos a) t",
                       .reference = incline.expected_velocity,
                       .ours = incline.velocity,
                       .unit = "mm/s",
                       .mesh = "1 mm against 3 mm"});
}

/// A strip between two plates under the same pressure: 2 mu N, whichever of its neighbours carries the contact points.
TEST(StripBetweenPlates, OfLayersNeedsTwiceMuN) {
  for (const double friction : {0.1, 0.25}) {
    const contact::InterfaceLaw law{.stiffness = 500, .tangential = 500, .friction = friction};
    Plate below(20, 10, 2.5, 0), strip(40, 10, 2, 1), above(20, 10, 3, 2);
    contact::LayerInterface lower(law, below.geometry, strip.geometry), upper(law, strip.geometry, above.geometry);
    below.move(Vector3(0, 0, 0.004));
    above.move(Vector3(0, 0, -0.004));
    lower.update(0);
    upper.update(0);
    const double normal = total(upper.force_on_upper()).z();
    for (int n = 0; n < 200; ++n) {
      strip.move(Vector3(0.01, 0, 0));
      below.move(Vector3::Zero());
      above.move(Vector3::Zero());
      lower.update(1e-6);
      upper.update(1e-6);
      if (n == 0) continue;
      const Vector3 pull = -(total(lower.force_on_upper()) + total(upper.force_on_lower()));
      const double n_lower = total(lower.force_on_upper()).z(), n_upper = -total(upper.force_on_lower()).z();
      // nodes that leave or enter over an edge are pushed along it by up to p^2/(2 k) a width
      ASSERT_NEAR(pull.x(), friction * (n_lower + n_upper), 1e-3 * pull.x());
      ASSERT_NEAR(pull.y(), 0, 1e-3 * pull.x());
    }
    // 2 MPa over the plates; the upper interface's points are the strip's own nodes, so the plate's area is met to
    // within the strip of elements that is let go at its edges
    EXPECT_NEAR(total(lower.force_on_upper()).z(), 2 * below.area, 1e-9 * below.area);
    EXPECT_NEAR(normal, 2 * above.area, 0.1 * 2 * above.area);
  }
}

/// The same strip between two rigid tools.
class Ground : public contact::SignedDistance {
 public:
  explicit Ground(double up) : up_(up) {}
  contact::Distance evaluate(const Vector3& x) const override {
    return {.value = up_ * x.z(), .gradient = Vector3(0, 0, up_)};
  }

 private:
  double up_;
};

TEST(StripBetweenPlates, OfToolsNeedsTwiceMuN) {
  const double friction = 0.1;
  const contact::InterfaceLaw law{.stiffness = 500, .tangential = 500, .friction = friction};
  Plate strip(20, 10, 2, 0.5);
  contact::Tool die{.name = "die", .shape = std::make_unique<Ground>(1.0), .z = 0.004};
  contact::Tool holder{.name = "blank_holder", .shape = std::make_unique<Ground>(-1.0), .z = 0.996};
  contact::ToolInterface below(law, strip.geometry, die), above(law, strip.geometry, holder);
  below.update(0);
  above.update(0);
  const double normal = 2 * strip.area;  // 500 N/mm3 x 4 um
  for (int n = 0; n < 100; ++n) {
    strip.move(0.01 * Vector3(0.6, 0.8, 0));  // along a slanted direction: friction points straight back
    below.update(1e-6);
    above.update(1e-6);
  }
  const Vector3 force = total(below.force_on_layer()) + total(above.force_on_layer());
  test::expect_result({.row = "V12",
                       .quantity = "pull on a strip between two plates, mu 0.1",
                       .source = "2 mu N",
                       .reference = 2 * friction * normal,
                       .ours = force.head(2).norm(),
                       .unit = "N",
                       .mesh = "2 mm"});
  EXPECT_NEAR(die.force.z(), -normal, 1e-9 * normal);
  EXPECT_NEAR(holder.force.z(), normal, 1e-9 * normal);
  EXPECT_NEAR(force.x(), -0.6 * 2 * friction * normal, 1e-9 * normal);
  EXPECT_NEAR(force.y(), -0.8 * 2 * friction * normal, 1e-9 * normal);
  EXPECT_NEAR(below.energies().friction + above.energies().friction, 2 * friction * normal * (1.0 - friction * 2 / 500),
              1e-2 * friction * normal);
}

}  // namespace
