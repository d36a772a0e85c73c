#include "mechanics/edge_shell.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

#include "support/bending_sheet.hpp"

namespace interply::mechanics::test {
namespace {

/// All 21 components at work.
Eigen::Matrix3d make_anisotropic_stiffness() {
  Eigen::Matrix3d d;
  d << 3, 0.7, 0.2, 0.7, 2, -0.3, 0.2, -0.3, 1.1;
  return d;
}

/// A strongly curved, stretched and wavy state; nodes of the symmetry plane stay in it.
NodalVectors make_generic_shape(const TriangleMesh& mesh, unsigned seed = 5) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> move(-0.12, 0.12);
  NodalVectors x = map(mesh, [](double X, double Y) {
    return Vector3(1.1 * X + 0.1 * Y, 0.9 * Y, 0.15 * X * X - 0.1 * Y * Y + 0.1 * X * Y);
  });
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] += move(random);
  for (const int i : mesh.symmetry_nodes) x(1, i) = 0;
  return x;
}

Scalars make_generic_angles(const ShellGeometry& shell) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> angle(-0.2, 0.2);
  Scalars phi(shell.n_edges());
  for (Eigen::Index i = 0; i < phi.size(); ++i) phi(i) = angle(random);
  return phi;
}

TEST(EdgeShell, RigidMotionOfAFlatSheetGivesZeroForce) {
  BendingSheet sheet(make_unstructured({0, 6}, {0, 6}, 1), make_anisotropic_stiffness(), 0.4);
  const Eigen::Matrix3d turn(Eigen::AngleAxisd(1.1, Vector3(1, 2, 3).normalized()));
  sheet.evaluate(
      map(sheet.mesh, [&](double X, double Y) -> Vector3 { return turn * Vector3(X, Y, 0) + Vector3(5, 6, 7); }),
      sheet.zero_angles());
  EXPECT_LT(sheet.force.abs().maxCoeff(), 1e-12);
  EXPECT_LT(sheet.torque.abs().maxCoeff(), 1e-12);
}

TEST(EdgeShell, RigidRotationOfABentSheetTurnsItsForces) {
  BendingSheet sheet(make_unstructured({0, 6}, {0, 6}, 1), make_anisotropic_stiffness(), 0.4);
  const Eigen::Matrix3d turn(Eigen::AngleAxisd(2.1, Vector3(1, -2, 3).normalized()));
  const NodalVectors x = make_generic_shape(sheet.mesh);
  const Scalars phi = make_generic_angles(sheet.shell);
  sheet.evaluate(x, phi);
  const BendingSheet before = sheet;
  sheet.evaluate((turn * x.matrix()).array(), phi);
  EXPECT_NEAR(sheet.energy, before.energy, 1e-12 * before.energy);
  EXPECT_LT((sheet.force.matrix() - turn * before.force.matrix()).cwiseAbs().maxCoeff(),
            1e-11 * before.force.abs().maxCoeff());
  EXPECT_LT((sheet.torque - before.torque).abs().maxCoeff(), 1e-11 * before.torque.abs().maxCoeff());
}

TEST(EdgeShell, AnyFlatStateHasNoCurvature) {
  BendingSheet sheet(make_unstructured({0, 6}, {0, 6}, 1), make_anisotropic_stiffness(), 0.4);
  sheet.evaluate(
      map(sheet.mesh, [](double X, double Y) { return Vector3(1.3 * X + 0.2 * Y, 0.4 * X + 0.8 * Y, 0.3 * X - Y); }),
      sheet.zero_angles());
  EXPECT_LT(sheet.curvature.cwiseAbs().maxCoeff(), 1e-13);
}

struct EdgeCase {
  const char* name;
  TriangleMesh mesh;
};
std::ostream& operator<<(std::ostream& out, const EdgeCase& c) { return out << c.name; }

class EdgeShellGradient : public testing::TestWithParam<EdgeCase> {};

