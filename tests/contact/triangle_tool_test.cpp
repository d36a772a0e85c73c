#include "contact/triangle_tool.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <random>

#include "contact/tool_interface.hpp"
#include "geometry/stl.hpp"
#include "support/contact_layer.hpp"
#include "support/results.hpp"
#include "support/tool_surfaces.hpp"

namespace {

using namespace interply;
using namespace interply::contact;
using test::Soup;

TriangleTool make_tool(const Soup& soup) {
  const geometry::Surface s = geometry::parse_stl(test::to_ascii_stl(soup), "tool.stl");
  return {s.vertices, s.triangles};
}

class Ball : public SignedDistance {
 public:
  explicit Ball(double radius) : radius_(radius) {}
  Distance evaluate(const Vector3& x) const override { return {x.norm() - radius_, x.normalized()}; }

 private:
  double radius_;
};

class Box : public SignedDistance {
 public:
  explicit Box(const Vector3& half) : half_(half) {}
  Distance evaluate(const Vector3& x) const override {
    const Vector3 q = x.cwiseAbs() - half_, out = q.cwiseMax(0.0);
    const Vector3 sign(std::copysign(1, x.x()), std::copysign(1, x.y()), std::copysign(1, x.z()));
    if (out.norm() > 0) return {out.norm(), out.normalized().cwiseProduct(sign)};
    Eigen::Index k = 0;
    const double depth = q.maxCoeff(&k);
    return {depth, sign(k) * Vector3::Unit(k)};
  }

 private:
  Vector3 half_;
};

struct Region {
  Vector3 low, high;
};
std::vector<Vector3> scatter(const Region& region, int n, int seed = 1) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vector3> points;
  for (int i = 0; i < n; ++i)
    points.push_back(region.low +
                     (region.high - region.low).cwiseProduct(Vector3(unit(random), unit(random), unit(random))));
  return points;
}

/// Largest error of distance (mm) and gradient (angle, rad) at points with a distance between `nearest` and 30 mm.
struct Errors {
  double distance = 0, angle = 0;
};
Errors compare(const SignedDistance& exact, const SignedDistance& tool, const Region& region, double nearest) {
  Errors worst;
  for (const Vector3& x : scatter(region, 4000)) {
    const Distance reference = exact.evaluate(x), ours = tool.evaluate(x);
    if (reference.value < nearest || reference.value > 30) continue;
    EXPECT_NEAR(ours.gradient.norm(), 1, 1e-12);
    worst.distance = std::max(worst.distance, std::abs(ours.value - reference.value));
    worst.angle = std::max(worst.angle, (ours.gradient - reference.gradient).norm());
  }
  return worst;
}

TEST(TriangleTool, BoxIsExactInsideAndOutside) {
  const Vector3 half(3, 2, 1);
  const TriangleTool tool = make_tool(test::make_box(half));
  const Box box(half);
  for (const Vector3& x : scatter({{-5, -5, -5}, {5, 5, 5}}, 20000)) {
    const Distance reference = box.evaluate(x), ours = tool.evaluate(x);
    ASSERT_NEAR(ours.value, reference.value, 1e-12);
    const Vector3 q = x.cwiseAbs() - half;
    Vector3 sorted = q;
    std::sort(sorted.data(), sorted.data() + 3);
    if (reference.value < 0 && sorted(2) - sorted(1) < 1e-6) continue;  // two faces equally near
    ASSERT_LT((ours.gradient - reference.gradient).norm(), 1e-9);
  }
}

