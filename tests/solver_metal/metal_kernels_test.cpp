/// Kernels of all targets against one element at a time with the law of support/reference_law.hpp.
#include "solver_metal/metal_kernels.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "solver_metal/hardening.hpp"
#include "support/metal_sheet.hpp"
#include "support/reference_law.hpp"

namespace interply::metal::test {
namespace {

struct Case {
  const char* name;
  scene::Hardening hardening;
  bool hill48 = false;
};

const scene::Swift kSwift{};
const scene::Voce kVoce{120, 300, 12};
const scene::HockettSherby kHockettSherby{160, 420, 5, 0.7}, kSteep{160, 420, 5, 0.4};  // infinite initial slope
const scene::HardeningTable kTable{{{{0, 160}, {0.002, 200}, {0.05, 230}, {0.2, 300}}}}, kPerfect{{{{0, 200}}}};
/// Not concave: Halley's method goes to and fro across the jump, and the bracketed return takes over.
const scene::HardeningTable kJump{{{{0, 160}, {0.002, 161}, {0.002001, 400}, {0.1, 410}}}};
const Case kCases[] = {{"swift", kSwift},
                       {"voce", kVoce},
                       {"hockett_sherby", kHockettSherby},
                       {"hockett_sherby_steep", kSteep},
                       {"table", kTable},
                       {"perfect", kPerfect},
                       {"jump", kJump},
                       {"hill48_swift", kSwift, true},
                       {"hill48_voce", kVoce, true},
                       {"hill48_hockett_sherby", kHockettSherby, true},
                       {"hill48_table", kTable, true}};

/// A sheet of 98 elements, no multiple of any width, advanced by a kernel or by the reference.
class KernelSheet {
 public:
  explicit KernelSheet(const Case& c, int points = 5)
      : mesh(make_distorted_square(28, 4, 0.15)),
        law({210e3, 0.3, c.hardening, c.hill48 ? std::optional(scene::Hill48{1.8, 1.2, 2.1}) : std::nullopt}),
        reference(law),
        constants(law),
        rule(make_lobatto_rule(points)),
        geometry(mechanics::make_shell_geometry(mesh, 0)),
        passes(geometry),
        shell(geometry, passes),
        phi(mechanics::Scalars::Zero(geometry.n_edges())) {
    const Eigen::Index n = geometry.n_elements();
    metric = Rows::Zero(3, n);
    metric.topRows(2).setOnes();
    curvature = Rows::Zero(3, n);
    stress = Rows::Zero(3 * points, n);
    plastic_strain = Rows::Zero(points, n);
    const YieldStress<double> initial = compute_yield_stress(law.hardening, 0);
    yield_stress = Rows::Constant(points, n, initial.stress);
    yield_slope = Rows::Constant(points, n, initial.slope);
    thickness = mechanics::Scalars::Ones(n);
  }

  SheetRows rows() {
    SheetRows r;
    for (int c = 0; c < 3; ++c) {
      r.metric[c] = &metric(c, 0);
      r.curvature[c] = &curvature(c, 0);
    }
    r.thickness = thickness.data();
    r.stress = stress.data();
    r.plastic_strain = plastic_strain.data();
    r.yield_stress = yield_stress.data();
    r.yield_slope = yield_slope.data();
    r.xi = rule.point.data();
    r.weight = rule.weight.data();
    r.n_points = rule.size();
    r.n = geometry.n_elements();
    return r;
  }

  /// In two ranges. @return stress work
  double advance(const MetalKernels& kernels, const NodalVectors& x) {
    const double* const at[3] = {&x(0, 0), &x(1, 0), &x(2, 0)};
    const Eigen::Index n = geometry.n_elements();
    EXPECT_EQ(kernels.compute_facets(shell, at, 0.05, 20, 0, n), -1);
    const SheetAdvance first = kernels.advance(shell, rows(), constants, phi.data(), 0, 64);
    const SheetAdvance second = kernels.advance(shell, rows(), constants, phi.data(), 64, n);
    EXPECT_EQ(first.bad, -1);
    EXPECT_EQ(second.bad, -1);
    return first.work + second.work;
  }

