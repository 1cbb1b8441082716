#include "verify/quadrature.h"

#include <cmath>
#include <gtest/gtest.h>

namespace {

using namespace faceta;

TEST(Quadrature, PolynomialsAreExactAtOnce) {
  // Kronrod's 7 points are exact up to degree 11 in each variable.
  auto f = [](double x, double y) { return std::pow(x, 11) * std::pow(y, 10) + 3 * x * y; };
  Integral i = integrate(f, {0, 2, -1, 1}, 1e300);
  EXPECT_NEAR(i.value, std::pow(2, 12) / 12 * 2 / 11, 1e-10);
}

TEST(Quadrature, SmoothFunctions) {
  Integral i = integrate([](double x, double y) { return std::exp(x) * std::sin(3 * y); },
                         {-1, 2, 0, 1.5}, 1e-12);
  EXPECT_NEAR(i.value, (std::exp(2) - std::exp(-1)) * (1 - std::cos(4.5)) / 3, 1e-11);
  EXPECT_LT(i.error, 1e-11);
}

TEST(Quadrature, NarrowPeaksInside) {
  for (double width : {0.1, 0.01, 0.003}) {
    auto f = [&](double x, double y) {
      return std::exp(-(x * x + (y - 0.1) * (y - 0.1)) / (width * width));
    };
    // The peak lies on a node of no rule, but near enough to be noticed.
    Integral i = integrate(f, {-0.02, 0.05, 0.05, 0.2}, 1e-12);
    double e = std::erf(0.02 / width) + std::erf(0.05 / width);
    double g = std::erf(0.05 / width) + std::erf(0.1 / width);
    EXPECT_NEAR(i.value, width * width * 0.25 * M_PI * e * g / 1, 1e-11) << width;
  }
}

TEST(Quadrature, PeaksAtTheBorderTooNarrowForTheNodes) {
  for (double width : {1e-2, 1e-4, 1e-6}) {
    auto f = [&](double x, double y) { return std::exp(-x / width) * (1 + y); };
    Integral i = integrate(f, {0, 1, 0, 1}, 0, 1e-6);
    EXPECT_NEAR(i.value / (1.5 * width), 1, 1e-6) << width;
    auto g = [&](double x, double y) { return std::exp(-(1 - y) / width - x / width); };
    i = integrate(g, {0, 1, 0, 1}, 0, 1e-6);
    EXPECT_NEAR(i.value / (width * width), 1, 1e-6) << width;
  }
}

TEST(Quadrature, JumpsConvergeToTheRequestedError) {
  auto inside = [](double x, double y) { return x * x + y * y < 1 ? 1.0 : 0.0; };
  Integral i = integrate(inside, {0, 1, 0, 1}, 1e-3, 0, 2000000);
  EXPECT_NEAR(i.value, M_PI / 4, 1e-3);
}

TEST(Quadrature, TellsWhatItCouldNotResolve) {
  auto inside = [](double x, double y) { return x * x + y * y < 1 ? 1.0 : 0.0; };
  Integral i = integrate(inside, {0, 1, 0, 1}, 1e-9, 0, 5000);
  EXPECT_LE(i.evaluations, 5000);
  EXPECT_GT(i.error, std::abs(i.value - M_PI / 4));
}

TEST(Quadrature, NeverEvaluatesTheBorder) {
  auto f = [](double x, double y) {
    EXPECT_TRUE(x > 0 && x < 1 && y > 0 && y < 1);
    return 1 / std::sqrt(x * y);
  };
  EXPECT_NEAR(integrate(f, {0, 1, 0, 1}, 1e-4, 0, 1000000).value, 4, 1e-3);
}

// A step nearer to the border than any node goes unseen, unless there are parts of which it is not.
TEST(Quadrature, StepsAreFoundByParts) {
  for (double step : {0.004, 0.015, 0.97}) {
    PlaneFunction f = [&](double x, double) { return x > step ? 1.0 : 0.0; };
    Integral i = integrate(f, {0, 1, 0, 1}, 1e-6, 0, 40000, 8);
    EXPECT_NEAR(i.value, 1 - step, 2e-4) << step;
  }
  Integral whole =
      integrate([](double x, double) { return x > 0.015 ? 1.0 : 0.0; }, {0, 1, 0, 1}, 1e-6);
  EXPECT_NEAR(whole.value, 1, 1e-9);
}

} // namespace
