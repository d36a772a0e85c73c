/// V13: a contact patch across non-matching meshes: two plies squeezed between rigid plates.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/tool_interface.hpp"
#include "solver_fabric/fabric_layer.hpp"
#include "support/contact_layer.hpp"
#include "support/free_layers.hpp"
#include "support/results.hpp"

namespace {

using namespace interply;
using test::Vector3;

class Plate : public contact::SignedDistance {
 public:
  explicit Plate(double up) : up_(up) {}
  contact::Distance evaluate(const Vector3& x) const override {
    return {.value = up_ * x.z(), .gradient = Vector3(0, 0, up_)};
  }

 private:
  double up_;
};

constexpr double kThickness = 1.2, kDensity = 6.19e-10, kStiffness = 500, kPressure = 2;

std::unique_ptr<solve::LayerMechanics> make_ply(const mechanics::TriangleMesh& mesh) {
  scene::Layer layer;
  layer.name = "ply";
  layer.thickness = kThickness;
  layer.density = kDensity;
  layer.law = scene::WovenLaw{};
  return std::make_unique<fabric::FabricLayer>(layer, 1.0, mesh);
}

/// Two plies in equilibrium between rigid plates pressed together by 3 p/k: three springs of stiffness k in series.
/// The upper ply is larger, so that every lower node faces it, and its plate presses only above the lower one.
struct Patch {
  double mean = 0;                       ///< pressure within 0.6 of the size, MPa
  double scatter = 0, of_triangles = 0;  ///< rms of (p - mean)/mean of the nodes, and of the means over triangles