TEST_P(EdgeShellGradient, ForcesAndTorquesAreTheDerivativesOfTheEnergy) {
  BendingSheet sheet(GetParam().mesh, make_anisotropic_stiffness(), 0.25);
  NodalVectors x = make_generic_shape(sheet.mesh);
  Scalars phi = make_generic_angles(sheet.shell);
  sheet.evaluate(x, phi);
  const NodalVectors force = sheet.force;
  const Scalars torque = sheet.torque;
  const double h = 1e-5;
  const auto differentiate = [&](double& coordinate) {
    const double at = coordinate;
    double energy[2];
    for (const int side : {0, 1}) {
      coordinate = at + (side ? h : -h);
      sheet.evaluate(x, phi);
      energy[side] = sheet.energy;
    }
    coordinate = at;
    return (energy[1] - energy[0]) / (2 * h);
  };
  std::vector<bool> in_plane(static_cast<std::size_t>(x.cols()), false);
  for (const int i : sheet.mesh.symmetry_nodes) in_plane[i] = true;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    for (int d = 0; d < 3; ++d) {
      if (d == 1 && in_plane[i]) continue;  // held
      EXPECT_NEAR(differentiate(x(d, i)), force(d, i), 1e-8 * force.abs().maxCoeff()) << "node " << i << ", " << d;
    }
  for (Eigen::Index i = 0; i < phi.size(); ++i) {
    if (sheet.is_mirrored(i)) continue;  // held
    EXPECT_NEAR(differentiate(phi(i)), torque(i), 1e-8 * torque.abs().maxCoeff()) << "edge " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Edges, EdgeShellGradient,
                         testing::Values(EdgeCase{"interior_and_free", make_unstructured({0, 5}, {0, 4}, 1)},
                                         EdgeCase{"symmetry",
                                                  distort(make_rectangle({0, 4}, {0, 3}, 1, 0, true), 0.2)}),
                         [](const auto& info) { return info.param.name; });

TEST(EdgeShell, ForcesHaveNoResultantAndNoMoment) {
  BendingSheet sheet(make_unstructured({0, 6}, {0, 6}, 1), make_anisotropic_stiffness());
  const NodalVectors x = make_generic_shape(sheet.mesh);
  sheet.evaluate(x, make_generic_angles(sheet.shell));
  Vector3 force = Vector3::Zero(), moment = force;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    force += at(sheet.force, i);
    moment += at(x, i).cross(at(sheet.force, i));
  }
  EXPECT_LT(force.norm(), 1e-13 * sheet.force.abs().sum());
  EXPECT_LT(moment.norm(), 1e-12 * sheet.force.abs().sum());
}

// ---------------------------------------------------------------- the bending patch test

struct PatchCase {
  const char* name;
  TriangleMesh mesh;
};
std::ostream& operator<<(std::ostream& out, const PatchCase& c) { return out << c.name; }

class BendingPatch : public testing::TestWithParam<PatchCase> {};

/// Angles of all edges that are free to turn such that their torque vanishes; the free edges hold `phi` as given. The
/// energy is quadratic in phi, so one linear solution is exact.
Scalars relax(BendingSheet& sheet, const NodalVectors& x, Scalars phi) {
  std::vector<Eigen::Index> moving;
  for (Eigen::Index i = 0; i < phi.size(); ++i)
    if (!sheet.is_free(i) && !sheet.is_mirrored(i)) moving.push_back(i);
  const auto n = static_cast<Eigen::Index>(moving.size());
  const auto torque = [&] {
    sheet.evaluate(x, phi);
    Eigen::VectorXd t(n);
    for (Eigen::Index i = 0; i < n; ++i) t(i) = sheet.torque(moving[i]);
    return t;
  };
  const Eigen::VectorXd residual = torque();
  Eigen::MatrixXd k(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double before = phi(moving[j]);
    phi(moving[j]) = before + 1;
    k.col(j) = torque() - residual;
    phi(moving[j]) = before;
  }
  const Eigen::VectorXd turn = k.ldlt().solve(residual);
  for (Eigen::Index i = 0; i < n; ++i) phi(moving[i]) -= turn(i);
  sheet.evaluate(x, phi);
  return phi;
}

