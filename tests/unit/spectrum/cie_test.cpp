#include "spectrum/cie.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

using namespace faceta;
using Triple = std::array<double, 3>;

namespace {

void expect_near(const Triple& got, const Triple& want, double relative) {
  for (size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(got[c], want[c], relative * std::abs(want[c]) + 1e-12) << "channel " << c;
}

/// XYZ of a spectrum as CIE 15 sums it: 380 to 780 nm in steps of 5 nm.
template <class F> Triple integrate(F&& spectrum) {
  Triple sum{};
  for (int nm = 380; nm <= 780; nm += 5) {
    Triple xyz = cie1931_xyz(nm);
    for (size_t c = 0; c < 3; ++c)
      sum[c] += xyz[c] * spectrum(nm) * 5;
  }
  return sum;
}

} // namespace

TEST(Cie, MatchesMitsubaAtAndBetweenThePublishedValues) {
  // Origin: Mitsuba 3.9.1, cie1931_xyz and cie_d65.
  expect_near(cie1931_xyz(360), {1.299e-04, 3.917e-06, 6.061e-04}, 2e-7);
  expect_near(cie1931_xyz(362.5), {1.8100001e-04, 5.4410002e-06, 8.4604998e-04}, 2e-7);
  expect_near(cie1931_xyz(401), {0.016086, 0.0004448, 0.07632}, 2e-7);
  expect_near(cie1931_xyz(557.3), {0.54997694, 0.9977, 0.004899001}, 1e-6);
  expect_near(cie1931_xyz(830), {1.251141e-06, 4.518100e-07, 0}, 2e-7);
  EXPECT_NEAR(cie_d65(362.5), 0.4848712384700775, 1e-7);
  EXPECT_NEAR(cie_d65(401), 0.8447492718696594, 1e-7);
  EXPECT_NEAR(cie_d65(557.3), 1.0211622714996338, 1e-6);
  EXPECT_NEAR(cie_d65(830), 0.6092330813407898, 1e-7);
}

TEST(Cie, IsZeroOutsideItsRange) {
  for (double nm : {359.999, 830.001, -1.0, std::numeric_limits<double>::infinity(),
                    std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(cie1931_xyz(nm), (Triple{0, 0, 0}));
    EXPECT_EQ(cie_d65(nm), 0);
  }
}

TEST(Cie, WhitesHaveTheirPublishedChromaticities) {
  // CIE 15:2004: the equal-energy stimulus at (1/3, 1/3), D65 at (0.31272, 0.32903).
  Triple e = integrate([](double) { return 1.0; });
  EXPECT_NEAR(e[0] / (e[0] + e[1] + e[2]), 1 / 3., 5e-6);
  EXPECT_NEAR(e[1] / (e[0] + e[1] + e[2]), 1 / 3., 5e-6);
  Triple d = integrate(cie_d65);
  EXPECT_NEAR(d[0] / (d[0] + d[1] + d[2]), 0.31272, 1e-5);
  EXPECT_NEAR(d[1] / (d[0] + d[1] + d[2]), 0.32903, 1e-5);
  EXPECT_NEAR(d[1] * kCieYNormalization, 1, 2e-3);
  EXPECT_NEAR(e[1] * kCieYNormalization, 1, 2e-3);
}

TEST(Cie, LuminosityPeaksWithOneAt555) {
  EXPECT_EQ(cie1931_xyz(555)[1], 1);
  for (int nm = 360; nm <= 830; ++nm)
    EXPECT_LE(cie1931_xyz(nm)[1], 1);
}

TEST(ColourSpace, MatricesAreMitsubas) {
  // Origin: Mitsuba 3.9.1, xyz_to_srgb and srgb_to_xyz of the unit vectors and of (1, 1, 1).
  expect_near(xyz_to_srgb({1, 0, 0}), {3.240479, -0.969256, 0.055648}, 1e-12);
  expect_near(xyz_to_srgb({0, 1, 0}), {-1.53715, 1.875991, -0.204043}, 1e-12);
  expect_near(xyz_to_srgb({0, 0, 1}), {-0.498535, 0.041556, 1.057311}, 1e-12);
  expect_near(xyz_to_srgb({1, 1, 1}), {1.2047939, 0.948291, 0.90891606}, 1e-7);
  expect_near(srgb_to_xyz({1, 0, 0}), {0.412453, 0.212671, 0.019334}, 1e-12);
  expect_near(srgb_to_xyz({0, 1, 0}), {0.35758, 0.71516, 0.119193}, 1e-12);
  expect_near(srgb_to_xyz({0, 0, 1}), {0.180423, 0.072169, 0.950227}, 1e-12);
}

TEST(ColourSpace, PrimariesAreThoseOfBt709AndTheMatricesInverse) {
  const double primaries[3][2] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}};
  for (size_t c = 0; c < 3; ++c) {
    Triple rgb{};
    rgb[c] = 1;
    Triple xyz = srgb_to_xyz(rgb);
    double sum = xyz[0] + xyz[1] + xyz[2];
    EXPECT_NEAR(xyz[0] / sum, primaries[c][0], 2e-6);
    EXPECT_NEAR(xyz[1] / sum, primaries[c][1], 2e-6);
    Triple back = xyz_to_srgb(xyz);
    for (size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(back[i], rgb[i], 3e-6);
    EXPECT_DOUBLE_EQ(luminance(rgb), xyz[1]);
  }
}