/// The corner of a wedge as sharp as 10 deg, where the sum of face normals without angles has the wrong sign.
TEST(TriangleTool, SignIsRightBesideSharpCorners) {
  const Vector3 tip(0, 0, 0), a(10, 0.2, 0), b(10, -0.2, 0.1), c(10, 0, 3);
  Soup soup;
  const Vector3 middle = (tip + a + b + c) / 4;
  const Vector3 corners[4] = {tip, a, b, c};
  for (int k = 0; k < 4; ++k) {
    const Vector3 &p = corners[(k + 1) % 4], &q = corners[(k + 2) % 4], &r = corners[(k + 3) % 4];
    test::add_triangle(soup, p, q, r, (p + q + r) / 3 - middle);
  }
  const TriangleTool tool = make_tool(soup);
  for (const Vector3& x : scatter({{-1, -1, -1}, {11, 1, 4}}, 20000)) {
    bool inside = true;
    for (std::size_t t = 0; t < soup.size(); t += 3)
      inside = inside && (soup[t + 1] - soup[t]).cross(soup[t + 2] - soup[t]).dot(x - soup[t]) < 0;
    ASSERT_EQ(tool.evaluate(x).value < 0, inside) << x.transpose();
  }
}

/// A sphere of radius R with all corners on it: every distance lies between the exact one and that one plus the largest
/// sagitta of the facets.
TEST(TriangleTool, BallConvergesWithTheSquareOfTheFacets) {
  const double R = 15;
  std::vector<double> h, distance, angle;
  double ours = 0;
  for (const int m : {8, 16, 32}) {
    const Soup soup = test::make_ball(R, m);
    double sagitta = 0, longest = 0;
    for (std::size_t t = 0; t < soup.size(); t += 3) {
      const Vector3 normal = (soup[t + 1] - soup[t]).cross(soup[t + 2] - soup[t]).normalized();
      sagitta = std::max(sagitta, R - normal.dot(soup[t]));
      longest = std::max(longest, (soup[t + 1] - soup[t]).norm());
    }
    const TriangleTool tool = make_tool(soup);
    const Errors e = compare(Ball(R), tool, {{-25, -25, -25}, {25, 25, 25}}, 0.5);
    EXPECT_LE(e.distance, sagitta * (1 + 1e-9));
    EXPECT_GE(e.distance, 0.5 * sagitta);
    h.push_back(longest);
    distance.push_back(e.distance);
    angle.push_back(e.angle);
    ours = tool.evaluate({1, 2, 20}).value;
  }
  EXPECT_NEAR(test::compute_order(h, distance), 2, 0.15);
  EXPECT_NEAR(test::compute_order(h, angle), 1, 0.15);
  test::expect_result({.row = "STL",
                       .quantity = "distance to a triangulated ball, R = 15",
                       .source = "|x| - R",
                       .reference = Vector3(1, 2, 20).norm() - R,
                       .ours = ours,
                       .unit = "mm",
                       .tolerance = 0.01,
                       .mesh = "32 facets per quarter",
                       .order = test::compute_order(h, distance)});
}

/// @param bound  largest sagitta of the facets of a mesh with m per rounding, mm
void expect_second_order(const char* name, const SignedDistance& exact, const std::function<Soup(int)>& mesh,
                         const Region& region, const std::function<double(int)>& bound) {
  std::vector<double> h, distance;
  for (const int m : {4, 8, 16, 32}) {
    const Errors e = compare(exact, make_tool(mesh(m)), region, 0.2);
    EXPECT_LE(e.distance, bound(m)) << name << " " << m;
    h.push_back(1.0 / m);
    distance.push_back(e.distance);
  }
  EXPECT_NEAR(test::compute_order(h, distance), 2, 0.2) << name;
  test::expect_result({.row = "STL",
                       .quantity = std::string("largest error of the distance to the triangulated ") + name,
                       .source = "the analytic tool",
                       .reference = 0,
                       .ours = distance.back(),
                       .unit = "mm",
                       .tolerance = 0.03,  // of the chords; half a percent of the laminate
                       .absolute = true,
                       .mesh = "32 facets per rounding",
                       .order = test::compute_order(h, distance)});
}

/// Coarsest at the apex, where three normals enclose 97.2 deg (cos = -1/8): their sides of 1.5/m appear 3/m long from
/// half the radius, so that a facet has the circumradius sqrt(3) R/m.
TEST(TriangleTool, PunchConvergesToTheAnalyticOne) {
  expect_second_order(
      "punch", PyramidPunch(100, 50, 15), [](int m) { return test::make_punch(100, 50, 15, 60, m); },
      {{-80, -80, -20}, {80, 80, 90}}, [](int m) { return 15 * (1 - std::sqrt(1 - 3.0 / (m * m))); });
}