/// Every surface z = 1/2 X.H.X: bending both ways and twist, in a frame turned from the mesh. The free edges are given
/// its slope; every other edge finds it by itself, and every element has the exact curvature.
TEST_P(BendingPatch, ConstantCurvatureIsExactOnceTheEdgesAreInBalance) {
  for (const Eigen::Vector3d& h : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(2, 3, 0.7)})
    for (const double angle : {0.0, 0.3}) {
      BendingSheet sheet(GetParam().mesh, make_isotropic_stiffness(2, 0.3), angle);
      const double small = 1e-6;  // slopes^2 of 1e-10 do not matter
      Matrix2 hessian, frame;
      hessian << h(0), h(2), h(2), h(1);
      frame << std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle);
      const Matrix2 expected = frame * hessian * frame.transpose();
      const NodalVectors x = map(sheet.mesh, [&](double X, double Y) {
        const Vector2 at(X, Y);
        return Vector3(X, Y, 0.5 * small * at.dot(hessian * at));
      });
      Scalars phi = sheet.zero_angles();
      for (Eigen::Index i = 0; i < phi.size(); ++i) {
        if (!sheet.is_free(i)) continue;
        // slope at the middle of the edge against that of the facet, outward
        const Eigen::Index e = sheet.shell.edge_sides(0, i) % sheet.mesh.n_elements();
        const Eigen::Index k = sheet.shell.edge_sides(0, i) / sheet.mesh.n_elements();
        const Vector3 a = at(sheet.mesh.reference, sheet.mesh.triangles((k + 1) % 3, e));
        const Vector3 b = at(sheet.mesh.reference, sheet.mesh.triangles((k + 2) % 3, e));
        const Vector2 outward = Vector2((b - a).y(), (a - b).x()).normalized(), middle = 0.5 * (a + b).head<2>();
        const Vector3 n = compute_surface_gradient(sheet.shell, x, e).t3;
        phi(i) = small * outward.dot(hessian * middle) + outward.dot(n.head<2>()) / n.z();
      }
      relax(sheet, x, phi);
      for (Eigen::Index e = 0; e < sheet.mesh.n_elements(); ++e) {
        EXPECT_NEAR(sheet.curvature(0, e) / small, expected(0, 0), 1e-8);
        EXPECT_NEAR(sheet.curvature(1, e) / small, expected(1, 1), 1e-8);
        EXPECT_NEAR(sheet.curvature(2, e) / small, expected(0, 1), 1e-8);
      }
    }
}

/// Uniform moments leave the nodes inside and all edges inside in balance, load a boundary edge of length l with
/// l m_nn, the nodes of a straight boundary with nothing and the corners of a rectangle with 2 m12.
TEST_P(BendingPatch, ConstantMomentsAreInBalanceAndLoadTheEdgesAndCorners) {
  BendingSheet sheet(GetParam().mesh, make_isotropic_stiffness(2, 0.3));
  const double m11 = 0.7, m22 = -0.4, m12 = 0.3;
  sheet.apply_moments(sheet.mesh.reference, sheet.zero_angles(), m11, m22, m12);
  const auto& r = sheet.mesh.reference;
  NodalVectors force = sheet.force;
  for (Eigen::Index i = 0; i < sheet.shell.n_edges(); ++i) {
    if (!sheet.is_free(i)) {
      EXPECT_NEAR(sheet.torque(i), 0, 1e-12);
      continue;
    }
    const Eigen::Index e = sheet.shell.edge_sides(0, i) % sheet.mesh.n_elements();
    const Eigen::Index k = sheet.shell.edge_sides(0, i) / sheet.mesh.n_elements();
    const Vector3 along = at(r, sheet.mesh.triangles((k + 2) % 3, e)) - at(r, sheet.mesh.triangles((k + 1) % 3, e));
    const double couple = along.norm() * (std::abs(along.x()) < 1e-12 ? m11 : m22);
    EXPECT_NEAR(sheet.torque(i), couple, 1e-12);
    // phi is measured from the facet, so the couple that holds the edge turns the facet with it
    const Vector2 outward = Vector2(along.y(), -along.x()).normalized();
    for (int j = 0; j < 3; ++j)
      force(2, sheet.mesh.triangles(j, e)) -=
          couple * outward.dot(Vector2(sheet.shell.gradient(2 * j, e), sheet.shell.gradient(2 * j + 1, e)));
  }
  int corners = 0;
  for (Eigen::Index i = 0; i < r.cols(); ++i) {
    const bool at_x = r(0, i) == r.row(0).minCoeff() || r(0, i) == r.row(0).maxCoeff();
    const bool at_y = r(1, i) == r.row(1).minCoeff() || r(1, i) == r.row(1).maxCoeff();
    corners += at_x && at_y;
    EXPECT_NEAR(std::abs(force(2, i)), at_x && at_y ? 2 * m12 : 0, 1e-12);
    EXPECT_LT(sheet.force.col(i).head(2).abs().maxCoeff(), 1e-12);
  }
  EXPECT_EQ(corners, 4);
}

