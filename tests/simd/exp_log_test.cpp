/// What simd/exp_log.hpp promises, for every target that this machine runs; scalars are the C++ library's.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "exp_log_kernels.hpp"

namespace interply::simd {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kLeast = std::numeric_limits<double>::denorm_min();
constexpr double kMost = std::numeric_limits<double>::max();
constexpr double kLeastNormal = std::numeric_limits<double>::min();

using Ranges = std::vector<std::pair<double, double>>;

std::vector<double> evaluate(Function f, const std::vector<double>& x) {
  std::vector<double> y(x.size());
  f(x.data(), y.data(), static_cast<std::ptrdiff_t>(x.size()));
  return y;
}

double evaluate(Function f, double x) { return evaluate(f, std::vector<double>{x})[0]; }

bool has_same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i])) return false;
  return a.size() == b.size();
}

/// |y - exact| in units of the last bit of `exact`.
double count_last_bits(double y, long double exact) {
  const int exponent = std::max(std::ilogb(static_cast<double>(exact)), std::numeric_limits<double>::min_exponent - 1);
  return static_cast<double>(std::abs(y - exact) / std::ldexp(1.0L, exponent - 52));
}

std::vector<double> draw(double low, double high, int n) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> in(low, high);
  std::vector<double> x(static_cast<std::size_t>(n));
  for (double& value : x) value = in(random);
  return x;
}

/// Normal numbers of any magnitude.
std::vector<double> draw_magnitudes(int n) {
  std::vector<double> x = draw(std::log(1e-307), std::log(kMost) - 1e-9, n);
  for (double& value : x) value = std::exp(value);
  return x;
}

/// Around the places where the reduction of the argument changes to the next power of 2, and the ends of the range.
std::vector<double> make_exp_arguments() {
  std::vector<double> x;
  const Ranges ranges{{-708, 709}, {-1, 1}, {-1e-8, 1e-8}, {-708, -707}, {708, 709}};
  for (const auto& [low, high] : ranges)
    for (const double value : draw(low, high, 100001)) x.push_back(value);
  for (int k = -1020; k <= 1022; ++k)
    for (const double away : {-1e-13, 0.0, 1e-13}) x.push_back((k + 0.5) * std::log(2.0) + away);
  return x;
}

std::vector<double> make_log_arguments() {
  std::vector<double> x = draw_magnitudes(200001);
  const Ranges ranges{{0.5, 2}, {0.99, 1.01}, {1 - 1e-8, 1 + 1e-8}, {0.7071, 0.7072}};
  for (const auto& [low, high] : ranges)
    for (const double value : draw(low, high, 100001)) x.push_back(value);
  for (const double value : {1e-307, std::nextafter(1.0, 0), std::nextafter(1.0, 2), kMost}) x.push_back(value);
  return x;
}

template <class Target>
bool can_run() {
#if defined(__x86_64__)
  const auto widest = choose_target();
  if constexpr (std::is_same_v<Target, Avx2>) return widest != Choice::Scalar;
  if constexpr (std::is_same_v<Target, Avx512>) return widest == Choice::Avx512;
#endif
  return std::is_same_v<Target, Scalar>;
}

template <class Target>
class ExpLog : public testing::Test {
 protected:
  void SetUp() override {
    if (!can_run<Target>()) GTEST_SKIP() << "not on this machine";
  }
#if defined(__x86_64__)
  Functions functions = get_functions<Target>();
#else
  Functions functions = get_functions<Scalar>();
#endif
};
using Targets = testing::Types<Scalar, Avx2, Avx512>;
TYPED_TEST_SUITE(ExpLog, Targets);

TYPED_TEST(ExpLog, ExpErrsByLessThanTwoLastBits) {
  const std::vector<double> x = make_exp_arguments(), y = evaluate(this->functions.exp, x);
  double worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    worst = std::max(worst, count_last_bits(y[i], std::exp(static_cast<long double>(x[i]))));
  this->RecordProperty("worst", std::to_string(worst));
  EXPECT_LT(worst, 2);
}

