#include "mechanics/mesh.hpp"

#include <gtest/gtest.h>

#include <set>

namespace {

using namespace interply::mechanics;

TEST(RectangleMesh, AreasAddUpAndMassIsDensityTimesVolume) {
  const TriangleMesh mesh = make_rectangle({-140, 140}, {0, 140}, 10, 0.5, true);
  EXPECT_EQ(mesh.n_elements(), 2 * 28 * 14);
  EXPECT_NEAR(compute_areas(mesh).sum(), 280 * 140, 1e-9);
  EXPECT_GT(compute_areas(mesh).minCoeff(), 0);
  EXPECT_NEAR(compute_tributary_areas(mesh).sum(), 280 * 140, 1e-9);
  EXPECT_NEAR(compute_lumped_mass(mesh, 1.2, 6.19e-10).sum(), 280 * 140 * 1.2 * 6.19e-10, 1e-18);
  EXPECT_EQ(mesh.symmetry_nodes.size(), 29u);
}

TEST(RectangleMesh, DiagonalsAlternate) {
  const TriangleMesh mesh = make_rectangle({0, 2}, {0, 2}, 1);
  // an inner node of alternating diagonals belongs to eight triangles or to four
  std::vector<int> count(9, 0);
  for (int i = 0; i < mesh.triangles.size(); ++i) ++count[static_cast<std::size_t>(mesh.triangles.data()[i])];
  EXPECT_EQ(count[4], 8);  // centre
  EXPECT_EQ(count[1], 2);
}

TEST(Mesh, HalfOfABlankIsHeldAtItsSymmetryPlane) {
  const std::vector<std::array<int, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
  const TriangleMesh mesh = make_mesh({{-1, 1e-9}, {1, 0}, {1, 1}, {-1, 1}}, triangles, 0.5, true);
  EXPECT_EQ(mesh.symmetry_nodes, (std::vector<int>{0, 1}));
  EXPECT_EQ(mesh.reference(1, 0), 0);
  EXPECT_EQ(mesh.reference(2, 3), 0.5);
  EXPECT_EQ(mesh.neighbours(1, 0), 1);  // opposite corner 1 of the first triangle
  EXPECT_NEAR(compute_areas(mesh).sum(), 2, 1e-8);
  EXPECT_TRUE(make_mesh({{-1, 0}, {1, 0}, {1, 1}, {-1, 1}}, triangles, 0.5, false).symmetry_nodes.empty());
  EXPECT_THROW(make_mesh({{-1, -1e-3}, {1, 0}, {1, 1}, {-1, 1}}, triangles, 0, true), std::invalid_argument);
  EXPECT_THROW(make_mesh({{-1, 0.1}, {1, 0}, {1, 1}, {-1, 1}}, triangles, 0, true), std::invalid_argument);
}

TEST(Neighbours, AreMutualAndShareASide) {
  const TriangleMesh mesh = make_rectangle({0, 5}, {0, 3}, 1);
  int boundary = 0;
  for (int e = 0; e < mesh.n_elements(); ++e)
    for (int k = 0; k < 3; ++k) {
      const int other = mesh.neighbours(k, e);
      if (other < 0) {
        ++boundary;
        continue;
      }
      std::multiset<int> back{mesh.neighbours(0, other), mesh.neighbours(1, other), mesh.neighbours(2, other)};
      EXPECT_EQ(back.count(e), 1u);
      std::set<int> corners;
      for (int m = 0; m < 3; ++m) corners.insert({mesh.triangles(m, e), mesh.triangles(m, other)});
      EXPECT_EQ(corners.size(), 4u);
    }
  EXPECT_EQ(boundary, 2 * (5 + 3));
}

TEST(Neighbours, SideOfThreeElementsIsRefused) {
  Triangles t(3, 3);
  t << 0, 0, 0, 1, 1, 1, 2, 3, 4;
  EXPECT_THROW(find_neighbours(t, 5), std::invalid_argument);
}

TEST(Incidence, GathersEveryEntryOnceWithElementsAscending) {
  const TriangleMesh mesh = make_rectangle({0, 3}, {0, 3}, 1);
  const Incidence incidence = make_incidence(mesh.triangles.data(), 3, mesh.n_elements(), mesh.n_nodes());
  EXPECT_EQ(incidence.entry.size(), static_cast<std::size_t>(3 * mesh.n_elements()));
  for (int i = 0; i < mesh.n_nodes(); ++i) {
    int last = -1;
    for (int k = incidence.start[i]; k < incidence.start[i + 1]; ++k) {
      const int entry = incidence.entry[static_cast<std::size_t>(k)];
      EXPECT_EQ(mesh.triangles.data()[entry], i);
      const int element = entry % static_cast<int>(mesh.n_elements());
      EXPECT_GT(element, last);
      last = element;
    }
  }
}

}  // namespace