INSTANTIATE_TEST_SUITE_P(Meshes, BendingPatch,
                         testing::Values(PatchCase{"alternating", make_rectangle({-3, 3}, {-3, 3}, 1)},
                                         PatchCase{"one_way", make_one_way({-3, 3}, {-3, 3}, 1)},
                                         PatchCase{"perturbed", distort(make_rectangle({-3, 3}, {-3, 3}, 1), 0.25)},
                                         PatchCase{"unstructured", make_unstructured({-3, 3}, {-3, 3}, 1)}),
                         [](const auto& info) { return info.param.name; });

/// Twist is what a slope locked to the mean of two facets gets wrong on alternating diagonals: it stores 2/(1 - nu) of
/// the energy.
TEST(EdgeShell, TwistOnAlternatingDiagonalsIsTooStiffOnlyWhileTheEdgesAreLocked) {
  const double poisson = 0.3, small = 1e-6, side = 40;
  BendingSheet sheet(make_rectangle({0, side}, {0, side}, 1), make_isotropic_stiffness(1, poisson));
  const NodalVectors x = map(sheet.mesh, [&](double X, double Y) { return Vector3(X, Y, small * X * Y); });
  const double exact = small * small * (1 - poisson) * side * side;
  const auto energy_inside = [&](const Scalars& phi) {
    sheet.evaluate(x, phi);
    double energy = 0, area = 0;
    for (Eigen::Index e = 0; e < sheet.mesh.n_elements(); ++e) {
      if (sheet.mesh.neighbours.col(e).minCoeff() < 0) continue;
      const Eigen::Vector3d k(sheet.curvature(0, e), sheet.curvature(1, e), 2 * sheet.curvature(2, e));
      energy += 0.5 * sheet.shell.area(e) * k.dot(sheet.stiffness * k);
      area += sheet.shell.area(e);
    }
    return energy / area * side * side;
  };
  EXPECT_NEAR(energy_inside(sheet.zero_angles()) / exact, 2 / (1 - poisson), 1e-3);
}

// ---------------------------------------------------------------- large rotation

/// A strip rolled up on a circle: nodes on the circle, chords along the strip.
NodalVectors roll(const TriangleMesh& mesh, double h, double radius) {
  const double per_cell = 2 * std::asin(0.5 * h / radius);
  return map(mesh, [&](double X, double Y) {
    const double turn = per_cell * X / h;
    return Vector3(radius * std::sin(turn), Y, radius * (1 - std::cos(turn)));
  });
}

TEST(EdgeShell, CylinderHasItsCurvatureExactlyHoweverTight) {
  for (const TriangleMesh& mesh : {make_rectangle({0, 12}, {0, 3}, 1), make_one_way({0, 12}, {0, 3}, 1)})
    for (const double radius : {100.0, 5.0, 2.0}) {  // up to 29 deg a fold, rolled round almost once
      BendingSheet sheet(mesh, make_isotropic_stiffness(1, 0.3));
      sheet.evaluate(roll(mesh, 1, radius), sheet.zero_angles());
      int inner = 0;
      for (Eigen::Index e = 0; e < mesh.n_elements(); ++e) {
        bool at_an_end = false;  // there the slope is the free edge's own
        for (int k = 0; k < 3; ++k) {
          const double X = mesh.reference(0, mesh.triangles(k, e));
          at_an_end |= X < 0.5 || X > 11.5;
        }
        if (at_an_end) continue;
        ++inner;
        EXPECT_NEAR(sheet.curvature(0, e), 1 / radius, 1e-12);
        EXPECT_NEAR(sheet.curvature(1, e), 0, 1e-13);
        EXPECT_NEAR(sheet.curvature(2, e), 0, 1e-13);
      }
      EXPECT_GT(inner, 50);
    }
}

