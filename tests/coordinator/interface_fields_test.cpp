/// What is recorded at interfaces against what the stack hands out, for layers of any shape.
#include "coordinator/interface_fields.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "coordinator/scripted_link.hpp"
#include "support/recorded_interface.hpp"

namespace {

using namespace interply;
using coordinator::describe_interface;
using coordinator::describe_other_side;
using coordinator::Stack;
using mechanics::at;
using mechanics::NodalVectors;
using mechanics::Vector3;
using test::take;

/// A stack that is pressed into a bowl and dragged, each layer by another amount, for some steps.
struct BentStack {
  scene::Scene scene;
  Stack stack{scene};
  std::vector<NodalVectors> positions;

  explicit BentStack(const std::vector<std::string>& overrides) : scene(test::read_flat_stack(overrides)) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit(-0.01, 0.01);
    for (int step = 0; step < 6; ++step) {
      positions.clear();
      stack.move_tools(0.2 * step, -0.01);
      stack.begin_step();
      for (int i = 0; i < stack.n_layers(); ++i) {
        exchange::Motion m;
        m.position = solve::make_layer_mesh(scene, i).reference;
        m.vote = 1e-6;
        for (Eigen::Index k = 0; k < m.position.cols(); ++k) {
          const double r2 = m.position.col(k).head<2>().square().sum();
          m.position(0, k) += 0.004 * step * i + 0.02 * step * m.position(1, k) / 140 + unit(random);
          m.position(2, k) += -0.01 * i - 2e-5 * step * std::max(0.0, 5000 - r2) + unit(random);
        }
        if (i == 0 || i == 4) m.thickness = mechanics::Scalars::Constant(m.position.cols(), 1 - 1e-3 * step);
        positions.push_back(m.position);
        test::accept(stack, i, m, step ? 1e-6 : 0);
      }
    }
  }
};

/// The force that a layer is sent is the sum of what is recorded at its interfaces, to the last bit.
TEST(InterfaceFields, ForcesOfALayersInterfacesAreWhatItIsSent) {
  for (const char* mesh : {"layers.ply_2.mesh_size=20", "layers.ply_2.mesh_size=13"}) {
    BentStack bent({mesh});
    const int n = bent.stack.n_layers();
    for (int i = 0; i < n; ++i) {
      NodalVectors sent;
      ASSERT_TRUE(bent.stack.can_send_force(i));
      bent.stack.sum_force(i, sent);
      NodalVectors below = i == 0 ? take(describe_interface(bent.scene, bent.stack, 0), "force")
                                  : take(describe_other_side(bent.stack, i), "force_on_other");
      NodalVectors recorded = below + take(describe_interface(bent.scene, bent.stack, i + 1), "force");
      if (i == n - 1) recorded += take(describe_interface(bent.scene, bent.stack, n + 1), "force");
      EXPECT_TRUE((recorded == sent).all()) << i;
      EXPECT_GT(sent.abs().maxCoeff(), 1);
    }
  }
}

/// Area of a node by Heron's formula from the recorded positions, normals unit and across the traction.
TEST(InterfaceFields, AreasAreThoseOfTheDeformedMeshAndTractionsLieAcrossNormals) {
  BentStack bent({});
  for (int k = 0; k < bent.stack.n_interfaces(); ++k) {
    const std::size_t layer = k == 0 ? 0 : std::min<std::size_t>(static_cast<std::size_t>(k), 5) - 1;
    const auto fields = describe_interface(bent.scene, bent.stack, k);
    const auto& triangles = bent.stack.layer(static_cast<int>(layer)).mesh.triangles;
    mechanics::Scalars area = mechanics::Scalars::Zero(bent.positions[layer].cols());
    const NodalVectors& x = bent.positions[layer];
    for (Eigen::Index e = 0; e < triangles.cols(); ++e) {
      double side[3];
      for (int c = 0; c < 3; ++c) side[c] = (at(x, triangles(c, e)) - at(x, triangles((c + 1) % 3, e))).norm();
      const double s = 0.5 * (side[0] + side[1] + side[2]);
      for (int c = 0; c < 3; ++c)
        area(triangles(c, e)) += std::sqrt(s * (s - side[0]) * (s - side[1]) * (s - side[2])) / 3;
    }
    EXPECT_LT((take(fields, "area").row(0).transpose() - area).abs().maxCoeff(), 1e-9 * area.maxCoeff()) << k;
    const NodalVectors normal = take(fields, "normal"), traction = take(fields, "true_traction");
    double largest = 0;
    for (Eigen::Index i = 0; i < normal.cols(); ++i) {
      EXPECT_NEAR(at(normal, i).norm(), 1, 1e-12);
      EXPECT_NEAR(at(normal, i).dot(at(traction, i)), 0, 1e-12 * (1 + at(traction, i).norm()));
      largest = std::max(largest, at(traction, i).norm());
    }
    EXPECT_GT(largest, 1e-3) << k;
  }
}

