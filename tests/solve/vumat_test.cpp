/// A user's own law seen from outside: what it is given, what becomes of it when it misbehaves.
#include "solve/vumat.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>

#include "mechanics/failure.hpp"
#include "scene/read_scene.hpp"
#include "solve/vumat_probe.hpp"
#include "support/vumat_laws.hpp"

namespace interply::solve {
namespace {

using mechanics::Matrix2;
using test::make_faulty_vumat;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr double kDensity = 1e-9;

/// What the probe says about a law: a refusal, or its warnings.
std::string probe(const scene::VumatLaw& law, double limit = 60) {
  try {
    std::string said;
    for (const std::string& warning : probe_vumat(law, "ply_2", kDensity, limit)) said += "warning " + warning;
    return said;
  } catch (const scene::SceneError& e) {
    return e.what();
  }
}

std::string probe(test::Fault fault, double limit = 60) { return probe(make_faulty_vumat(1000, fault, 1e-6), limit); }

const auto named = [](const char* library = "libfaulty.so") {
  return AllOf(HasSubstr("layer ply_2: law.vumat.library: "), HasSubstr(library));
};

TEST(VumatProbe, LawThatBehavesGivesNoWord) {
  EXPECT_THAT(probe(test::kNoFault), IsEmpty());
  EXPECT_THAT(probe(test::make_woven_vumat({})), IsEmpty());
  EXPECT_THAT(probe(test::make_j2_vumat({}, scene::Integration::Shell)), IsEmpty());
}

TEST(VumatProbe, LawThatEndsItsProcessIsNamedWithItsLastWords) {
  const std::string words = "no convergence of the return mapping";
  EXPECT_THAT(probe(test::kStop), AllOf(named(), HasSubstr("STOP or exit"), HasSubstr(words)));
  EXPECT_THAT(probe(test::kExit), AllOf(named(), HasSubstr("STOP or exit"), HasSubstr(words)));
  EXPECT_THAT(probe(test::kExitAtOnce), AllOf(named(), HasSubstr("exit code 0"), HasSubstr(words)));
  EXPECT_THAT(probe(test::kNullPointer), AllOf(named(), HasSubstr("signal 11"), HasSubstr(words)));
  EXPECT_THAT(probe(test::kExitRoutine), AllOf(named(), HasSubstr("xplb_exit"), HasSubstr(words)));
  EXPECT_THAT(probe(test::kAbort), AllOf(named(), HasSubstr("abort")));
  EXPECT_THAT(probe(test::kStackOverflow), AllOf(named(), HasSubstr("signal 11")));
}

TEST(VumatProbe, ErrorRoutineFillsInItsArraysAndEndsTheLaw) {
  EXPECT_THAT(probe(test::kErrorRoutine),
              AllOf(named(), HasSubstr("xplb_abqerr"),
                    HasSubstr("no convergence in 12 iterations, error 0.5, in FLOW")));
}

TEST(VumatProbe, LawThatNeverReturnsIsNamedAtTheLimit) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(probe(test::kNeverReturns, 0.5), AllOf(named(), HasSubstr("does not return within 0.5 s")));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(VumatProbe, WritingOutsideAnArrayNamesIt) {
  EXPECT_THAT(probe(test::kFifthState), AllOf(named(), HasSubstr("stateNew"), HasSubstr("state_variables")));
  auto enough = make_faulty_vumat(1000, test::kFifthState, 1e-6);
  enough.state_variables = 5;
  EXPECT_THAT(probe(enough), IsEmpty());
  EXPECT_THAT(probe(test::kSixStresses), AllOf(named(), HasSubstr("stressNew"), HasSubstr("4 components")));
  EXPECT_THAT(probe(test::kWordBefore), AllOf(named(), HasSubstr("outside its argument stressNew")));
}

TEST(VumatProbe, ChangedInputAndHiddenStateAreWarnings) {
  EXPECT_THAT(probe(test::kChangesInput),
              AllOf(named(), HasSubstr("warning "), HasSubstr("argument coordMp"), HasSubstr("argument props")));
  EXPECT_THAT(probe(test::kCounter), AllOf(named(), HasSubstr("warning "), HasSubstr("state variables (SAVE")));
}

TEST(VumatProbe, LawForSolidsIsRefusedByItsStress33) {
  EXPECT_THAT(probe(test::kStress33), AllOf(named(), HasSubstr("stress 33"), HasSubstr("written for solids")));
}

TEST(VumatProbe, StressThatIsNotANumberIsRefused) {
  EXPECT_THAT(probe(test::kNotANumber), AllOf(named(), HasSubstr("not finite")));
}

TEST(VumatProbe, RoutinesThatNobodyCallsOrHasAreNamed) {
  EXPECT_THAT(probe(test::make_vumat("companion", {})), AllOf(named("libcompanion.so"), HasSubstr("vexternaldb")));
  EXPECT_THAT(probe(test::make_vumat("unresolved", {})),
              AllOf(named("libunresolved.so"), HasSubstr("calls vgetvrm_"), HasSubstr("xplb_abqerr")));
}

TEST(VumatPoints, WritingOutsideAnArrayInARunNamesItAndHarmsNothing) {
  for (const auto fault : {test::kFifthState, test::kSixStresses, test::kWordBefore}) {
    VumatPoints points(make_faulty_vumat(1000, fault, 2e-6), "ply_2", kDensity, 7);
    const Matrix2 u = Matrix2::Identity() * 1.001;
    std::vector<VumatIncrement> increments(7, compute_vumat_increment(Matrix2::Identity(), u * u));
    points.advance(0, 7, increments.data(), {.time = 1e-6, .dt = 1e-6});
    try {
      points.advance(0, 7, increments.data(), {.time = 2e-6, .dt = 1e-6});
      ADD_FAILURE() << fault;
    } catch (const mechanics::Divergence& e) {
      EXPECT_THAT(e.what(), AllOf(named(), HasSubstr("outside its argument")));
    }
  }
}

/// What a law may ask for beside its strain, and what the include file defines.
TEST(VumatPoints, LawIsToldWhereAndWhenItIsAsDocumented) {
  constexpr int kElements = 200, kSections = 3, kStates = 13;
  VumatPoints points(test::make_vumat("place", {1000}, kStates), "ply_2", kDensity, kElements, kSections);
  std::vector<VumatIncrement> increments(kElements);
  for (int e = 0; e < kElements; ++e) {
    increments[static_cast<std::size_t>(e)] = compute_vumat_increment(Matrix2::Identity(), Matrix2::Identity() * 1.002);
    increments[static_cast<std::size_t>(e)].position.x() = 0.5 * e;
    increments[static_cast<std::size_t>(e)].length = 2 + e;
  }
  for (int s = 0; s < kSections; ++s)
    for (const auto& [begin, n] : {std::pair{0, kVumatBlock}, std::pair{kVumatBlock, kElements - kVumatBlock}})
      points.advance(s * kElements + begin, n, &increments[static_cast<std::size_t>(begin)],
                     {.time = 3e-6, .dt = 1e-6});
  for (int s = 0; s < kSections; ++s)
    for (int e = 0; e < kElements; ++e) {
      const double expected[kStates] = {1.0 + e, 1, 1, 1.0 + s, 1e-6, 3e-6, 3e-6, 2.0 + e, 0.5 * e, 0, 2, 136, 136};
      for (int v = 0; v < kStates; ++v) ASSERT_EQ(points.state(v, s * kElements + e), expected[v]) << v << ' ' << e;
    }
}

TEST(VumatPoints, IncrementIsNeverZero) {
  VumatPoints points(test::make_vumat("place", {1000}, 13), "ply_2", kDensity, 1);
  const VumatIncrement at_rest{.strain = Matrix2::Zero(), .stretch = Matrix2::Identity()};
  points.advance(0, 1, &at_rest, {});
  EXPECT_GT(points.state(4, 0), 0);
  EXPECT_EQ(points.state(6, 0), 0);
}

TEST(VumatPoints, Stress33IsNoticedInARun) {
  const VumatIncrement stretched = compute_vumat_increment(Matrix2::Identity(), Matrix2::Identity() * 1.002);
  for (const auto& [fault, expected] : {std::pair{test::kNoFault, 0.0}, std::pair{test::kStress33, 0.4}}) {
    VumatPoints points(make_faulty_vumat(1000, fault, 1e-6), "ply_2", kDensity, 1);
    points.advance(0, 1, &stretched, {.time = 1e-6, .dt = 1e-6});
    EXPECT_NEAR(points.largest_stress_33(), expected * points.response(0).stress(0, 0), 1e-12);
  }
}

}  // namespace
}  // namespace interply::solve
