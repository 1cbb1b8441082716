#include "image/metrics.h"
#include "support.h"

using namespace faceta;
using namespace faceta::test;

namespace {

std::filesystem::path shared(const std::string& path) {
  return std::filesystem::path(FACETA_SHARED_DATA) / path;
}

#define NEED_SHARED_DATA                                                                           \
  if (!std::filesystem::exists(shared("mitsuba-data")))                                            \
  GTEST_SKIP() << "the shared scene data are not beside this checkout"

struct Expected {
  const char* file;
  int width, height;
  std::vector<std::string> channels;
  int x, y;
  std::vector<double> pixel, sums;
  bool codes = false; ///< compare stored 8-bit codes, not linear values
};

} // namespace

// Sizes, one pixel and the sums of all pixels as OpenImageIO 3 (its Python module,
// ImageBuf.get_pixels) gives them.
TEST(SharedData, RealFilesReadAsOpenImageIoReadsThem) {
  NEED_SHARED_DATA;
  const std::vector<std::string> rgb{"R", "G", "B"};
  const std::vector<Expected> all{
      {"mitsuba-data/common/textures/museum.exr",
       512,
       256,
       rgb,
       170,
       64,
       {0.19921875, 0.093505859375, 0.041290283203125},
       {52030.57000774145, 41446.44870340824, 36485.24632918835}},
      {"scenes/rgl-teapot/textures/envmap.hdr",
       1024,
       512,
       rgb,
       341,
       128,
       {0.8125, 0.953125, 3.390625},
       {322505.3549031615, 297255.56475037336, 307430.72230535746}},
      {"mitsuba-data/tests/scenes/bsdf_spheres/refs/test_arealight_ref_rgb.exr",
       48,
       48,
       rgb,
       16,
       12,
       {2.499053516658023e-05, 1.3097619557811413e-05, 3.3437797810620395e-06},
       {84.37983571645144, 51.07447734061159, 11.942390776872964}},
      {"mitsuba-data/tests/bitmap/spot_multi.exr",
       48,
       48,
       {"R", "G", "B", "A", "_arg_0.X", "_arg_0.Y", "_arg_0.Z", "m2__arg_0.X", "m2__arg_0.Y",
        "m2__arg_0.Z"},
       16,
       12,
       {0.278076171875, 1.0244140625, 0.3544921875, 1.0, 0.544921875, 0.8173828125, 0.46435546875,
        0.5234375, 1.431640625, 0.59716796875},
       {605.9859008789062, 652.62255859375, 668.4931030273438, 2304.0, 603.9163208007812,
        643.8480834960938, 724.724609375, 435.30665588378906, 647.7718048095703,
        984.4589996337891}},
      {"mitsuba-data/common/textures/leaf_mask.png",
       239,
       241,
       {"Y", "A"},
       79,
       60,
       {255, 255},
       {6541363, 14687258},
       true},
      {"mitsuba-data/common/textures/carrot.png",
       10,
       9,
       {"R", "G", "B", "A"},
       3,
       2,
       {247, 247, 247, 255},
       {16482, 14512, 11046, 22950},
       true},
      {"mitsuba-data/common/textures/wood.jpg",
       2048,
       1571,
       rgb,
       682,
       392,
       {150, 141, 136},
       {489377922, 455825475, 435687728},
       true},
  };
  for (const Expected& e : all) {
    const Bitmap bitmap = read_bitmap(shared(e.file));
    ASSERT_EQ(bitmap.width, e.width) << e.file;
    ASSERT_EQ(bitmap.height, e.height) << e.file;
    ASSERT_EQ(bitmap.channel_names, e.channels) << e.file;
    const Image image = e.codes ? Image() : read_image(shared(e.file));
    const auto value = [&](std::size_t p, std::size_t c) {
      const std::size_t i = p * e.channels.size() + c;
      return e.codes ? double(bitmap.bytes[i]) : double(image.data[i]);
    };
    for (std::size_t c = 0; c < e.channels.size(); ++c) {
      EXPECT_EQ(value(std::size_t(e.y * e.width + e.x), c), e.pixel[c]) << e.file << " " << c;
      double sum = 0;
      for (std::size_t p = 0; p < std::size_t(e.width) * std::size_t(e.height); ++p)
        sum += value(p, c);
      EXPECT_NEAR(sum, e.sums[c], 1e-9 * e.sums[c]) << e.file << " " << c;
    }
  }
}