/// Two plies of other fibre directions, the same traction: along each one's warp and weft as their elements carry them.
/// The plies are sheared as a whole, so that fibres are the same at every node: F d, turned.
TEST(InterfaceFields, TractionsAlongFibresFollowTheFibresOfEitherLayer) {
  scene::Scene scene = test::read_flat_stack(
      {"blank.symmetry=full", "blank.mesh_size=40", "layers.ply_1.orientation=20", "layers.ply_2.orientation=-35"});
  Stack stack(scene);
  Eigen::Matrix2d F[2];
  F[0] << 1.02, 0.15, 0.0, 0.98;
  F[1] << 0.99, -0.2, 0.05, 1.03;
  for (int step = 0; step < 2; ++step) {
    stack.begin_step();
    for (int i = 0; i < 5; ++i) {
      exchange::Motion m;
      m.position = solve::make_layer_mesh(scene, i).reference;
      m.vote = 1e-6;
      m.position.matrix().topRows<2>() = (F[i == 2] * m.position.matrix().topRows<2>()).eval();
      m.position.row(0) += 0.003 * step * i;
      m.position.row(1) -= 0.001 * step * i;
      m.position.row(2) -= 0.01 * i;
      test::accept(stack, i, m, step ? 1e-6 : 0);
    }
  }
  const auto fields = describe_interface(scene, stack, 2);  // between ply_1 and ply_2
  const NodalVectors traction = take(fields, "true_traction");
  const auto along = take(fields, "true_traction_along_fibres");
  const auto along_other = take(fields, "true_traction_along_other_fibres");
  const double degrees[2] = {20, -35};
  const auto touching = take(fields, "true_pressure").row(0) > 0;
  ASSERT_GT(touching.count(), 10);
  for (Eigen::Index i = 0; i < traction.cols(); ++i) {
    const Eigen::Vector2d tau = at(traction, i).head<2>();
    for (int layer = 0; layer < 2; ++layer)
      for (int fibre = 0; fibre < 2; ++fibre) {
        const double angle = degrees[layer] * M_PI / 180 + fibre * M_PI / 2;
        const Eigen::Vector2d d = (F[layer] * Eigen::Vector2d(std::cos(angle), std::sin(angle))).normalized();
        EXPECT_NEAR((layer == 0 ? along : along_other)(fibre, i), tau.dot(d), 1e-9 * (1 + tau.norm()));
      }
  }
  EXPECT_FALSE(test::has(describe_interface(scene, stack, 0), "true_traction_along_fibres"));  // a sheet on the die
  EXPECT_FALSE(test::has(describe_interface(scene, stack, 1), "true_traction_along_fibres"));
  EXPECT_TRUE(test::has(describe_interface(scene, stack, 1), "true_traction_along_other_fibres"));
  EXPECT_TRUE(test::has(describe_interface(scene, stack, 3), "true_traction_along_fibres"));
  EXPECT_TRUE(test::has(describe_interface(scene, stack, 4), "true_traction_along_fibres"));
  EXPECT_FALSE(test::has(describe_interface(scene, stack, 4), "true_traction_along_other_fibres"));
}

/// The gap of a node that cannot touch is not followed from step to step; recorded is where the tool is now.
TEST(InterfaceFields, GapToAToolIsThatOfTheInstantHoweverFarItIs) {
  const scene::Scene scene = test::read_flat_stack();
  Stack stack(scene);
  for (int step = 0; step < 4; ++step) {
    stack.move_tools(-20.0 + 3 * step, 0);  // away from the stack, and back
    stack.begin_step();
    for (int i = 0; i < 5; ++i) {
      exchange::Motion still;
      still.position = solve::make_layer_mesh(scene, i).reference;
      still.vote = 1e-6;
      test::accept(stack, i, still, step ? 1e-6 : 0);
    }
    const auto fields = describe_interface(scene, stack, stack.n_interfaces() - 1);
    const auto gap = take(fields, "gap");
    const NodalVectors normal = take(fields, "normal");
    const auto& x = stack.layer(4).mesh.reference;
    for (Eigen::Index i = 0; i < gap.cols(); ++i) {
      const contact::Distance d = stack.punch()->shape->evaluate(at(x, i) - Vector3(0, 0, stack.punch()->z));
      EXPECT_NEAR(gap(0, i), d.value - 0.5, 1e-9) << step;
      EXPECT_LT((at(normal, i) + d.gradient).norm(), 1e-9);
    }
  }
}

}  // namespace
