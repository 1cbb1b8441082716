#include "image/metrics.h"
#include "support.h"

#include <cmath>
#include <limits>

using namespace faceta;
using namespace faceta::test;

namespace {

Image constant(int width, int height, float r, float g, float b) {
  Image out(width, height);
  for (std::size_t i = 0; i < out.data.size(); i += 3)
    out.data[i] = r, out.data[i + 1] = g, out.data[i + 2] = b;
  return out;
}

/// Adds Gaussian noise of a standard deviation to every value.
void add_noise(Image& image, float sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0, sigma);
  for (float& v : image.data)
    v += normal(random);
}

/// Share of a normal distribution beyond |z|.
double tail(double z) {
  return std::erfc(z / std::sqrt(2.0));
}

} // namespace

TEST(Metrics, KnownDifference) {
  const Image a = constant(4, 2, 1, 2, 3);
  Image b = constant(4, 2, 1, 2, 3);
  b.at(3, 1, 1) = 1.5f; // one of 24 values is off by 0.5
  const Comparison c = compare(a, b);
  EXPECT_DOUBLE_EQ(c.all.mse, 0.25 / 24);
  EXPECT_DOUBLE_EQ(c.all.rmse, std::sqrt(0.25 / 24));
  EXPECT_DOUBLE_EQ(c.all.rel_mse, 0.25 / (2.25 + 0.01) / 24);
  EXPECT_DOUBLE_EQ(c.all.psnr, 10 * std::log10(24 / 0.25));
  EXPECT_EQ(c.all.max_abs, 0.5);
  EXPECT_EQ(c.all.x, 3);
  EXPECT_EQ(c.all.y, 1);
  EXPECT_EQ(c.all.channel, "G");
  EXPECT_DOUBLE_EQ(c.per_channel[1].mse, 0.25 / 8);
  EXPECT_EQ(c.per_channel[0].mse, 0);
  EXPECT_DOUBLE_EQ(c.all.mean_a, 2);
  EXPECT_TRUE(std::isinf(compare(a, a).all.psnr));
}

TEST(Metrics, OnlyCommonChannelsAndFiniteValuesCount) {
  Image a(2, 1, {"Y", "Z"});
  a.data = {1, 100, std::nanf(""), 100};
  Image b(2, 1, {"A", "Y"});
  b.data = {7, 3, 7, 5};
  const Comparison c = compare(a, b);
  EXPECT_EQ(c.channels, (std::vector<std::string>{"Y"}));
  EXPECT_EQ(c.all.mse, 4);
  EXPECT_EQ(c.all.non_finite, 1);
  EXPECT_THROW(compare(a, Image(1, 2, {"Y"})), Error);
  EXPECT_THROW(compare(a, Image(2, 1, {"R"})), Error);
}

TEST(Metrics, TwoSidedZInvertsTheTail) {
  EXPECT_NEAR(two_sided_z(0.05), 1.959963984540054, 1e-12); // the usual table
  EXPECT_NEAR(two_sided_z(2.866515718791933e-07), 5.131018, 2e-3);
  for (double alpha : {0.3, 1e-3, 1e-8, 1e-15})
    EXPECT_NEAR(tail(two_sided_z(alpha)) / alpha, 1, 1e-9);
}

TEST(ZTest, AcceptsTheNoiseItExpectsAndNoOther) {
  // The reference is black, so the noise itself is the picture; XYZ variance of independent RGB
  // noise differs from the pushed-through variance, so white noise is made in XYZ here.
  const int n = 64;
  const double spp = 100;
  const Image reference = constant(n, n, 0.5f, 0.5f, 0.5f);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (double scale : {1.0, 1.5}) {
    Image picture = reference;
    Image variance(n, n);
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const double sigma = 0.2; // of one sample
        const auto noise =
            xyz_to_rgb({scale * sigma / 10 * normal(random), scale * sigma / 10 * normal(random),
                        scale * sigma / 10 * normal(random)});
        const auto var = xyz_to_rgb({sigma * sigma, sigma * sigma, sigma * sigma});
        for (int c = 0; c < 3; ++c) {
          picture.at(x, y, c) += float(noise[std::size_t(c)]);
          variance.at(x, y, c) = float(var[std::size_t(c)]);
        }
      }
    const ZTest test = z_test(picture, reference, variance, spp);
    EXPECT_NEAR(test.alpha, 1 - std::pow(0.99, 1.0 / (n * n)), 1e-15);
    EXPECT_TRUE(test.pass);
    // A share of tail(threshold / scale) of the values fails.
    const double expected = tail(test.z_threshold / scale);
    EXPECT_NEAR(1 - test.pass_share, expected, 4 * std::sqrt(expected / (3.0 * n * n)) + 1e-9);
    for (double z : test.mean_z)
      EXPECT_LT(std::abs(z), 4.5);
  }
}