  double advance_reference(const NodalVectors& x) {
    for (Eigen::Index e = 0; e < geometry.n_elements(); ++e)
      passes.store_facet(e, mechanics::compute_surface_gradient(geometry, x, e));
    double work = 0;
    for (Eigen::Index e = 0; e < geometry.n_elements(); ++e) work += advance_element(e);
    return work;
  }

  /// Bounds of the highest w^2, 1/s2, of every eight elements, for a tangent of its own, with masses and bending that
  /// no two nodes or elements share.
  mechanics::Scalars bound(const MetalKernels& kernels) {
    mechanics::Scalars q = mechanics::Scalars::Zero(mesh.n_nodes()), bounds(13);
    kernels.add_nodal_stiffness(shell, rows(), q.data());
    q /= mass();
    const mechanics::Scalars flat = bending();
    const IncrementRows increment{q.data(), flat.data(), kYoung, kPoisson, kStiffening, kThickness};
    for (Eigen::Index i = 0; i < 13; ++i)
      bounds(i) = kernels.bound_frequency2(shell, rows(), increment, 8 * i, std::min<Eigen::Index>(98, 8 * i + 8));
    return bounds;
  }
  /// (T1) to (T3), with eigenvalues and square roots of matrices.
  mechanics::Scalars bound_reference() const {
    mechanics::Scalars q = mechanics::Scalars::Zero(mesh.n_nodes()), bounds = mechanics::Scalars::Zero(13);
    for (Eigen::Index e = 0; e < geometry.n_elements(); ++e)
      for (int k = 0; k < 3; ++k) q(mesh.triangles(k, e)) += volume(e) * compute_gradient(k, e).squaredNorm();
    Eigen::Matrix3d tangent;
    tangent << 1, kPoisson, 0, kPoisson, 1, 0, 0, 0, (1 - kPoisson) / 2;
    tangent *= kYoung / (1 - kPoisson * kPoisson);
    for (Eigen::Index e = 0; e < geometry.n_elements(); ++e) {
      Eigen::Matrix2d gram = Eigen::Matrix2d::Zero();
      Eigen::Matrix3d shares = Eigen::Matrix3d::Zero();  // B M^-1 B' v
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector2d g = compute_gradient(k, e);
        const int node = mesh.triangles(k, e);
        const double per_mass = q(node) / mass()(node) / g.squaredNorm();
        Eigen::Matrix<double, 3, 2> b;
        b << g(0), 0, 0, g(1), g(1), g(0);
        shares += per_mass * b * b.transpose();
        gram += per_mass * g * g.transpose();
      }
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> root(shares);
      const Eigen::Matrix3d half = root.operatorSqrt();
      const double elastic = find_largest(Eigen::Matrix3d(half * tangent * half));
      double von_mises = 0;
      const ReferenceLaw j2({});
      for (int i = 0; i < rule.size(); ++i)
        von_mises =
            std::max(von_mises, j2.compute_equivalent({stress(3 * i, e), stress(3 * i + 1, e), stress(3 * i + 2, e)}));
      const double membrane = elastic + 3 * (2 / std::sqrt(3.0) * von_mises) * find_largest(gram);
      const Eigen::Vector2d c = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(load_metric(e)).eigenvalues();
      const double growth =
          std::sqrt(c(0) * c(1)) * std::pow(thickness(e) / kThickness, 3) * std::max(1.0, c(1)) / std::pow(c(0), 2);
      bounds(e / 8) = std::max(bounds(e / 8), membrane + kStiffening * bending()(e) * growth);
    }
    return bounds;
  }

  TriangleMesh mesh;
  scene::J2Law law;
  ReferenceLaw reference;
  LawConstants constants;
  ThicknessRule rule;
  mechanics::ShellGeometry geometry;
  mechanics::ShellPasses passes;
  mechanics::ShellRows shell;
  mechanics::Scalars phi;
  Rows metric, curvature, stress, plastic_strain, yield_stress, yield_slope;
  mechanics::Scalars thickness;

