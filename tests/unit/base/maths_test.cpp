// The elementary functions in float against the C library in double, in units in the last place.

#include "base/maths.h"

#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace {

using namespace faceta;

const float kInf = std::numeric_limits<float>::infinity();
const float kNan = std::nanf("");

// |y - exact| in units of the last place of a float of that size; equal infinities and NaNs are 0.
double ulps(float y, double exact) {
  float rounded = static_cast<float>(exact);
  if (y == rounded || (y != y && exact != exact))
    return 0;
  float size = std::abs(rounded);
  double unit = std::max(double(std::nextafter(size, kInf)) - size, 0x1p-149);
  double error = std::abs(double(y) - exact) / unit;
  return error == error ? error : 1e30;
}

// Floats as integers in the order of their values.
int64_t rank_of(float x) {
  int32_t i = std::bit_cast<int32_t>(x);
  return i >= 0 ? int64_t(i) : -int64_t(i & 0x7fffffff);
}
float of_rank(int64_t k) {
  return k >= 0 ? std::bit_cast<float>(int32_t(k)) : -std::bit_cast<float>(int32_t(-k));
}

// The largest error over about `steps` floats of every size between low and high.
template <class F, class G> void expect_ulps(const char* name, F f, G exact, float low, float high,
                                             double bound, int steps = 400000) {
  int64_t a = rank_of(low), b = rank_of(high), step = std::max<int64_t>(1, (b - a) / steps);
  double worst = 0;
  float where = low;
  for (int64_t k = a; k <= b; k += step) {
    float x = of_rank(k);
    double error = ulps(f(x), exact(double(x)));
    if (error > worst) {
      worst = error;
      where = x;
    }
  }
  EXPECT_LE(worst, bound) << name << "(" << where << ") between " << low << " and " << high;
  EXPECT_GT(worst, 0) << name << " is not even computed in float";
}

#define FACETA_ULPS(f, low, high, bound)                                                           \
  expect_ulps(                                                                                     \
      #f, [](float x) { return faceta::f(x); }, [](double x) { return std::f(x); }, low, high,     \
      bound)

TEST(Maths, ExpWithinOneUlp) {
  FACETA_ULPS(exp, -87.3f, 88.72f, 1);
  FACETA_ULPS(exp, -103.9f, -87.3f, 1); // denormal results
  EXPECT_EQ(faceta::exp(-200.0f), 0);
  EXPECT_EQ(faceta::exp(100.0f), kInf);
  EXPECT_EQ(faceta::exp(-kInf), 0);
  EXPECT_EQ(faceta::exp(kInf), kInf);
  EXPECT_EQ(faceta::exp(0.0f), 1);
  EXPECT_TRUE(std::isnan(faceta::exp(kNan)));
}

TEST(Maths, LogWithinOneUlp) {
  FACETA_ULPS(log, 1e-45f, 3.4e38f, 1);
  FACETA_ULPS(log, 0.9f, 1.1f, 1);
  EXPECT_EQ(faceta::log(0.0f), -kInf);
  EXPECT_EQ(faceta::log(kInf), kInf);
  EXPECT_EQ(faceta::log(1.0f), 0);
  EXPECT_TRUE(std::isnan(faceta::log(-1.0f)));
  EXPECT_TRUE(std::isnan(faceta::log(kNan)));
}

TEST(Maths, PowWithinTwoUlp) {
  for (float y : {0.5f, 2.2f, 1 / 2.4f, -1.5f, 0.1f, 20.0f, -7.3f, 1000.0f, 1e-4f})
    expect_ulps(
        "pow", [y](float x) { return faceta::pow(x, y); },
        [y](double x) { return std::pow(x, double(y)); }, 1e-37f, 1e30f, 1.2, 100000);
  for (float y : {10000.0f, -3000.0f})
    expect_ulps(
        "pow", [y](float x) { return faceta::pow(x, y); },
        [y](double x) { return std::pow(x, double(y)); }, 0.995f, 1.005f, 1.2, 100000);
  EXPECT_EQ(faceta::pow(0.0f, 0.0f), 1);
  EXPECT_EQ(faceta::pow(0.0f, 2.0f), 0);
  EXPECT_EQ(faceta::pow(0.0f, -1.0f), kInf);
  EXPECT_EQ(faceta::pow(1.0f, 1e30f), 1);
  EXPECT_EQ(faceta::pow(1e30f, 10.0f), kInf);
  EXPECT_EQ(faceta::pow(1e30f, -10.0f), 0);
}

TEST(Maths, SineAndCosineWithinTwoUlpNearTheirZerosToo) {
  for (auto [low, high] : {std::pair{-7.0f, 7.0f}, {7.0f, 100.0f}, {100.0f, 1e4f}}) {
    FACETA_ULPS(sin, low, high, 2);
    FACETA_ULPS(cos, low, high, 2);
  }
  for (int n = 1; n < 6000; ++n) { // the floats beside every zero
    float zero = static_cast<float>(n * kPi / 2);
    for (float x : {std::nextafter(zero, 0.0f), zero, std::nextafter(zero, 1e9f)}) {
      ASSERT_LE(ulps(faceta::sin(x), std::sin(double(x))), 2) << x;
      ASSERT_LE(ulps(faceta::cos(x), std::cos(double(x))), 2) << x;
    }
  }
  EXPECT_EQ(faceta::sin(0.0f), 0);
  EXPECT_EQ(faceta::cos(0.0f), 1);
}

