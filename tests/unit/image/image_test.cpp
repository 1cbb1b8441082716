#include "image/image.h"
#include "image/tonemap.h"
#include "support.h"

#include <limits>

using namespace faceta;
using namespace faceta::test;

TEST(Image, SelectTakesChannelsByNameInTheOrderAsked) {
  Image image(2, 1, {"A", "R"});
  image.data = {1, 2, 3, 4};
  EXPECT_EQ(image.select({"R", "A", "R"}).data, (std::vector<float>{2, 1, 2, 4, 3, 4}));
  try {
    image.select({"G"});
    FAIL();
  } catch (const Error& e) {
    EXPECT_CONTAINS(e.what(), "no channel 'G'");
    EXPECT_CONTAINS(e.what(), "A, R");
  }
}

TEST(Image, RgbFallsBackAsAsked) {
  Image grey(1, 1, {"Y"}, 0.25f);
  EXPECT_EQ(grey.rgb().data, (std::vector<float>{0.25f, 0.25f, 0.25f}));
  EXPECT_THROW(grey.rgb(RgbFallback::none), Error);

  // The XYZ of the D65 white with Y = 1 is RGB white (ITU-R BT.709; to the matrices' six digits).
  Image xyz(1, 1, {"X", "Y", "Z"});
  xyz.data = {0.950456f, 1.0f, 1.088754f};
  EXPECT_THROW(xyz.rgb(), Error); // Y must not pass for grey
  for (float v : xyz.rgb(RgbFallback::luminance_or_xyz).data)
    EXPECT_NEAR(v, 1, 2e-5);

  Image layers(1, 1, {"R", "G", "B", "d.R", "d.G", "d.B"});
  layers.data = {1, 2, 3, 4, 5, 6};
  EXPECT_EQ(layers.rgb(RgbFallback::none, "d").data, (std::vector<float>{4, 5, 6}));
}

TEST(Image, CropKnowsItsPlaceAndFrameUndoesIt) {
  const Image image = half_noise(7, 5);
  const Image part = image.crop(2, 1, 3, 4);
  EXPECT_EQ(part.at(0, 0, 1), image.at(2, 1, 1));
  EXPECT_EQ(part.at(2, 3, 2), image.at(4, 4, 2));
  const Image back = part.frame(-1);
  EXPECT_EQ(back.width, 7);
  EXPECT_EQ(back.height, 5);
  EXPECT_EQ(back.at(3, 2, 0), image.at(3, 2, 0));
  EXPECT_EQ(back.at(1, 2, 0), -1);
  EXPECT_EQ(back.at(5, 2, 0), -1);
  EXPECT_EQ(back.at(3, 0, 0), -1);
  EXPECT_EQ(part.crop(1, 1, 1, 1).x, 3);
  EXPECT_THROW(image.crop(5, 0, 3, 1), Error);
  EXPECT_THROW(image.crop(-1, 0, 3, 1), Error);
}

TEST(Image, SizesAreCapped) {
  EXPECT_THROW(Image(0, 1), Error);
  EXPECT_THROW(check_image_size(65537, 1), Error);
  EXPECT_THROW(check_image_size(65536, 65536), Error);
  EXPECT_NO_THROW(check_image_size(65536, 16384));
}

// Mitsuba 3.9.1, Bitmap.convert of unit RGB pixels to XYZ and back, in single precision.
TEST(Image, ColourMatricesAreMitsubas) {
  const double to_xyz[3][3] = {
      {0.412453, 0.212671, 0.019334}, {0.35758, 0.71516, 0.119193}, {0.180423, 0.072169, 0.950227}};
  for (std::size_t i = 0; i < 3; ++i) {
    std::array<double, 3> unit{};
    unit[i] = 1;
    const auto xyz = rgb_to_xyz(unit);
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(xyz[j], to_xyz[i][j], 1e-9);
    const auto back = xyz_to_rgb(xyz);
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(back[j], unit[j], 2e-6);
  }
}

TEST(Tonemap, SrgbCurveHasItsKnownValues) {
  // IEC 61966-2-1: code 128 of 255, 18 % grey, and the linear part.
  EXPECT_NEAR(srgb_to_linear(128 / 255.0), 0.2158605, 1e-7);
  EXPECT_EQ(linear_to_srgb8(0.18), 118);
  EXPECT_DOUBLE_EQ(srgb_to_linear(0.04), 0.04 / 12.92);
  EXPECT_EQ(linear_to_srgb8(0.09, 1), linear_to_srgb8(0.18));
  for (int code = 0; code < 256; ++code)
    EXPECT_EQ(linear_to_srgb8(srgb_to_linear(code / 255.0)), code);
  for (double v : {-2.0, -0.001, 0.0, 0.002, 0.5, 7.0})
    EXPECT_NEAR(srgb_to_linear(linear_to_srgb(v)), v, 1e-12);
}

TEST(Tonemap, EightBitsTakeAnyValue) {
  const float inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(linear_to_srgb8(std::nanf("")), 0);
  EXPECT_EQ(linear_to_srgb8(inf), 255);
  EXPECT_EQ(linear_to_srgb8(-inf), 0);
  EXPECT_EQ(to_u8(0.5 / 255), 1);
  EXPECT_EQ(to_u8(0.49 / 255), 0);
}