 private:
  static constexpr double kYoung = 180e3, kPoisson = 0.25, kStiffening = 1.2, kThickness = 0.9;
  mechanics::Scalars mass() const { return mechanics::Scalars::LinSpaced(mesh.n_nodes(), 1e-7, 2e-7); }
  mechanics::Scalars bending() const { return mechanics::Scalars::LinSpaced(geometry.n_elements(), 1e12, 3e12); }
  template <class Matrix>
  static double find_largest(const Matrix& a) {
    return Eigen::SelfAdjointEigenSolver<Matrix>(a).eigenvalues().maxCoeff();
  }
  Eigen::Matrix2d load_metric(Eigen::Index e) const {
    Eigen::Matrix2d c;
    c << metric(0, e), metric(2, e), metric(2, e), metric(1, e);
    return c;
  }
  double volume(Eigen::Index e) const {
    return geometry.area(e) * std::sqrt(load_metric(e).determinant()) * thickness(e);
  }
  /// g_k of (T2).
  Eigen::Vector2d compute_gradient(int k, Eigen::Index e) const {
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(load_metric(e)).operatorInverseSqrt() *
           Eigen::Vector2d(geometry.gradient(2 * k, e), geometry.gradient(2 * k + 1, e));
  }
  double advance_element(Eigen::Index e) {
    const mechanics::SurfaceGradient g = passes.facet(e);
    const auto k = mechanics::compute_curvature(geometry, passes, phi, e);
    const ElementShape now{
        {g.f1.squaredNorm(), g.f2.squaredNorm(), g.f1.dot(g.f2)}, {k.k11, k.k22, k.k12}, g.area_ratio};
    ElementShape before{{metric(0, e), metric(1, e), metric(2, e)},
                        {curvature(0, e), curvature(1, e), curvature(2, e)}};
    before.area_ratio = std::sqrt(before.metric.determinant());
    const StrainIncrement de = compute_strain_increment(before, now, thickness(e));
    Symmetric2 mean{}, moment{};
    double thickness_strain = 0, stress_work = 0;
    for (int i = 0; i < rule.size(); ++i) {
      const double w = rule.weight[i], xi = rule.point[i];
      const Symmetric2 strain = de.membrane + xi * de.bending;
      const Symmetric2 old{stress(3 * i, e), stress(3 * i + 1, e), stress(3 * i + 2, e)};
      ReferenceLaw::Point point{{old.m11, old.m22, old.m12}, plastic_strain(i, e)};
      thickness_strain += w * reference.advance({strain.m11, strain.m22, 2 * strain.m12}, point);
      const Symmetric2 now_stress{point.stress(0), point.stress(1), point.stress(2)};
      stress_work += w * 0.5 * contract(old + now_stress, strain);
      mean = mean + w * now_stress;
      moment = moment + (w * xi) * now_stress;
      store(stress, 3 * i, e, now_stress);
      plastic_strain(i, e) = point.plastic_strain;
      yield_stress(i, e) = reference.compute_yield(point.plastic_strain);
    }
    const double old_thickness = thickness(e);
    thickness(e) *= std::exp(thickness_strain);
    store(metric, 0, e, now.metric);
    store(curvature, 0, e, now.curvature);
    const Resultants r = compute_resultants(now, thickness(e), mean, moment);
    store(passes.membrane, 0, e, geometry.area(e) * r.force);
    mechanics::store_moments(geometry, k, r.moment.m11, r.moment.m22, r.moment.m12, e, passes);
    return 0.5 * geometry.area(e) * (before.area_ratio * old_thickness + now.area_ratio * thickness(e)) * stress_work;
  }
  template <class Array>
  static void store(Array& array, Eigen::Index row, Eigen::Index e, const Symmetric2& a) {
    array(row, e) = a.m11;
    array(row + 1, e) = a.m22;
    array(row + 2, e) = a.m12;
  }
};

/// Positions on the way: every node goes its own way, by 1e-6 to `most` of the mesh size in each step and three times
/// less out of the plane, so that a pack holds elastic, nearly elastic and strongly yielding elements.
class Walk {
 public:
  explicit Walk(const KernelSheet& sheet, double most) : x_(sheet.mesh.reference), most_(most) {}
  const NodalVectors& step() {
    std::uniform_real_distribution<double> logarithm(std::log(1e-6), std::log(most_)), component(-1, 1);
    for (Eigen::Index i = 0; i < x_.cols(); ++i) {
      const double size = 4 * std::exp(logarithm(random_));
      for (int c = 0; c < 3; ++c) x_(c, i) += (c == 2 ? size / 3 : size) * component(random_);
    }
    return x_;
  }