TEST(Maths, TangentWithinTwoUlp) {
  FACETA_ULPS(tan, -1.57f, 1.57f, 2.1);
  FACETA_ULPS(tan, 1.57f, 1e4f, 2.1);
  EXPECT_GT(std::abs(faceta::tan(1.57079637f)), 2e7f);
}

TEST(Maths, ArcsWithinTwoUlp) {
  FACETA_ULPS(asin, -1.0f, 1.0f, 2);
  FACETA_ULPS(acos, -1.0f, 1.0f, 2);
  EXPECT_EQ(faceta::asin(2.0f), faceta::asin(1.0f)); // clamped: rounding may leave [-1, 1]
  EXPECT_EQ(faceta::acos(-2.0f), faceta::acos(-1.0f));
  EXPECT_EQ(faceta::acos(1.0f), 0);
}

TEST(Maths, AngleOfAPoint) {
  for (float y : {1.0f, 0.1f, -0.3f, 17.0f, 1e-3f, 1e3f, -1e-20f})
    expect_ulps(
        "atan2", [y](float x) { return faceta::atan2(y, x); },
        [y](double x) { return std::atan2(double(y), x); }, -1e6f, 1e6f, 2.5, 100000);
  EXPECT_EQ(faceta::atan2(0.0f, 0.0f), 0);
  EXPECT_EQ(faceta::atan2(0.0f, 1.0f), 0);
  EXPECT_FLOAT_EQ(faceta::atan2(0.0f, -1.0f), float(kPi));
  EXPECT_FLOAT_EQ(faceta::atan2(-0.0f, -1.0f), -float(kPi));
  EXPECT_FLOAT_EQ(faceta::atan2(1.0f, 0.0f), float(kPi / 2));
  EXPECT_FLOAT_EQ(faceta::atan2(-1.0f, 0.0f), -float(kPi / 2));
}

TEST(Maths, ErrorFunctionAndItsInverse) {
  FACETA_ULPS(erf, -5.0f, 5.0f, 1.5);
  EXPECT_EQ(faceta::erf(kInf), 1);
  EXPECT_EQ(faceta::erf(-kInf), -1);
  // The inverse against erf itself, by Newton's method in double from the float's own answer.
  auto exact = [](double x) {
    double y = faceta::erfinv(static_cast<float>(x));
    for (int i = 0; i < 4; ++i)
      y += (x - std::erf(y)) * 0.5 * std::sqrt(kPi) * std::exp(y * y);
    return y;
  };
  auto inverse = [](float x) { return faceta::erfinv(x); };
  expect_ulps("erfinv", inverse, exact, -0.9999f, 0.9999f, 4);
  expect_ulps("erfinv", inverse, exact, 0.9999f, kOneMinusEpsilon, 4);
  EXPECT_EQ(faceta::erfinv(0.0f), 0);
}

TEST(Maths, DoubleInverseOfTheErrorFunction) {
  for (double x = -0.999; x < 0.9995; x += 0.0625)
    EXPECT_NEAR(std::erf(faceta::erfinv(x)), x, 1e-15);
}

TEST(Maths, PowersOfTwo) {
  for (int n = -126; n <= 127; ++n)
    EXPECT_EQ(power_of_two<float>(n), std::ldexp(1.0f, n)) << n;
}

TEST(Maths, SmallFunctions) {
  EXPECT_EQ(clamp(5.0f, 0.0f, 2.0f), 2);
  EXPECT_EQ(clamp(-5.0f, 0.0f, 2.0f), 0);
  EXPECT_EQ(clamp01(0.25f), 0.25f);
  EXPECT_EQ(safe_sqrt(-1.0f), 0);
  EXPECT_EQ(safe_sqrt(4.0f), 2);
  EXPECT_EQ(lerp(1.0f, 3.0f, 0.5f), 2);
  EXPECT_EQ(sqr(-3.0f), 9);
  const float c[] = {1, 2, 3};
  EXPECT_EQ(polynomial(2.0f, c), 17);
}

TEST(Number, MinAndMaxReturnTheSecondOperandBesideANan) {
  EXPECT_EQ(min(kNan, 1.0f), 1);
  EXPECT_EQ(max(kNan, 1.0f), 1);
  EXPECT_TRUE(std::isnan(min(1.0f, kNan)));
  EXPECT_TRUE(std::isnan(max(1.0f, kNan)));
  EXPECT_TRUE(std::signbit(min(0.0f, -0.0f))); // equal: the second one
  EXPECT_FALSE(std::signbit(max(-0.0f, 0.0f)));
  EXPECT_EQ(min(std::nan(""), 1.0), 1);
  EXPECT_TRUE(std::isnan(max(1.0, std::nan(""))));
}

TEST(Number, FiniteMeansNeitherInfiniteNorNan) {
  for (float x : {0.0f, -1.0f, 1e-45f, 3.4e38f})
    EXPECT_TRUE(is_finite(x)) << x;
  for (float x : {kInf, -kInf, kNan})
    EXPECT_FALSE(is_finite(x)) << x;
}

TEST(Number, FmaRoundsOnce) {
  // (1 + 2^-12)^2 - 1 - 2^-11 = 2^-24, which a rounded product loses.
  float x = 1 + 0x1p-12f;
  EXPECT_EQ(fma(x, x, -(1 + 0x1p-11f)), 0x1p-24f);
}

} // namespace