TEST(ZTest, FindsTheWorstPixelAndFloorsTheVariance) {
  const Image reference = constant(8, 8, 1, 1, 1), black = constant(8, 8, 0, 0, 0);
  Image picture = reference;
  picture.at(5, 2, 1) -= 0.01f; // green: XYZ differ by 0.35758, 0.71516, 0.119193 of it
  const ZTest test = z_test(picture, reference, black, 400);
  EXPECT_EQ(test.x, 5);
  EXPECT_EQ(test.y, 2);
  EXPECT_EQ(test.channel, 'Y');
  EXPECT_NEAR(test.largest_z, -0.01 * 0.71516 * std::sqrt(400 / 1e-4), 1e-3);
  // Two of 192 values exceed the threshold (z = 14.3, 7.2; 2.4 does not), more than 0.25 %.
  EXPECT_DOUBLE_EQ(test.pass_share, 190.0 / 192);
  EXPECT_FALSE(test.pass);
  picture.at(0, 0, 0) = std::nanf("");
  EXPECT_EQ(z_test(picture, reference, black, 400).non_finite, 3);
  EXPECT_THROW(z_test(picture, reference, black, 0), Error);
}

TEST(TwoSampleTest, SharesAreThoseOfTheNormalDistribution) {
  const int n = 256;
  Image a = constant(n, n, 1, 2, 3), b = a;
  add_noise(a, 0.3f, 1);
  add_noise(b, 0.4f, 2);
  const Image va = constant(n, n, 0.09f, 0.09f, 0.09f), vb = constant(n, n, 0.16f, 0.16f, 0.16f);
  const TwoSampleTest test = two_sample_test(a, va, b, vb, 2);
  const double expected = tail(2), values = 3.0 * n * n;
  EXPECT_NEAR(test.pixel_share, expected, 4 * std::sqrt(expected / values));
  EXPECT_NEAR(test.block_share, expected, 4 * std::sqrt(expected / (values / 64)));
  for (double z : test.mean_z)
    EXPECT_LT(std::abs(z), 4);
  EXPECT_NEAR(test.mean_ratio[0], 1, 0.01);
}

TEST(TwoSampleTest, BlocksSeeABiasThatPixelsDoNot) {
  Image a = constant(20, 20, 1, 1, 1), b = a; // 20 is no multiple of 8: edge blocks are smaller
  const Image var = constant(20, 20, 0.5f, 0.5f, 0.5f);
  for (int y = 8; y < 16; ++y)
    for (int x = 8; x < 16; ++x)
      a.at(x, y, 2) += 1;
  const TwoSampleTest test = two_sample_test(a, var, b, var);
  EXPECT_EQ(test.pixel_share, 0);
  EXPECT_NEAR(test.largest_block_z, 8, 1e-4); // 64 / sqrt(64)
  EXPECT_EQ(test.block_x, 8);
  EXPECT_EQ(test.block_y, 8);
  EXPECT_DOUBLE_EQ(test.block_share, 1 / 27.0);
  EXPECT_NEAR(test.mean_ratio[2], 464.0 / 400, 1e-6);
  EXPECT_NEAR(test.mean_z[2], 64 / std::sqrt(400.0), 1e-5);
}

TEST(TwoSampleTest, NoiselessEqualPixelsAgree) {
  const Image a = constant(8, 8, 0, 1, 2), zero = constant(8, 8, 0, 0, 0);
  Image b = a;
  b.data[1] = 1.0f + 1.0f / 4096; // within the rounding of half
  const TwoSampleTest test = two_sample_test(a, zero, b, zero);
  EXPECT_EQ(test.pixel_share, 0);
  b.data[0] = 1e-3f; // black against not black, both certain
  EXPECT_GT(two_sample_test(a, zero, b, zero).pixel_share, 0);
}
