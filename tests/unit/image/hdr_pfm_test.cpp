#include "support.h"

#include <bit>
#include <cmath>

using namespace faceta;
using namespace faceta::test;

namespace {

std::string be(float v) {
  const auto bits = std::bit_cast<std::uint32_t>(v);
  return {char(bits >> 24), char(bits >> 16), char(bits >> 8), char(bits)};
}
std::string le(float v) {
  std::string s = be(v);
  return {s[3], s[2], s[1], s[0]};
}

std::string rgbe(int r, int g, int b, int e) {
  return {char(r), char(g), char(b), char(e)};
}

const std::string kHead = "#?RADIANCE\n# a comment\nFORMAT=32-bit_rle_rgbe\n";

} // namespace

TEST(Pfm, BothEndiansBottomRowFirstScaleApplied) {
  const TempDir dir;
  write_bytes(dir / "b.pfm", "PF\n1 2\n1.0\n" + be(1) + be(2) + be(3) + be(4) + be(5) + be(6));
  EXPECT_EQ(read_image(dir / "b.pfm").data, (std::vector<float>{4, 5, 6, 1, 2, 3}));
  write_bytes(dir / "l.pfm", "Pf\n2 1\n-2.0\n" + le(1) + le(3));
  const Image grey = read_image(dir / "l.pfm");
  // Mitsuba 3.9.1 and OpenImageIO 3 read 2, 6 from these very bytes.
  EXPECT_EQ(grey.data, (std::vector<float>{2, 6}));
  EXPECT_EQ(grey.channels, (std::vector<std::string>{"Y"}));
}

TEST(Pfm, RoundTripIsExact) {
  const TempDir dir;
  Image image = half_noise(5, 4);
  image.data[3] = -1.0f / 3;
  write_image(dir / "a.pfm", image);
  EXPECT_EQ(read_image(dir / "a.pfm").data, image.data);
}

TEST(Pfm, MalformedHeadersAndTruncation) {
  const TempDir dir;
  const auto error = [&](const std::string& text) {
    write_bytes(dir / "x.pfm", text);
    return read_error(dir / "x.pfm");
  };
  EXPECT_CONTAINS(error("PF\n2 2\n-1\n" + std::string(47, 'x')), "truncated");
  EXPECT_CONTAINS(error("PF\n60000 10000\n-1\n"), "truncated");
  EXPECT_CONTAINS(error("PF\n99999999999 1\n-1\n"), "width");
  EXPECT_CONTAINS(error("PF\n70000 1\n-1\n"), "too large");
  EXPECT_CONTAINS(error("PF\n-1 1\n-1\n"), "no content");
  EXPECT_CONTAINS(error("PF\n1 1\n0\n0000"), "scale");
  EXPECT_CONTAINS(error("PF\n1 1\nnan\n0000"), "scale");
  EXPECT_CONTAINS(error("PF\n1"), "height");
}

TEST(Hdr, FlatPixelsAndOldRuns) {
  const TempDir dir;
  // 1 x 2^(129 - 136) x 128 = 1; the second pixel is repeated 2 + 1 * 256 times.
  write_bytes(dir / "a.hdr", kHead + "EXPOSURE=2\n\n-Y 1 +X 260\n" + rgbe(128, 64, 32, 129) +
                                 rgbe(16, 0, 200, 128) + rgbe(1, 1, 1, 2) + rgbe(1, 1, 1, 1));
  const Image image = read_image(dir / "a.hdr");
  ASSERT_EQ(image.width, 260);
  // Mitsuba 3.9.1 and OpenImageIO 3 read 1, 0.5, 0.25 here, and leave EXPOSURE alone.
  EXPECT_EQ(image.at(0, 0, 0), 1);
  EXPECT_EQ(image.at(0, 0, 2), 0.25f);
  EXPECT_EQ(image.at(1, 0, 2), 200.0f / 256);
  EXPECT_EQ(image.at(259, 0, 0), 16.0f / 256);
  EXPECT_EQ(std::get<double>(image.metadata.at("EXPOSURE")), 2);
}