  Patch(double h_lower, double h_upper, double turn, Vector3 shift) {
    const double size = 40, closing = 3 * kPressure / kStiffness;
    mechanics::TriangleMesh upper_mesh =
        test::make_turned_rectangle(1.75 * size, 1.75 * size, h_upper, kThickness, turn);
    upper_mesh.reference.colwise() += shift.array();
    const mechanics::TriangleMesh lower_mesh = mechanics::make_rectangle({-size, size}, {-size, size}, h_lower);
    test::FreeLayer lower(lower_mesh, make_ply(lower_mesh), kThickness, kDensity, Vector3::Zero());
    test::FreeLayer upper(upper_mesh, make_ply(upper_mesh), kThickness, kDensity, Vector3::Zero());
    const contact::InterfaceLaw law{.stiffness = kStiffness, .tangential = kStiffness};
    contact::Tool below{.name = "below", .shape = std::make_unique<Plate>(1.0), .z = -0.5 * kThickness};
    contact::Tool above{.name = "above", .shape = std::make_unique<Plate>(-1.0), .z = 1.5 * kThickness - closing};
    contact::ToolInterface lower_plate(law, lower.geometry, below), upper_plate(law, upper.geometry, above);
    contact::LayerInterface between(law, lower.geometry, upper.geometry);
    lower_plate.update(0);
    upper_plate.update(0);
    between.update(0);
    const double dt = 4e-7;
    for (int n = 1; n <= 1500; ++n) {
      lower.drift(dt);
      upper.drift(dt);
      lower_plate.update(dt);
      upper_plate.update(dt);
      between.update(dt);
      lower.motion.dt = upper.motion.dt = dt;
      lower.kick(dt, n * dt, lower_plate.force_on_layer() + between.force_on_lower());
      upper.kick(dt, n * dt, upper_plate.force_on_layer() + between.force_on_upper());
      lower.motion.velocity *= 1 - 0.15;
      upper.motion.velocity *= 1 - 0.15;
    }
    const auto is_inside = [&](int i) {
      return lower_mesh.reference.col(i).head(2).abs().maxCoeff() <= 0.6 * size + 1e-9;
    };
    const contact::Points& p = between.points();
    double area = 0, square = 0;
    for (int i = 0; i < p.size(); ++i) {
      if (!is_inside(i)) continue;
      mean += p.area(i) * p.pressure(i);
      area += p.area(i);
    }
    mean /= area;
    for (int i = 0; i < p.size(); ++i)
      if (is_inside(i)) scatter += p.area(i) / area * std::pow(p.pressure(i) / mean - 1, 2);
    int triangles = 0;
    for (Eigen::Index e = 0; e < lower_mesh.n_elements(); ++e) {
      const auto corner = lower_mesh.triangles.col(e);
      if (!is_inside(corner(0)) || !is_inside(corner(1)) || !is_inside(corner(2))) continue;
      const double value = (p.pressure(corner(0)) + p.pressure(corner(1)) + p.pressure(corner(2))) / 3;
      square += std::pow(value / mean - 1, 2);
      ++triangles;
    }
    scatter = std::sqrt(scatter);
    of_triangles = std::sqrt(square / triangles);
    EXPECT_NEAR((p.pressure * p.area).sum(), -below.force.z(), -1e-3 * below.force.z());  // at rest
  }
};

void expect_rows(const Patch& patch, const std::string& mesh, double node_tolerance, double triangle_tolerance) {
  test::expect_result({.row = "V13",
                       .quantity = "pressure across non-matching meshes: rms scatter of triangle means",
                       .source = "uniform pressure",
                       .reference = 0,
                       .ours = patch.of_triangles,
                       .tolerance = triangle_tolerance,
                       .absolute = true,
                       .mesh = mesh});
  test::expect_result({.row = "V13",
                       .quantity = "the same, rms scatter of nodes",
                       .source = "uniform pressure",
                       .reference = 0,
                       .ours = patch.scatter,
                       .tolerance = node_tolerance,
                       .absolute = true,
                       .mesh = mesh});
}

/// What a run meets: plies of one mesh that have slid against each other. What is allowed here and below is the stated
/// error of the method (THEORY.md), a little above what was measured.
TEST(ContactPatch, OfEqualMeshesThatHaveSlidCarriesUniformPressure) {
  const Patch patch(10, 10, 0, {3.7, 2.1, 0});
  // one pass of nodes: single nodes carry what their neighbours do not (services/contact/THEORY.md 4)
  expect_rows(patch, "10 mm, shifted by (0.37, 0.21) elements", 0.04, 0.01);
}

/// Meshes that nothing in a scene can produce today: the stated error of one pass. It does not fall with the mesh, for
/// nothing but the layers' bending stiffness ties neighbouring nodes together.
TEST(ContactPatch, OfUnlikeMeshesHasTheStatedError) {
  expect_rows(Patch(7, 10, 0.4, {3.7, 2.1, 0}), "7 mm against 10 mm, turned by 23 deg", 0.04, 0.02);
  expect_rows(Patch(10, 10, 0.4, {3.7, 2.1, 0}), "10 mm against 10 mm, turned by 23 deg", 0.06, 0.03);
  expect_rows(Patch(10, 7, 0.4, {3.7, 2.1, 0}), "10 mm against 7 mm, turned by 23 deg", 0.17, 0.06);
}

/// Flat stack of unlike meshes sheared by less than sticks: uniform traction, and its resultant on both faces.
TEST(ContactPatch, ShearedStackCarriesUniformTractionAcrossNonMatchingMeshes) {
  test::ContactLayer lower(mechanics::make_rectangle({-20, 20}, {-20, 20}, 5), 1),
      upper(test::make_turned_rectangle(35, 35, 3.5, 0.996, 0.4), 1);
  contact::LayerInterface interface({.stiffness = 500, .tangential = 500, .friction = 0.25}, lower.geometry,
                                    upper.geometry);
  interface.update(0);
  upper.move([](const Vector3& x) { return Vector3(x + Vector3(0.0006, -0.0003, 0)); });
  interface.update(1e-6);
  const contact::Points& p = interface.points();
  const Vector3 traction = 500 * Vector3(0.0006, -0.0003, 0);  // of the upper on the lower
  const double scatter = (p.acting_traction().matrix().colwise() - traction).colwise().norm().maxCoeff() / traction.norm();
  test::expect_result({.row = "V13",
                       .quantity = "traction of a sheared flat stack, largest deviation / traction",
                       .source = "k_t x shift",
                       .reference = 0,
                       .ours = scatter,
                       .tolerance = 1e-6,
                       .absolute = true,
                       .mesh = "5 mm against 3.5 mm, turned by 23 deg"});
  test::expect_result({.row = "V13",
                       .quantity = "resultant on the upper face of that stack",
                       .source = "traction x area",
                       .reference = -traction.x() * 1600,
                       .ours = test::total(interface.force_on_upper()).x(),
                       .unit = "N",
                       .tolerance = 1e-3,
                       .mesh = "5 mm against 3.5 mm, turned by 23 deg"});
}

}  // namespace
