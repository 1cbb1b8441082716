// The grid of directions, the metrics against figures from numpy, and bad input.

#include "base/error.h"
#include "verify/fit_data.h"
#include "verify/fit_picture.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace faceta {
namespace {

using Rgb = std::array<double, 3>;

Rgb smooth(const Vec3<double>& wo, const Vec3<double>& wi) {
  double p = wo.z * wi.z;
  return {0.1 + 2 * p * p, 0.3, 0.05 + wi.z + wo.z};
}
Rgb other(const Vec3<double>& wo, const Vec3<double>& wi) {
  double p = wo.z * wi.z;
  return {0.2 + 1.5 * p * p, 0.25 + 0.1 * wo.z, 0.1 + 0.9 * (wi.z + wo.z)};
}

std::vector<double> with_cosine(const FitData& data,
                                Rgb (*f)(const Vec3<double>&, const Vec3<double>&)) {
  std::vector<double> values;
  for (const FitRow& row : data.rows)
    for (double v : f(row.wo, row.wi))
      values.push_back(v * row.wi.z);
  return values;
}

void expect_errors(const FitErrors& errors, const FitErrors& expected) {
  for (size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(errors[k], expected[k], 1e-9 * expected[k]) << kFitMetricNames[k];
}

TEST(FitData, GridIsTheOneOfThePublishedFigures) {
  FitData data = sample_fit_target({smooth});
  EXPECT_EQ(data.rows.size(), 57307u);
  double sum = 0;
  for (size_t i = 0; i < data.rows.size(); ++i) {
    const FitRow& row = data.rows[i];
    sum += row.weight;
    ASSERT_NEAR(length(row.wi), 1, 1e-12);
    ASSERT_NEAR(length(row.wo), 1, 1e-12);
    Vec3<double> h = normalize(row.wi + row.wo);
    ASSERT_NEAR(std::acos(std::min(h.z, 1.0)), std::pow(data.cells[i].h / 90, 2) * kPi / 2, 1e-7);
    ASSERT_NEAR(dot(h, row.wi), std::cos(data.cells[i].theta_d * kPi / 180), 1e-12);
  }
  EXPECT_NEAR(sum, 1, 1e-12);
}

// Computed with numpy from the formulas of the metrics on the same grid.
TEST(FitData, MetricsAgreeWithNumpy) {
  FitData data = sample_fit_target({smooth});
  FitErrorReport report = fit_errors(data, with_cosine(data, other));
  expect_errors(report.all, {0.028145428381, 0.0287879152503, 0.0921288310037});
  expect_errors(report.channels[0], {0.039121770355, 0.0428517873563, 0.148214028328});
  expect_errors(report.channels[1], {0.0130812054981, 0.0170083170732, 0.0953981290501});
  expect_errors(report.channels[2], {0.0259781555013, 0.0189914102711, 0.0647317324199});
  EXPECT_NEAR(report.weight_by_theta_i[3], 0.12035597946061691, 1e-12);
  expect_errors(report.by_theta_i[3], {0.035752953695, 0.0292534059087, 0.0880386160835});
  EXPECT_EQ(report.weight_by_theta_i[8], 0); // beyond 80 degrees
}

TEST(FitData, MapAgreesWithNumpy) {
  FitData data = sample_fit_target({smooth});
  FitMap map = fit_map(data, with_cosine(data, other));
  size_t cell = 10 * FitMap::kSize + 20; // i = 20.5, theta_d = 41
  EXPECT_NEAR(map.mean[cell], -0.016398953608632152, 1e-12);
  EXPECT_NEAR(map.rms[cell], 0.027911464170304157, 1e-12);
  EXPECT_TRUE(std::isnan(map.mean.back())); // theta_h and theta_d near 90
}

TEST(FitData, MapsAreDrawnWithTheirSigns) {
  std::vector<double> values(45 * 45, 0.0);
  values[0] = 1;                                              // lower left: too bright
  values[44] = -1;                                            // lower right: too dark
  values[44 * 45] = std::numeric_limits<double>::quiet_NaN(); // upper left: nothing there
  Image image = draw_fit_map(values, 1, 2);
  ASSERT_EQ(image.width, 90);
  EXPECT_GT(image.at(0, 89, 0), image.at(0, 89, 2));
  EXPECT_LT(image.at(89, 89, 0), image.at(89, 89, 2));
  EXPECT_FLOAT_EQ(image.at(50, 50, 1), 1);
  EXPECT_FLOAT_EQ(image.at(0, 0, 0), 0.2f);
  EXPECT_THROW(draw_fit_map(values, 0), Error);
  EXPECT_THROW(draw_fit_map(std::span(values).first(10), 1), Error);
}

TEST(FitData, HolesAreLeftOutAndCounted) {
  FitTarget target{[](const Vec3<double>& wo, const Vec3<double>& wi) {
    Rgb v = smooth(wo, wi);
    if (wi.z < 0.5)
      v[1] = std::numeric_limits<double>::quiet_NaN();
    return v;
  }};
  FitData data = sample_fit_target(target);
  EXPECT_GT(data.holes, 1000);
  EXPECT_EQ(data.rows.size() + size_t(data.holes), 57307u);
  EXPECT_EQ(data.rows.size(), data.cells.size());
  for (const FitRow& row : data.rows)
    ASSERT_GE(row.wi.z, 0.5);
}

TEST(FitData, NegativeValuesCountAsZero) {
  FitRow row{{0, 0, 1}, {0, 0, 1}, {-1, 2, 3}, 1};
  EXPECT_EQ(check_fit_rows({row}).rows[0].value[0], 0);
}

TEST(FitData, BadInputIsAnError) {
  auto constant = [](double v) {
    return FitTarget{[v](const Vec3<double>&, const Vec3<double>&) { return Rgb{v, v, v}; }};
  };
  EXPECT_THROW(sample_fit_target(constant(0)), Error);
  EXPECT_THROW(sample_fit_target(constant(-1)), Error);
  EXPECT_THROW(sample_fit_target(constant(std::numeric_limits<double>::quiet_NaN())), Error);
  EXPECT_THROW(sample_fit_target(constant(std::numeric_limits<double>::infinity())), Error);
  EXPECT_THROW(sample_fit_target(constant(1), 0), Error);
  EXPECT_THROW(sample_fit_target(constant(1), 91), Error);
  EXPECT_THROW(check_fit_rows({}), Error);
  double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(check_fit_rows({{{0, 0, 1}, {0, 0, 1}, {nan, 1, 1}, 1}}), Error);
  EXPECT_THROW(check_fit_rows({{{0, 0, 1}, {0, 0, -1}, {1, 1, 1}, 1}}), Error);
  EXPECT_THROW(check_fit_rows({{{0, 0, 1}, {0, 0, 1}, {1, 1, 1}, 0}}), Error);
  EXPECT_THROW(parse_fit_metric("cube"), Error);
  EXPECT_THROW(fit_map(check_fit_rows({{{0, 0, 1}, {0, 0, 1}, {1, 1, 1}, 1}}), {}), Error);
}

} // namespace
} // namespace faceta