TEST(Hdr, AllEightOrientations) {
  const TempDir dir;
  // A picture of 3 x 2 pixels numbered 1 .. 6 row by row from the top left.
  const auto pixel = [](int n) { return rgbe(128 + n, 0, 0, 129); };
  for (const char ys : {'-', '+'})
    for (const char xs : {'+', '-'})
      for (bool rows : {true, false}) {
        std::string body;
        for (int i = 0; i < 6; ++i) {
          int x = rows ? i % 3 : i / 2, y = rows ? i / 3 : i % 2;
          if (xs == '-')
            x = 2 - x;
          if (ys == '+')
            y = 1 - y;
          body += pixel(1 + y * 3 + x);
        }
        const std::string yy = std::string{ys} + "Y 2", xx = std::string{xs} + "X 3";
        write_bytes(dir / "o.hdr",
                    kHead + "\n" + (rows ? yy + " " + xx : xx + " " + yy) + "\n" + body);
        const Image image = read_image(dir / "o.hdr");
        ASSERT_EQ(image.width, 3);
        for (int i = 0; i < 6; ++i)
          EXPECT_EQ(image.at(i % 3, i / 3, 0), (129.0f + float(i)) / 128)
              << yy << " " << xx << rows;
      }
}

TEST(Hdr, RoundTripIsNearestInTheSharedExponent) {
  const TempDir dir;
  for (int width : {5, 8, 300}) { // flat, and run-length encoded
    Image image = half_noise(width, 9);
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, 3, c) = 0.75f;                                                      // runs
    image.at(0, 0, 0) = 0.9999f, image.at(0, 0, 1) = 0.9999f, image.at(0, 0, 2) = 0.1f; // carries
    image.at(1, 0, 0) = std::nanf(""), image.at(1, 0, 1) = -1, image.at(1, 0, 2) = 0;
    write_image(dir / "a.hdr", image);
    const Image back = read_image(dir / "a.hdr");
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < width; ++x) {
        if (x == 1 && y == 0)
          continue;
        const float largest = std::max({image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)});
        // Half a step of an 8-bit mantissa of the largest, at the least 128: 1/256 of it.
        for (int c = 0; c < 3; ++c)
          ASSERT_NEAR(back.at(x, y, c), image.at(x, y, c), double(largest) / 256 + 1e-9) << x << y;
      }
    EXPECT_EQ(back.at(0, 0, 0), 1);
    EXPECT_EQ(back.at(1, 0, 0), 0);
  }
}

TEST(Hdr, XyzIsNamedSo) {
  const TempDir dir;
  write_bytes(dir / "x.hdr",
              "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n" + rgbe(128, 64, 32, 129));
  EXPECT_EQ(read_image(dir / "x.hdr").channels, (std::vector<std::string>{"X", "Y", "Z"}));
}

TEST(Hdr, MalformedFiles) {
  const TempDir dir;
  const auto error = [&](const std::string& rest) {
    write_bytes(dir / "x.hdr", kHead + rest);
    return read_error(dir / "x.hdr");
  };
  EXPECT_CONTAINS(error("\n-Y 2 +X 8\n" + std::string("\2\2\0\10", 4)), "truncated");
  EXPECT_CONTAINS(error("\n-Y 1 +X 8\n" + std::string("\2\2\0\11\210\1\210\1", 8)),
                  "another length");
  EXPECT_CONTAINS(error("\n-Y 1 +X 8\n" + std::string("\2\2\0\10\211\1\210\1", 8)), "does not fit");
  EXPECT_CONTAINS(error("\n-Y 1 +X 2\n" + rgbe(1, 1, 1, 1)), "does not fit");
  EXPECT_CONTAINS(error("\n-Y 1 -Y 2\n1234"), "resolution");
  EXPECT_CONTAINS(error("\n-Y 99999999999 +X 2\n1234"), "resolution");
  EXPECT_CONTAINS(error("\n-Y 60000 +X 10000\n1234"), "truncated");
  EXPECT_CONTAINS(error("FORMAT=32-bit_rle_what\n\n-Y 1 +X 1\n1234"), "FORMAT");
  EXPECT_CONTAINS(error("-Y 1 +X 1"), "truncated");
}

// Repeats of whole pixels shrink a picture without bound: 12 bytes for 65281 pixels here.
TEST(Hdr, SmallFilesCannotClaimMuch) {
  std::string text = kHead + "\n-Y 200 +X 65281\n";
  for (int y = 0; y < 200; ++y)
    text += rgbe(128, 64, 32, 129) + rgbe(1, 1, 1, 0) + rgbe(1, 1, 1, 255);
  const codec::View file(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  try {
    codec::decode(file, "small.hdr");
    FAIL();
  } catch (const Error& error) {
    EXPECT_CONTAINS(error.what(), "2400 bytes cannot hold 13056200 pixels");
  }
}
