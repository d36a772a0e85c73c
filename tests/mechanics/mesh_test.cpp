#include "mechanics/mesh.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <utility>

namespace {

using namespace interply::mechanics;

using Point = std::pair<double, double>;
using Triangle = std::set<Point>;

/// Every triangle as its corners, each multiplied by the signs.
std::set<Triangle> list_triangles(const TriangleMesh& mesh, double sign_x = 1, double sign_y = 1) {
  std::set<Triangle> all;
  for (int e = 0; e < mesh.n_elements(); ++e) {
    Triangle corners;
    for (int k = 0; k < 3; ++k) {
      const Vector3 corner = at(mesh.reference, mesh.triangles(k, e));
      corners.insert({sign_x * corner.x(), sign_y * corner.y()});
    }
    all.insert(corners);
  }
  return all;
}

std::set<Triangle> unite(std::set<Triangle> a, std::set<Triangle> b) {
  a.merge(b);
  return a;
}

/// Number of triangles around the node at the origin.
int count_at_centre(const TriangleMesh& mesh) {
  int n = 0;
  for (const Triangle& t : list_triangles(mesh)) n += static_cast<int>(t.count({0, 0}));
  return n;
}

struct BlankCase {
  double length, width, h;
};

/// Even and odd numbers of rows and columns in the half, square and not, sizes that divide no side.
const BlankCase kBlanks[] = {{280, 280, 4}, {280, 280, 8},  {280, 280, 10},   {280, 280, 20}, {280, 280, 40},
                             {280, 280, 7}, {280, 280, 93}, {280, 280, 139},  {300, 180, 20}, {180, 300, 20},
                             {100, 30, 7},  {31, 77, 3.3},  {280, 280, 17.5}, {63, 62, 30.9}, {1000, 10, 4}};

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

TEST(BlankMesh, FullIsTheHalfAndItsMirrorImageNodeByNode) {
  for (const Diagonals diagonals : {Diagonals::Centre, Diagonals::Around})
    for (const auto& [length, width, h] : kBlanks) {
      const TriangleMesh half = make_blank(length, width, h, 0.5, true, diagonals);
      const TriangleMesh full = make_blank(length, width, h, 0.5, false, diagonals);
      ASSERT_EQ(full.n_elements(), 2 * half.n_elements()) << h;
      // bit for bit: the points are compared as they are
      EXPECT_EQ(list_triangles(full), unite(list_triangles(half), list_triangles(half, 1, -1))) << h;
      EXPECT_EQ(full.n_nodes(), 2 * half.n_nodes() - static_cast<Eigen::Index>(half.symmetry_nodes.size()));
      for (const int node : half.symmetry_nodes) EXPECT_EQ(half.reference(1, node), 0);
      EXPECT_TRUE(full.symmetry_nodes.empty());
      EXPECT_EQ(half.reference(2, 0), 0.5);
      EXPECT_GT(compute_areas(half).minCoeff(), 0);
      EXPECT_NEAR(compute_areas(full).sum(), length * width, 1e-9 * length * width);
    }
}

TEST(BlankMesh, IsItsOwnMirrorImageInTheMiddleOfItsLength) {
  for (const Diagonals diagonals : {Diagonals::Centre, Diagonals::Around})
    for (const auto& [length, width, h] : kBlanks)
      for (const bool half : {true, false}) {
        const TriangleMesh mesh = make_blank(length, width, h, 0, half, diagonals);
        EXPECT_EQ(list_triangles(mesh), list_triangles(mesh, -1, 1)) << h;
      }
}

TEST(BlankMesh, DiagonalsRunThroughTheCentreOrAroundIt) {
  for (const auto& [length, width, h] : kBlanks) {
    EXPECT_EQ(count_at_centre(make_blank(length, width, h, 0, false, Diagonals::Centre)), 8) << h;
    EXPECT_EQ(count_at_centre(make_blank(length, width, h, 0, true, Diagonals::Centre)), 4) << h;
    EXPECT_EQ(count_at_centre(make_blank(length, width, h, 0, false, Diagonals::Around)), 4) << h;
    EXPECT_EQ(count_at_centre(make_blank(length, width, h, 0, true, Diagonals::Around)), 2) << h;
  }
}

TEST(BlankMesh, CellsAreAsNearToTheWantedSizeAsWholeNumbersInAHalfAllow) {
  for (const auto& [length, width, h] : kBlanks) {
    const TriangleMesh mesh = make_blank(length, width, h, 0, true, Diagonals::Centre);
    const double n = static_cast<double>(mesh.symmetry_nodes.size() - 1) / 2;  // columns in half the length
    EXPECT_NEAR(n, std::max(1.0, 0.5 * length / h), 0.5 + 1e-12) << h;
  }
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
