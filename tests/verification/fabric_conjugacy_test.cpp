/// V2: the stress is the derivative of the energy, the Hessian that of the stress; closed cycles do no work.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>

#include "solver_fabric/material_point.hpp"
#include "solver_fabric/woven_law.hpp"
#include "support/fabric_cases.hpp"
#include "support/results.hpp"

namespace interply {
namespace {

using namespace fabric_cases;
using fabric::evaluate_point;
using fabric::FabricPoint;
using fabric::MembraneLaw;
using Potential = fabric::Potential<double>;

/// Coarse tables with known corners, so that differences need not straddle one.
scene::FabricTables coarse_tables() {
  return {.warp = {{-0.2, -30}, {0, 0}, {0.03, 8}, {0.06, 40}},
          .weft = {{-0.2, -20}, {0, 0}, {0.02, 4}, {0.05, 30}, {0.08, 90}},
          .shear = {{0, 0}, {0.4, 0.03}, {0.9, 0.2}, {1.2, 1}}};
}

struct State {
  double la, lb, gamma;
};

/// Random states in all four branches that keep `clear` away from the corners of all the laws below.
std::vector<State> draw_states(int count, double clear) {
  const std::vector<double> strains{0, 0.02, 0.03, 0.05, 0.055, 0.06, 0.07, 0.08}, angles{0, 0.4, 0.9, 1.2};
  const auto is_clear = [&](double x, const std::vector<double>& corners) {
    for (const double c : corners)
      if (std::abs(x - c) < clear) return false;
    return true;
  };
  std::mt19937 random(11);
  std::uniform_real_distribution<double> strain(-0.1, 0.1), angle(-80 * kDegree, 80 * kDegree);
  std::vector<State> states;
  while (static_cast<int>(states.size()) < count) {
    const State s{1 + strain(random), 1 + strain(random), angle(random)};
    if (is_clear(s.la - 1, strains) && is_clear(s.lb - 1, strains) && is_clear(std::abs(s.gamma), angles))
      states.push_back(s);
  }
  return states;
}

std::vector<scene::WovenLaw> all_laws() {
  std::vector<scene::WovenLaw> laws;
  for (const auto variant : kVariants)
    for (auto law : all_sets(variant)) {
      if (variant == scene::Variant::Fabric) law.tables = coarse_tables();
      laws.push_back(law);
    }
  return laws;
}

Potential evaluate(const MembraneLaw& law, const State& s) { return fabric::evaluate(law, s.la, s.lb, s.gamma); }

/// Second derivatives in the order (la, lb, gamma). [3 x 3] MPa
Eigen::Matrix3d get_hessian(const Potential& w) {
  Eigen::Matrix3d h;
  h << w.W_aa, w.W_ab, w.W_ag, w.W_ab, w.W_bb, w.W_bg, w.W_ag, w.W_bg, w.W_gg;
  return h;
}

/// W as a function of the right Cauchy-Green tensor alone.
double energy_of(const MembraneLaw& law, double C11, double C22, double C12) {
  mechanics::Matrix2 F;
  F << std::sqrt(C11), C12 / std::sqrt(C11), 0, std::sqrt(C22 - C12 * C12 / C11);
  return evaluate_point(law, F).W;
}

void expect_zero(const std::string& quantity, scene::Variant variant, const char* source, double largest,
                 const char* unit, double tolerance) {
  test::expect_result({.row = "V2",
                       .quantity = fmt::format("{}, {}", quantity, name_of(variant)),
                       .source = source,
                       .reference = 0,
                       .ours = largest,
                       .unit = unit,
                       .tolerance = tolerance,
                       .absolute = true,
                       .mesh = "point"});
}

TEST(WovenLaw, StressIsTheDerivativeOfTheEnergyInGreenStrain) {
  std::map<scene::Variant, double> largest;
  for (const auto& parameters : all_laws()) {
    const MembraneLaw law = fabric::make_membrane_law(parameters);
    for (const State& s : draw_states(300, 2e-3)) {
      const double turn = 0.7;
      mechanics::Matrix2 F;
      F << s.la, s.lb * std::sin(s.gamma), 0, s.lb * std::cos(s.gamma);
      const FabricPoint p = evaluate_point(law, Eigen::Rotation2Dd(turn) * F);
      const mechanics::Matrix2 C = F.transpose() * F;
      const double h = 1e-4;  // C = 2E + 1, so dW/dE11 = 2 dW/dC11; C12 = C21 vary together
      const auto w11 = [&](double c) { return energy_of(law, c, C(1, 1), C(0, 1)); };
      const auto w22 = [&](double c) { return energy_of(law, C(0, 0), c, C(0, 1)); };
      const auto w12 = [&](double c) { return energy_of(law, C(0, 0), C(1, 1), c); };
      const double scale = 1 + std::max({std::abs(p.S11), std::abs(p.S22), std::abs(p.S12)});
      const double error = std::max({std::abs(p.S11 - 2 * differentiate(w11, C(0, 0), h)),
                                     std::abs(p.S22 - 2 * differentiate(w22, C(1, 1), h)),
                                     std::abs(p.S12 - differentiate(w12, C(0, 1), h))}) /
                           scale;
      ASSERT_LT(error, 2e-9) << name_of(parameters.variant);
      largest[parameters.variant] = std::max(largest[parameters.variant], error);
    }
  }
  for (const auto& [variant, error] : largest)
    expect_zero("largest |S - dW/dE|/(1 + |S|) over 900 states", variant, "differences of sixth order", error, "",
                2e-9);
}

TEST(WovenLaw, HessianIsTheDerivativeOfTheGradient) {
  for (const auto& parameters : all_laws()) {
    const MembraneLaw law = fabric::make_membrane_law(parameters);
    for (const State& s : draw_states(300, 2e-3)) {
      const Eigen::Matrix3d H = get_hessian(evaluate(law, s));
      const double scale = 1 + H.cwiseAbs().maxCoeff(), h = 2e-4;
      for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row) {
          const auto gradient = [&](double x) {
            State moved = s;
            (column == 0 ? moved.la : column == 1 ? moved.lb : moved.gamma) = x;
            const Potential w = evaluate(law, moved);
            return row == 0 ? w.W_a : row == 1 ? w.W_b : w.tau;
          };
          const double x = column == 0 ? s.la : column == 1 ? s.lb : s.gamma;
          ASSERT_NEAR(H(row, column), differentiate(gradient, x, h), 2e-9 * scale) << name_of(parameters.variant);
        }
    }
  }
}

TEST(WovenLaw, EnergyAndStressAreContinuousWhereTheBranchesMeet) {
  for (const auto& parameters : all_laws()) {
    const MembraneLaw law = fabric::make_membrane_law(parameters);
    const double step = 1e-12;
    for (const double other : {0.96, 1.0, 1.04})
      for (const double gamma : {-0.8, 0.0, 0.3})
        for (const bool warp : {true, false})
          for (const double corner : {1.0, 1 + parameters.strain_cap.warp, 1 + parameters.strain_cap.weft}) {
            if (!std::isfinite(corner)) continue;
            const Potential below =
                evaluate(law, warp ? State{corner - step, other, gamma} : State{other, corner - step, gamma});
            const Potential above =
                evaluate(law, warp ? State{corner + step, other, gamma} : State{other, corner + step, gamma});
            EXPECT_NEAR(below.W, above.W, 1e-8);
            EXPECT_NEAR(below.W_a, above.W_a, 1e-7);
            EXPECT_NEAR(below.W_b, above.W_b, 1e-7);
            EXPECT_NEAR(below.tau, above.tau, 1e-8);
          }
  }
}

/// Work of S over a closed loop of F, trapezoidal rule with `n` points.
double work_over_cycle(const MembraneLaw& law, const std::function<mechanics::Matrix2(double)>& path, int n) {
  double work = 0;
  const auto stress = [&](double t) {
    const FabricPoint p = evaluate_point(law, path(t));
    mechanics::Matrix2 S;
    S << p.S11, p.S12, p.S12, p.S22;
    return S;
  };
  const auto strain_rate = [&](double t) {
    const double h = 1e-3;
    mechanics::Matrix2 rate;
    for (int i = 0; i < 4; ++i)
      rate(i) = differentiate([&](double u) { return (path(u).transpose() * path(u) / 2).eval()(i); }, t, h);
    return rate;
  };
  for (int i = 0; i < n; ++i) {
    const double t = 2 * std::numbers::pi * i / n;
    work += stress(t).cwiseProduct(strain_rate(t)).sum() * 2 * std::numbers::pi / n;
  }
  return work;
}

TEST(WovenLaw, ClosedStrainCycleDoesNoWork) {
  std::map<scene::Variant, double> largest;
  for (const auto& parameters : all_laws()) {
    if (parameters.variant == scene::Variant::Fabric) continue;  // corners everywhere: see the next test
    const MembraneLaw law = fabric::make_membrane_law(parameters);
    for (const double a : {1.015, 0.985})
      for (const double b : {1.015, 0.985}) {
        const auto inside_one_branch = [&](double t) {
          const double la = a + 0.01 * std::sin(t), lb = b + 0.01 * std::cos(t), g = 0.4 + 0.3 * std::sin(t + 1);
          mechanics::Matrix2 F;
          F << la, lb * std::sin(g), 0, lb * std::cos(g);
          return F;
        };
        double& work = largest[parameters.variant];
        work = std::max(work, std::abs(work_over_cycle(law, inside_one_branch, 400)));
      }
  }
  for (const auto& [variant, work] : largest)
    expect_zero("net work of closed strain cycles, one in each branch", variant, "hyperelasticity", work, "MPa", 1e-11);
}

TEST(WovenLaw, WorkOfACycleThroughAllBranchesVanishesWithTheStep) {
  std::map<scene::Variant, double> cycle;
  for (const auto& parameters : all_laws()) {
    const MembraneLaw law = fabric::make_membrane_law(parameters);
    const auto path = [](double t) {
      const double la = 1.003 + 0.03 * std::sin(t), lb = 0.998 + 0.03 * std::cos(t), g = 0.1 + 0.7 * std::sin(t + 1);
      mechanics::Matrix2 F;
      F << la, lb * std::sin(g), 0, lb * std::cos(g);
      return F;
    };
    const double coarse = std::abs(work_over_cycle(law, path, 500)), fine = std::abs(work_over_cycle(law, path, 8000));
    EXPECT_LT(fine, 2e-7) << name_of(parameters.variant);
    cycle[parameters.variant] = std::max(cycle[parameters.variant], fine);
    EXPECT_LT(fine, 0.1 * coarse + 1e-12) << name_of(parameters.variant);
  }
  for (const auto& [variant, work] : cycle)
    expect_zero("net work of a cycle through all branches", variant, "hyperelasticity", work, "MPa", 2e-7);
}

TEST(WovenLaw, ReferenceStateIsFreeOfStressAndEnergy) {
  for (const auto& parameters : all_laws()) {
    const FabricPoint p = evaluate_point(fabric::make_membrane_law(parameters), mechanics::Matrix2::Identity());
    EXPECT_EQ(p.W, 0);
    EXPECT_EQ(p.S11, 0);
    EXPECT_EQ(p.S22, 0);
    EXPECT_EQ(p.S12, 0);
    EXPECT_EQ(p.gamma, 0);
  }
}

TEST(WovenLaw, ReversedShearReversesTheShearStressAlone) {
  for (const auto& parameters : all_laws()) {
    const MembraneLaw law = fabric::make_membrane_law(parameters);
    for (const State& s : draw_states(50, 0)) {
      mechanics::Matrix2 F, mirrored;
      F << s.la, s.lb * std::sin(s.gamma), 0, s.lb * std::cos(s.gamma);
      mirrored << s.la, -s.lb * std::sin(s.gamma), 0, s.lb * std::cos(s.gamma);
      const FabricPoint p = evaluate_point(law, F), q = evaluate_point(law, mirrored);
      EXPECT_EQ(p.W, q.W);
      EXPECT_EQ(p.S11, q.S11);
      EXPECT_EQ(p.S22, q.S22);
      EXPECT_EQ(p.S12, -q.S12);
      EXPECT_EQ(p.smallest_eigenvalue, q.smallest_eigenvalue);
    }
  }
}

scene::Pair swap(const scene::Pair& p) { return {p.weft, p.warp}; }

TEST(WovenLaw, SwappingWarpAndWeftMirrorsTheResponse) {
  for (const auto& parameters : all_laws()) {
    auto swapped = parameters;
    for (auto member :
         {&scene::WovenLaw::a, &scene::WovenLaw::b, &scene::WovenLaw::c, &scene::WovenLaw::p_min, &scene::WovenLaw::d,
          &scene::WovenLaw::s_T, &scene::WovenLaw::s_C, &scene::WovenLaw::strain_cap})
      swapped.*member = swap(parameters.*member);
    if (swapped.tables) std::swap(swapped.tables->warp, swapped.tables->weft);
    const MembraneLaw law = fabric::make_membrane_law(parameters), other = fabric::make_membrane_law(swapped);
    for (const State& s : draw_states(50, 0)) {
      const Potential w = evaluate(law, s), v = evaluate(other, {s.lb, s.la, s.gamma});
      const double scale = 1e-12 * (1 + get_hessian(w).cwiseAbs().maxCoeff());
      EXPECT_NEAR(w.W, v.W, scale);
      EXPECT_NEAR(w.W_a, v.W_b, scale);
      EXPECT_NEAR(w.W_b, v.W_a, scale);
      EXPECT_NEAR(w.tau, v.tau, scale);
      EXPECT_NEAR(w.W_aa, v.W_bb, scale);
      EXPECT_NEAR(w.W_ag, v.W_bg, scale);
    }
  }
}

TEST(WovenLaw, SampledTablesConvergeToTheUncoupledLawInSecondOrder) {
  for (const auto& set : all_sets(scene::Variant::Uncoupled)) {
    const MembraneLaw uncoupled = fabric::make_membrane_law(set);
    std::vector<double> errors;
    for (const int segments : {50, 100, 200, 400}) {
      auto sampled = set;
      sampled.variant = scene::Variant::Fabric;
      sampled.tables = fabric::sample_tables(set, segments, segments);
      const MembraneLaw tables = fabric::make_membrane_law(sampled);
      double largest = 0;
      for (const State& s : draw_states(2000, 0)) {
        const Potential w = evaluate(uncoupled, s), v = evaluate(tables, s);
        largest = std::max({largest, std::abs(w.W_a - v.W_a), std::abs(w.W_b - v.W_b), std::abs(w.tau - v.tau)});
      }
      errors.push_back(largest);
    }
    for (std::size_t i = 0; i + 1 < errors.size(); ++i) EXPECT_NEAR(errors[i] / errors[i + 1], 4, 0.4);
  }
}

}  // namespace
}  // namespace interply