/// Corners turn 120 deg in 2 m facets on a radius of 22 to 32 mm, the shoulder 90 deg in m facets on 10 mm.
TEST(TriangleTool, PlatesConvergeToTheAnalyticOnes) {
  const Region up{{-110, -110, -25}, {110, 110, 20}}, down{{-110, -110, -20}, {110, 110, 25}};
  const auto bound = [](int m) { return 32 * (1 - std::cos(M_PI / 6 / m)) + 10 * (1 - std::cos(M_PI / 4 / m)); };
  for (const bool closed : {true, false}) {
    const auto die = [&](int m) { return test::make_plate(100, 22, 10, 60, 140, m, closed); };
    expect_second_order(closed ? "die (solid)" : "die (skin)", OpeningPlate(100, 22, 10, true), die, up, bound);
    expect_second_order(
        closed ? "blank holder (solid)" : "blank holder (skin)", OpeningPlate(100, 22, 10, false),
        [&](int m) { return test::turn_over(die(m)); }, down, bound);
  }
}

TEST(TriangleTool, SearchEqualsTryingEveryTriangleBitForBit) {
  const TriangleTool punch = make_tool(test::make_punch(100, 50, 15, 40, 8));
  const TriangleTool die = make_tool(test::make_plate(100, 22, 10, 40, 140, 5, false));
  auto points = scatter({{-150, -150, -60}, {150, 150, 120}}, 1500);
  for (int i = 0; i < 150; ++i) points.emplace_back(i - 75, 0, i % 7 * 10 - 30);  // ties on the plane of symmetry
  for (const Vector3& x : points) {
    for (const TriangleTool* tool : {&punch, &die}) {
      const Distance fast = tool->evaluate(x), slow = tool->evaluate_by_all(x);
      ASSERT_EQ(fast.value, slow.value);
      ASSERT_EQ(fast.gradient, slow.gradient);
    }
  }
}

TEST(TriangleTool, SkinEqualsTheSolidInFrontOfIt) {
  const TriangleTool skin = make_tool(test::make_plate(100, 22, 10, 40, 140, 8, false));
  const TriangleTool solid = make_tool(test::make_plate(100, 22, 10, 40, 140, 8, true));
  const OpeningPlate plate(100, 22, 10, true);
  for (const Vector3& x : scatter({{-140, -140, -35}, {140, 140, 30}}, 4000)) {
    if (plate.evaluate(x).value < 0.2) continue;
    ASSERT_EQ(skin.evaluate(x).value, solid.evaluate(x).value);
  }
}

/// A half plane's rim: the distance is that to a straight line, all around, and never negative.
TEST(TriangleTool, RimOfASkinIsAnEdgeWithoutAnInside) {
  Soup soup;
  test::add_quad(soup, {0, -50, 0}, {0, 50, 0}, {-50, 50, 0}, {-50, -50, 0}, Vector3::UnitZ());
  const TriangleTool tool = make_tool(soup);
  for (int i = 0; i < 36; ++i) {
    const double angle = M_PI * (i / 18.0 - 1) + 0.01;
    const Vector3 x(2 * std::cos(angle), 0.3, 2 * std::sin(angle));
    const Distance d = tool.evaluate(x);
    if (x.x() >= 0) {
      EXPECT_NEAR(d.value, 2, 1e-12);
      EXPECT_LT((d.gradient - Vector3(x.x(), 0, x.z()) / 2).norm(), 1e-12);
    } else {
      EXPECT_NEAR(d.value, x.z(), 1e-12);
    }
  }
}