TYPED_TEST(ExpLog, LogErrsByLessThanOneLastBit) {
  const std::vector<double> x = make_log_arguments(), y = evaluate(this->functions.log, x);
  double worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    worst = std::max(worst, count_last_bits(y[i], std::log(static_cast<long double>(x[i]))));
  this->RecordProperty("worst", std::to_string(worst));
  EXPECT_LT(worst, 1);
}

TYPED_TEST(ExpLog, ExactValuesAreExact) {
  for (const double x : {0.0, -0.0, kLeast, -kLeast, kLeastNormal, 1e-17, -1e-17})
    EXPECT_EQ(evaluate(this->functions.exp, x), 1) << x;
  EXPECT_EQ(std::bit_cast<std::uint64_t>(evaluate(this->functions.log, 1.0)), 0u);  // not -0
}

TYPED_TEST(ExpLog, ExpOverflowsToInfinityAndUnderflowsToZero) {
  const Function exp = this->functions.exp;
  for (const double x : {710.0, 1e4, kMost, kInfinity}) EXPECT_EQ(evaluate(exp, x), kInfinity) << x;
  for (const double x : {-746.0, -1e4, -kMost, -kInfinity}) {
    EXPECT_EQ(evaluate(exp, x), 0) << x;
    EXPECT_FALSE(std::signbit(evaluate(exp, x))) << x;
  }
  EXPECT_TRUE(std::isnan(evaluate(exp, kNaN)));
  EXPECT_TRUE(std::isnan(evaluate(exp, -kNaN)));
}

TYPED_TEST(ExpLog, LogOutsideItsRangeIsInfiniteOrNoNumber) {
  const Function log = this->functions.log;
  EXPECT_EQ(evaluate(log, 0.0), -kInfinity);
  EXPECT_EQ(evaluate(log, -0.0), -kInfinity);
  EXPECT_EQ(evaluate(log, kInfinity), kInfinity);
  for (const double x : {-kLeast, -1.0, -kMost, -kInfinity, kNaN, -kNaN})
    EXPECT_TRUE(std::isnan(evaluate(log, x))) << x;
}

#if defined(__x86_64__)
class ExpLogOfPacks : public testing::Test {
 protected:
  void SetUp() override {
    if (!can_run<Avx2>()) GTEST_SKIP() << "this machine has no AVX2";
  }
};

/// The library goes on to 709.78 and, through subnormal numbers, to -745.13.
TEST_F(ExpLogOfPacks, ExpEndsWithTheLastWholeNumbers) {
  const Function exp = get_functions<Avx2>().exp;
  EXPECT_TRUE(std::isfinite(evaluate(exp, 709.0)));
  EXPECT_EQ(evaluate(exp, std::nextafter(709.0, 710)), kInfinity);
  EXPECT_GT(evaluate(exp, -708.0), 0);
  EXPECT_EQ(evaluate(exp, std::nextafter(-708.0, -709)), 0);
}

TEST_F(ExpLogOfPacks, LogTakesAllBelowItsRangeForZero) {
  const Function log = get_functions<Avx2>().log;
  for (const double x : {kLeast, kLeastNormal, std::nextafter(1e-307, 0)}) EXPECT_EQ(evaluate(log, x), -kInfinity) << x;
  EXPECT_TRUE(std::isfinite(evaluate(log, 1e-307)));
}

TEST_F(ExpLogOfPacks, HaveTheSameBitsInPacksOfFourAndEight) {
  if (!can_run<Avx512>()) GTEST_SKIP() << "this machine has no AVX-512";
  const Functions four = get_functions<Avx2>(), eight = get_functions<Avx512>();
  std::vector<double> special{0.0, -0.0, kLeast, kLeastNormal, kMost, kInfinity, -kInfinity, -1.0, 709.5, -708.5};
  for (const auto& x : {make_exp_arguments(), make_log_arguments(), special}) {
    EXPECT_TRUE(has_same_bits(evaluate(four.exp, x), evaluate(eight.exp, x)));
    EXPECT_TRUE(has_same_bits(evaluate(four.log, x), evaluate(eight.log, x)));
  }
}
#endif

}  // namespace
}  // namespace interply::simd
