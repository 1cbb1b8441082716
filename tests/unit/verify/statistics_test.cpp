#include "verify/random_stream.h"
#include "verify/statistics.h"

#include <cmath>
#include <gtest/gtest.h>

namespace {

using namespace faceta;

TEST(GammaQ, AgreesWithClosedForms) {
  for (double x : {1e-6, 0.01, 0.3, 1.0, 2.5, 10.0, 80.0}) {
    EXPECT_NEAR(gamma_q(1, x), std::exp(-x), 1e-13) << x;
    EXPECT_NEAR(gamma_q(0.5, x), std::erfc(std::sqrt(x)), 1e-13) << x;
    double poisson = 0, term = std::exp(-x); // Q(n, x) = P(fewer than n events)
    for (int k = 0; k < 7; ++k, term *= x / k)
      poisson += term;
    EXPECT_NEAR(gamma_q(7, x), poisson, 1e-13) << x;
  }
  EXPECT_EQ(gamma_q(3, 0), 1);
  EXPECT_EQ(gamma_q(3, INFINITY), 0);
}

TEST(ChiSquare, QuantilesOfTheTables) {
  // Abramowitz and Stegun, table 26.8.
  EXPECT_NEAR(chi_square_survival(3.84146, 1), 0.05, 1e-6);
  EXPECT_NEAR(chi_square_survival(18.3070, 10), 0.05, 1e-6);
  EXPECT_NEAR(chi_square_survival(29.5883, 10), 0.001, 1e-8);
  EXPECT_NEAR(chi_square_survival(67.3276, 100), 0.995, 1e-6);
  EXPECT_NEAR(chi_square_survival(149.449, 100), 0.001, 1e-7);
  // Far out, against the leading term of the asymptotic series: still relatively right.
  double x = 500, a = 5;
  double leading = std::exp(-x / 2 + (a - 1) * std::log(x / 2) - std::lgamma(a));
  EXPECT_NEAR(chi_square_survival(x, 10) / (leading * (1 + 4 / 250.0 + 12 / 62500.0)), 1, 1e-5);
}

TEST(Normal, TwoSides) {
  EXPECT_NEAR(two_sided_normal(1.959964), 0.05, 1e-7);
  EXPECT_NEAR(two_sided_normal(-3.290527), 0.001, 1e-8);
}

TEST(Normal, QuantilesOfTheTables) {
  // Abramowitz and Stegun, table 26.5, and sigmas of the tails.
  EXPECT_NEAR(two_sided_quantile(0.05), 1.9599640, 1e-7);
  EXPECT_NEAR(two_sided_quantile(0.001), 3.2905267, 1e-7);
  EXPECT_NEAR(two_sided_quantile(5.733031437583867e-07), 5, 1e-9);
  EXPECT_NEAR(two_sided_quantile(1), 0, 1e-9);
}

TEST(Sidak, AllTogetherHaveTheFamilysLevel) {
  for (double n : {2.0, 100.0, 1e6})
    EXPECT_NEAR(std::pow(1 - sidak(1e-4, n), n), 1 - 1e-4, 1e-9) << n;
  EXPECT_EQ(sidak(0.01, 1), 0.01);
}

TEST(ChiSquareTest, SumsSquaresOverCells) {
  // 60 throws of a die: 5, 8, 9, 8, 10, 20 (a textbook's example): 13.4 with 5 degrees of freedom.
  ChiSquareResult r = chi_square_test({{10, 5}, {10, 8}, {10, 9}, {10, 8}, {10, 10}, {10, 20}});
  EXPECT_NEAR(r.statistic, 13.4, 1e-12);
  EXPECT_EQ(r.degrees, 5);
  EXPECT_NEAR(r.p_value, 0.0199, 1e-4);
}

TEST(ChiSquareTest, PoolsCellsThatExpectTooFew) {
  ChiSquareResult r = chi_square_test({{1, 2}, {2, 0}, {2, 3}, {50, 50}, {0.5, 1}, {100, 99}});
  // 0.5 + 1 + 2 + 2 = 5.5 expected, 6 observed, beside 50 and 100.
  EXPECT_EQ(r.pooled, 4);
  EXPECT_EQ(r.degrees, 2);
  EXPECT_NEAR(r.statistic, 0.25 / 5.5 + 0.01, 1e-12);
  // A rest that never reaches 5 joins another cell instead of vanishing.
  r = chi_square_test({{1, 40}, {50, 50}, {100, 100}});
  EXPECT_EQ(r.degrees, 1);
  EXPECT_LT(r.p_value, 1e-6);
}

TEST(ChiSquareTest, SamplesWhereNoneCanBeFail) {
  EXPECT_EQ(chi_square_test({{0, 1}, {500, 500}, {500, 499}}).p_value, 0);
  EXPECT_EQ(chi_square_test({{0, 0}, {500, 500}, {500, 500}}).p_value, 1);
}

TEST(ChiSquareTest, FalseAlarmsAreAsRareAsTheLevelSays) {
  int alarms = 0;
  const int runs = 2000;
  RandomStream random(5);
  for (int run = 0; run < runs; ++run) {
    std::vector<HistogramCell> cells(20, {50, 0});
    for (int i = 0; i < 1000; ++i)
      ++cells[int(random.next() * 20)].observed;
    alarms += chi_square_test(cells).p_value < 0.05;
  }
  EXPECT_NEAR(alarms, runs * 0.05, 5 * std::sqrt(runs * 0.05 * 0.95));
}

TEST(RunningMean, OfKnownNumbers) {
  RunningMean m;
  for (double x : {1e9 + 1, 1e9 + 2, 1e9 + 3, 1e9 + 4})
    m.add(x);
  EXPECT_EQ(m.mean(), 1e9 + 2.5);
  EXPECT_NEAR(m.standard_error(), std::sqrt(5.0 / 3 / 4), 1e-6);
  EXPECT_EQ(m.count(), 4);
}

TEST(RandomStream, IsUniformAndReproducible) {
  RandomStream a(1), b(1), c(2);
  EXPECT_EQ(a.bits(), b.bits());
  EXPECT_NE(a.bits(), c.bits());
  std::vector<HistogramCell> cells(256, {4000, 0});
  for (int i = 0; i < 256 * 4000; ++i) {
    float u = a.next_float();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    ++cells[int(u * 256)].observed;
  }
  EXPECT_GT(chi_square_test(cells).p_value, 1e-4);
}

} // namespace