 private:
  NodalVectors x_;
  double most_;
  std::mt19937 random_{5};
};

/// Largest difference over the largest value, which counts as at least `scale`.
template <class Array>
double compare(const Array& a, const Array& b, double scale = 0) {
  return (a - b).abs().maxCoeff() / std::max(scale, b.abs().maxCoeff());
}

template <class Target>
bool can_run() {
  return true;
}
#if defined(__x86_64__)
template <>
bool can_run<simd::Avx512>() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq");
}
using Targets = testing::Types<simd::Scalar, simd::Avx2, simd::Avx512>;
#else
using Targets = testing::Types<simd::Scalar>;
#endif

template <class Target>
class MetalKernelsOn : public testing::Test {
 protected:
  void SetUp() override {
    if (!can_run<Target>()) GTEST_SKIP() << "not on this machine";
  }
  const MetalKernels& kernels = get_metal_kernels<Target>();
};
TYPED_TEST_SUITE(MetalKernelsOn, Targets);

TYPED_TEST(MetalKernelsOn, AgreeWithTheReferenceLawFromElasticToLargePlasticIncrements) {
  for (const Case& c : kCases)
    for (const double most : {1e-4, 1e-2, 0.1}) {
      KernelSheet ours(c), plain(c);
      Walk walk(ours, most);
      for (int s = 0; s < 6; ++s) {
        const NodalVectors& x = walk.step();
        const double work = ours.advance(this->kernels, x), expected = plain.advance_reference(x);
        SCOPED_TRACE(testing::Message() << c.name << ", increments up to " << most << ", step " << s);
        // strain is a difference of metrics: 1e-15 of it is 2e-10 MPa, 1e-12 of a yield stress
        constexpr double kYield = 160, kMembrane = 8 * kYield, kSlope = kYield / 12 * 8, kForce = kSlope / 100;
        EXPECT_LT(compare(ours.stress, plain.stress, kYield), 2e-12);
        EXPECT_NEAR(work, expected, 2e-12 * std::max(std::fabs(expected), 98 * 8 * kYield * most));
        EXPECT_LT((ours.plastic_strain - plain.plastic_strain).abs().maxCoeff(), 1e-14);
        EXPECT_LT(compare(ours.yield_stress, plain.yield_stress), 1e-12);
        EXPECT_LT(compare(ours.thickness, plain.thickness), 1e-13);
        EXPECT_LT(compare(ours.metric, plain.metric), 1e-14);
        EXPECT_LT(compare(ours.curvature, plain.curvature), 1e-11);
        EXPECT_LT(compare(ours.passes.membrane, plain.passes.membrane, kMembrane), 4e-12);
        EXPECT_LT(compare(ours.passes.slope_moment, plain.passes.slope_moment, kSlope), 4e-12);
        EXPECT_LT(compare(ours.passes.height_force, plain.passes.height_force, kForce), 4e-12);
        EXPECT_LT((ours.bound(this->kernels) / plain.bound_reference() - 1).abs().maxCoeff(), 1e-12);
      }
      const bool yields = plain.plastic_strain.maxCoeff() > 0;
      EXPECT_TRUE(yields || most < 1e-3) << c.name;
    }
}