TEST(SharedData, SixteenBitPng) {
  NEED_SHARED_DATA;
  const auto path = shared("mitsuba-data/common/textures/noise_8x8.png");
  const Bitmap bitmap = read_bitmap(path);
  ASSERT_EQ(bitmap.type, Bitmap::Type::u16);
  // OpenImageIO: 0.28364995 of the full scale, undecoded.
  EXPECT_NEAR(bitmap.linear(2, 2, 1), std::pow((0.2836499512195587 + 0.055) / 1.055, 2.4), 1e-6);
}

// Luminance and half-resolution chroma with the primaries of XYZ. Mitsuba 3.9.1 reads the first
// three pixels below; its filter for the chroma differs from OpenEXR's, luminance is exact.
TEST(SharedData, LuminanceChromaIsReconstructed) {
  NEED_SHARED_DATA;
  const Image image = read_image(shared("mitsuba-data/tests/bitmap/XYZ_YC.exr"));
  ASSERT_EQ(image.channels, (std::vector<std::string>{"X", "Y", "Z"}));
  ASSERT_EQ(image.width, 610);
  EXPECT_FLOAT_EQ(image.at(200, 100, 1), 0.07080078f);
  EXPECT_FLOAT_EQ(image.at(500, 300, 1), 0.40039062f);
  EXPECT_NEAR(image.at(200, 100, 0), 0.05581665, 1e-3);
  EXPECT_NEAR(image.at(200, 100, 2), 0.03356934, 1e-3);
  double means[3] = {0, 0, 0};
  for (std::size_t i = 0; i < image.data.size(); ++i)
    means[i % 3] += double(image.data[i]);
  const double mitsuba[3] = {0.2710065, 0.2847542, 0.14944874};
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(means[c] / double(image.pixel_count()), mitsuba[c], 1e-3);
}

// The picture is the spectral reference of the same scene, tested as if it had few samples.
// Expected: the rule computed with Mitsuba 3.9.1's Bitmap.convert to XYZ and Python's math.erfc in
// double.
TEST(SharedData, ZTestAgreesWithMitsubasRule) {
  NEED_SHARED_DATA;
  struct Case {
    const char* scene;
    double spp, share, largest;
    int x, y;
    char channel;
    double mean_z[3];
  };
  const Case cases[] = {
      {"arealight",
       100,
       0.9998553240740741,
       -4.645678087442017,
       31,
       32,
       'Z',
       {0.5243525391497573, 0.23113529833732355, -0.04655142805721212}},
      {"arealight",
       32000,
       0.9518229166666666,
       -83.1044160408125,
       31,
       32,
       'Z',
       {9.379903373707815, 4.134673912655596, -0.8327372606849381}},
      {"roughdielectric",
       100,
       1.0,
       -3.067650552224484,
       45,
       4,
       'Z',
       {-0.019465061551068672, -0.02153395006913243, -0.06710017699489475}},
      {"textured_roughconductor",
       32000,
       0.48336226851851855,
       -87.01940279909769,
       9,
       19,
       'X',
       {-151.75285032025246, -22.492645247070744, 172.80787826322987}},
  };
  for (const Case& c : cases) {
    const std::string base =
        std::string("mitsuba-data/tests/scenes/bsdf_spheres/refs/test_") + c.scene + "_ref_";
    const ZTest test =
        z_test(read_image(shared(base + "spectral.exr")), read_image(shared(base + "rgb.exr")),
               read_image(shared(base + "rgb_var.exr")), c.spp);
    EXPECT_NEAR(test.alpha, 4.362115422318347e-06, 1e-12) << c.scene;
    EXPECT_NEAR(test.pass_share, c.share, 1e-9) << c.scene;
    EXPECT_EQ(test.pass, c.share >= 0.9975) << c.scene;
    EXPECT_NEAR(test.largest_z / c.largest, 1, 1e-4) << c.scene;
    EXPECT_EQ(test.x, c.x) << c.scene;
    EXPECT_EQ(test.y, c.y) << c.scene;
    EXPECT_EQ(test.channel, c.channel) << c.scene;
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(test.mean_z[i], c.mean_z[i], 1e-3 + 1e-3 * std::abs(c.mean_z[i])) << c.scene;
  }
}