TEST(TriangleTool, NeedlesAreNotLookedAt) {
  Soup soup = test::make_box({3, 2, 1});
  // one side of a face gets a vertex in its middle, in the face of one neighbour only by a needle
  const Vector3 a = soup[0], b = soup[1], middle = (a + b) / 2;
  const Vector3 c = soup[2];
  soup.erase(soup.begin(), soup.begin() + 3);
  soup.insert(soup.end(), {a, middle, c, middle, b, c, a, b, middle});
  const geometry::Surface s = geometry::parse_stl(test::to_ascii_stl(soup), "box.stl");
  ASSERT_TRUE(s.is_watertight());
  const TriangleTool tool(s.vertices, s.triangles);
  const Box box({3, 2, 1});
  for (const Vector3& x : scatter({{-5, -5, -5}, {5, 5, 5}}, 5000))
    ASSERT_NEAR(tool.evaluate(x).value, box.evaluate(x).value, 1e-12);
}

TEST(TriangleTool, SurfaceWithoutAnAreaIsRefused) {
  mechanics::NodalVectors x(3, 3);
  x << 0, 1, 2, 0, 0, 0, 0, 0, 0;
  mechanics::Triangles t(3, 1);
  t << 0, 1, 2;
  EXPECT_THROW(TriangleTool(x, t), std::invalid_argument);
}

/// Masses that a constant force presses on a ball and that slide down its side: central difference as in a run.
struct Slide {
  double residual = 0;  ///< |E_kin + E_stored - work of the load| / its largest kinetic energy
  double books = 0;     ///< of the interface alone: |stored + contact work| / the same
  double travel = 0;    ///< largest way of a node, mm
};
Slide slide_over(std::unique_ptr<SignedDistance> shape, double dt) {
  test::ContactLayer layer(mechanics::make_rectangle({-3, 3}, {-3, 3}, 2, 15.5), 1);
  Tool tool{.name = "die", .shape = std::move(shape)};
  ToolInterface interface({.stiffness = 500, .tangential = 0, .damping = 0, .friction = 0}, layer.geometry, tool);
  const auto& mass = layer.geometry.mass();
  const double load = 2;  // N per node, downwards
  NodalVectors x = layer.mesh.reference, v = NodalVectors::Zero(3, x.cols()), v_old = v;
  interface.update(0);
  Slide slide;
  double work = 0, scale = 0;
  for (int n = 0; n < static_cast<int>(3e-4 / dt); ++n) {
    NodalVectors force = interface.force_on_layer();
    force.row(2) -= load;
    v_old = v;
    for (int d = 0; d < 3; ++d) v.row(d) += (n == 0 ? 0.5 : 1) * dt * force.row(d) / mass.transpose();
    double kinetic = 0;  // v(n - 1/2).v(n + 1/2), as every layer's
    for (int d = 0; d < 3; ++d) kinetic += 0.5 * (mass.transpose() * v_old.row(d) * v.row(d)).sum();
    scale = std::max({scale, kinetic, interface.energies().stored});
    if (n > 0) {
      const double now = kinetic + interface.energies().stored - work;
      slide.residual = std::max(slide.residual, std::abs(now));
      slide.books = std::max(slide.books, std::abs(interface.energies().residual()));
    }
    work -= load * dt * v.row(2).sum();
    x += dt * v;
    layer.geometry.move_to(x);
    interface.update(dt);
  }
  slide.travel = (x - layer.mesh.reference).abs().maxCoeff();
  slide.residual /= scale;
  slide.books /= scale;
  return slide;
}

/// The force is the gradient of a function, so that facets do not pump energy; what is left falls with the increment.
TEST(TriangleTool, SlidingOverFacetsConservesEnergy) {
  const auto faceted = [] { return std::make_unique<TriangleTool>(make_tool(test::make_ball(15, 6))); };
  const Slide smooth = slide_over(std::make_unique<Ball>(15), 1e-7), coarse = slide_over(faceted(), 1e-7),
              fine = slide_over(faceted(), 2.5e-8);
  EXPECT_GT(coarse.travel, 15);
  std::cout << "energy residual / scale: analytic " << smooth.residual << ", facets " << coarse.residual << ", dt/4 "
            << fine.residual << "; books " << smooth.books << " " << coarse.books << " " << fine.books << std::endl;
  EXPECT_LT(coarse.residual, 2e-3);
  EXPECT_LT(fine.residual, 0.3 * coarse.residual);
}

}  // namespace