/// The yield condition itself, at every point that yielded; yield_stress says sigma_y(p) at every point.
TYPED_TEST(MetalKernelsOn, LeavePointsOnTheirYieldSurface) {
  for (const Case& c : kCases)
    for (const double most : {1e-3, 0.1}) {
      KernelSheet sheet(c);
      Walk walk(sheet, most);
      for (int s = 0; s < 6; ++s) {
        const Rows before = sheet.plastic_strain;
        sheet.advance(this->kernels, walk.step());
        for (int i = 0; i < 5; ++i)
          for (Eigen::Index e = 0; e < sheet.thickness.size(); ++e) {
            const double p = sheet.plastic_strain(i, e), yield = compute_yield_stress(sheet.law.hardening, p).stress;
            ASSERT_NEAR(sheet.yield_stress(i, e), yield, 1e-12 * yield) << c.name << ", p = " << p;
            ASSERT_GE(p, before(i, e));
            if (p == before(i, e)) continue;
            const Symmetric2 stress{sheet.stress(3 * i, e), sheet.stress(3 * i + 1, e), sheet.stress(3 * i + 2, e)};
            const double equivalent = sheet.reference.compute_equivalent({stress.m11, stress.m22, stress.m12});
            ASSERT_NEAR(equivalent, yield, 2e-12 * yield) << c.name << ", p = " << p;
          }
      }
    }
}

TYPED_TEST(MetalKernelsOn, NameTheFirstBadElement) {
  KernelSheet sheet(kCases[0]);
  NodalVectors x = sheet.mesh.reference;
  const int lost = sheet.mesh.triangles(0, 70);
  x(0, lost) = NAN;
  Eigen::Index first = 0;
  while (!(sheet.mesh.triangles.col(first) == lost).any()) ++first;
  const double* const at[3] = {&x(0, 0), &x(1, 0), &x(2, 0)};
  EXPECT_EQ(this->kernels.compute_facets(sheet.shell, at, 0.05, 20, 0, 98), first);
  EXPECT_EQ(this->kernels.compute_facets(sheet.shell, at, 0.05, 20, 0, first), -1);

  const double* const rest[3] = {&sheet.mesh.reference(0, 0), &sheet.mesh.reference(1, 0), &sheet.mesh.reference(2, 0)};
  EXPECT_EQ(this->kernels.compute_facets(sheet.shell, rest, 0.05, 20, 0, 98), -1);
  sheet.thickness(97) = NAN;
  sheet.thickness(53) = 0;
  EXPECT_EQ(this->kernels.advance(sheet.shell, sheet.rows(), sheet.constants, sheet.phi.data(), 0, 98).bad, 53);
  EXPECT_EQ(this->kernels.advance(sheet.shell, sheet.rows(), sheet.constants, sheet.phi.data(), 54, 98).bad, 97);
}

#if defined(__x86_64__)
TEST(MetalKernels, GiveTheSameBitsInPacksOfFourAndEight) {
  if (!can_run<simd::Avx512>()) GTEST_SKIP() << "not on this machine";
  for (const Case& c : kCases)
    for (const double most : {1e-4, 1e-2, 0.1}) {
      KernelSheet four(c, 7), eight(c, 7);
      Walk walk(four, most);
      for (int s = 0; s < 6; ++s) {
        const NodalVectors& x = walk.step();
        SCOPED_TRACE(testing::Message() << c.name << ", increments up to " << most << ", step " << s);
        EXPECT_EQ(four.advance(get_metal_kernels<simd::Avx2>(), x),
                  eight.advance(get_metal_kernels<simd::Avx512>(), x));
        EXPECT_TRUE((four.stress == eight.stress).all());
        EXPECT_TRUE((four.plastic_strain == eight.plastic_strain).all());
        EXPECT_TRUE((four.yield_stress == eight.yield_stress).all());
        EXPECT_TRUE((four.thickness == eight.thickness).all());
        EXPECT_TRUE((four.passes.membrane == eight.passes.membrane).all());
        EXPECT_TRUE((four.passes.slope_moment == eight.passes.slope_moment).all());
        EXPECT_TRUE(
            (four.bound(get_metal_kernels<simd::Avx2>()) == eight.bound(get_metal_kernels<simd::Avx512>())).all());
      }
    }
}
#endif

}  // namespace
}  // namespace interply::metal::test
