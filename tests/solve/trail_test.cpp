/// A layer whose passes trail each other through rings against the same layer pass after pass, which threads run.
#include "solve/trail.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "mechanics/digest.hpp"
#include "solve/blocks.hpp"
#include "solver_fabric/fabric_layer.hpp"
#include "solver_metal/metal_layer.hpp"
#include "support/bending_sheet.hpp"

namespace interply::solve {
namespace {

using Eigen::Index;
using mechanics::NodalVectors;
using mechanics::TriangleMesh;

/// The same triangles in the order `order`.
TriangleMesh reorder(TriangleMesh mesh, const std::vector<int>& order) {
  const mechanics::Triangles old = mesh.triangles;
  for (std::size_t e = 0; e < order.size(); ++e) mesh.triangles.col(static_cast<Index>(e)) = old.col(order[e]);
  mesh.neighbours = mechanics::find_neighbours(mesh.triangles, mesh.n_nodes());
  return mesh;
}

/// `amount` of the triangles change places with others.
TriangleMesh shuffle(const TriangleMesh& mesh, double amount) {
  std::vector<int> order(static_cast<std::size_t>(mesh.n_elements()));
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(3);
  for (std::size_t i = 0; i < static_cast<std::size_t>(amount * static_cast<double>(order.size())); ++i)
    std::swap(order[random() % order.size()], order[random() % order.size()]);
  return reorder(mesh, order);
}

TriangleMesh turn_round(const TriangleMesh& mesh) {
  std::vector<int> order(static_cast<std::size_t>(mesh.n_elements()));
  std::iota(order.rbegin(), order.rend(), 0);
  return reorder(mesh, order);
}

struct Case {
  const char* name;
  TriangleMesh mesh;
};

std::vector<Case> make_cases() {
  const TriangleMesh half = mechanics::make_rectangle({-60, 60}, {0, 120}, 3, 0, true);  // 3200 elements, 80 a row
  return {{"row by row", half},
          {"the nodes against the elements", turn_round(half)},
          {"long rows", mechanics::make_rectangle({-300, 300}, {0, 24}, 2, 0, true)},
          {"random order", shuffle(half, 2)},
          {"three elements far away", shuffle(half, 0.001)},
          {"irregular", mechanics::test::make_unstructured({0, 90}, {0, 120}, 3)},
          {"one block", mechanics::make_rectangle({0, 30}, {0, 30}, 3, 0, true)},
          {"whole blocks", mechanics::make_rectangle({0, 32}, {0, 64}, 1, 0, true)}};
}

NodalVectors make_shape(const TriangleMesh& mesh, double t) {
  NodalVectors x = mesh.reference;
  for (Index i = 0; i < x.cols(); ++i) {
    const double u = mesh.reference(0, i), v = mesh.reference(1, i);
    x(0, i) += 0.2 * t * std::sin(0.2 * u + 0.11 * v);
    x(2, i) += t * std::sin(0.17 * u) * std::cos(0.13 * v);
  }
  return x;
}

/// A few steps in which the edges move, too.
std::uint64_t run(LayerMechanics& layer, const TriangleMesh& mesh) {
  NodalVectors force;
  mechanics::Digest digest;
  double time = 0;
  for (int step = 0; step < 4; ++step) {
    const double dt = step == 0 ? 0 : 1e-7 * step;
    layer.compute_internal_forces(make_shape(mesh, 0.1 + 0.01 * step), {.time = time += dt, .dt = dt}, force);
    digest.add(force);
    digest.add(mechanics::Scalars(mechanics::Scalars::Constant(1, layer.internal_energy())));
  }
  layer.add_state_to(digest);
  return digest.value();
}

TEST(Trail, RingsHoldWhatEveryPassNeeds) {
  for (const Case& c : make_cases()) {
    SCOPED_TRACE(c.name);
    scene::Layer layer;
    layer.name = "ply";
    layer.thickness = 1.2;
    layer.density = 6e-10;
    layer.law = scene::WovenLaw{};
    const auto run_ply = [&](int threads) {
      layer.threads = threads;
      fabric::FabricLayer ply(layer, 1, c.mesh);
      return run(ply, c.mesh);
    };
    EXPECT_EQ(run_ply(1), run_ply(2));
    layer.law = scene::J2Law{};
    const auto run_sheet = [&](int threads) {
      layer.threads = threads;
      metal::MetalLayer sheet(layer, 7.85e-9, c.mesh);
      return run(sheet, c.mesh);
    };
    EXPECT_EQ(run_sheet(1), run_sheet(2));
  }
}

TEST(Trail, RowByRowTheRingsAreAFewBlocks) {
  const Trail trail = make_trail(mechanics::make_shell_geometry(make_cases()[0].mesh, 0));
  EXPECT_EQ(trail.lag, 1);  // neighbours at most 81 elements away
  EXPECT_EQ(trail.rings.facets.size, 3 * kBlockSize);
  EXPECT_EQ(trail.rings.moments.size, 3 * kBlockSize);
  EXPECT_EQ(trail.rings.corners.size, 2 * kBlockSize);  // a node joins two rows
}

TEST(Trail, FarNeighboursMakeTheRingsHoldAllElements) {
  const TriangleMesh mesh = make_cases()[3].mesh;
  const Trail trail = make_trail(mechanics::make_shell_geometry(mesh, 0));
  EXPECT_EQ(trail.rings.facets.size, mesh.n_elements());
  EXPECT_EQ(trail.rings.moments.size, mesh.n_elements());
  EXPECT_EQ(trail.rings.corners.size, mesh.n_elements());
}

TEST(Trail, EveryEdgeNodeAndImageIsReachedOnceAndNotTooEarly) {
  for (const Case& c : make_cases()) {
    SCOPED_TRACE(c.name);
    const auto shell = mechanics::make_shell_geometry(c.mesh, 0);
    const Trail trail = make_trail(shell);
    const Index n = shell.n_elements();
    for (const auto* count : {&trail.images, &trail.advanced, &trail.driven, &trail.gathered}) {
      ASSERT_EQ(static_cast<Index>(count->size()), trail.n_blocks);
      EXPECT_TRUE(std::is_sorted(count->begin(), count->end()));
    }
    EXPECT_EQ(trail.images.back(), static_cast<Index>(shell.images.size()));
    EXPECT_EQ(trail.advanced.back(), count_blocks(shell.n_edges()));
    EXPECT_EQ(trail.driven.back(), count_blocks(shell.n_edges()));
    EXPECT_EQ(trail.gathered.back(), c.mesh.n_nodes());
    for (Index e = 0; e < n; ++e) {
      const auto block = static_cast<std::size_t>(e / kBlockSize);
      const Index earlier = block == 0 ? 0 : trail.driven[block - 1],
                  gathered = block == 0 ? 0 : trail.gathered[block - 1];
      for (int k = 0; k < 3; ++k) {
        EXPECT_LT(shell.edge(k, e), trail.advanced[block] * kBlockSize);
        EXPECT_GE(shell.edge(k, e) / kBlockSize, earlier);
        EXPECT_GE(shell.nodes(k, e), gathered);
      }
    }
  }
}

}  // namespace
}  // namespace interply::solve