TEST(EdgeShell, BendingUpwardsIsPositiveAndDownwardsItsNegative) {
  BendingSheet sheet(make_rectangle({0, 6}, {0, 2}, 1), make_isotropic_stiffness(1, 0.3));
  NodalVectors x = roll(sheet.mesh, 1, 10);
  sheet.evaluate(x, sheet.zero_angles());
  const Eigen::Matrix3Xd up = sheet.curvature;
  EXPECT_GE(up.row(0).minCoeff(), -1e-15);
  x.row(2) *= -1;
  sheet.evaluate(x, sheet.zero_angles());
  EXPECT_LT((up + sheet.curvature).cwiseAbs().maxCoeff(), 1e-14);
}

// ---------------------------------------------------------------- mirrors

TEST(EdgeShell, HalfModelIsHalfOfTheWhole) {
  const TriangleMesh half = make_rectangle({-4, 4}, {0, 4}, 1, 0, true), whole = make_rectangle({-4, 4}, {-4, 4}, 1);
  const auto shape = [](double X, double Y) {
    return Vector3(1.05 * X + 0.02 * Y * Y, 0.95 * Y + 0.02 * X * Y, 0.06 * Y * Y + 0.04 * X * X + 0.01 * X * Y * Y);
  };
  BendingSheet a(half, make_isotropic_stiffness(2, 0.3)), b(whole, make_isotropic_stiffness(2, 0.3));
  a.evaluate(map(half, shape), a.zero_angles());
  b.evaluate(map(whole, shape), b.zero_angles());
  EXPECT_NEAR(a.energy, 0.5 * b.energy, 1e-12 * b.energy);
  const Eigen::Index offset = whole.n_nodes() - half.n_nodes();
  for (Eigen::Index i = 0; i < half.n_nodes(); ++i) {
    const bool on_plane = half.reference(1, i) == 0;
    for (const int d : {0, 1, 2})
      if (!(on_plane && d == 1)) {
        EXPECT_NEAR(a.force(d, i), (on_plane ? 0.5 : 1) * b.force(d, offset + i), 1e-12 * b.force.abs().maxCoeff());
      }
  }
}

/// A clamped edge keeps its slope: a sheet turned about it as a whole has the slope of the turn in its first cell.
TEST(EdgeShell, ClampedEdgeMeasuresTheSlopeAgainstThePlaneOfTheReference) {
  TriangleMesh mesh = make_rectangle({0, 4}, {0, 2}, 1);
  for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i)
    if (mesh.reference(0, i) == 0) mesh.clamped_nodes.push_back(static_cast<int>(i));
  BendingSheet sheet(mesh, make_isotropic_stiffness(1, 0));
  const double turn = 0.02;
  sheet.evaluate(map(mesh, [&](double X, double Y) { return Vector3(X * std::cos(turn), Y, X * std::sin(turn)); }),
                 sheet.zero_angles());
  for (Eigen::Index e = 0; e < mesh.n_elements(); ++e) {
    int at_edge = 0;
    for (int k = 0; k < 3; ++k) at_edge += mesh.reference(0, mesh.triangles(k, e)) == 0;
    EXPECT_NEAR(sheet.curvature(0, e), at_edge == 2 ? 2 * std::sin(turn) : 0, 1e-14);
  }
  // its moment works against the turn: dE/dturn = M times the width, E = 1/2 kappa^2 over half of the cells
  EXPECT_NEAR(sheet.energy, 2 * 0.5 * 0.5 * std::pow(2 * std::sin(turn), 2), 1e-12);
}

TEST(EdgeShell, ClockwiseElementIsRefused) {
  TriangleMesh mesh = make_rectangle({0, 1}, {0, 1}, 1);
  std::swap(mesh.triangles(0, 0), mesh.triangles(1, 0));
  EXPECT_THROW(make_shell_geometry(mesh, 0), std::invalid_argument);
}

}  // namespace
}  // namespace interply::mechanics::test
