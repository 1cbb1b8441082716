#include "image/tonemap.h"
#include "support.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <png.h>

using namespace faceta;
using namespace faceta::test;

namespace {

struct Kind {
  int colour_type, depth, interlace;
};

std::string name_of(const testing::TestParamInfo<Kind>& info) {
  static const char* const kNames[] = {"grey", "", "rgb", "palette", "greyalpha", "", "rgba"};
  return std::string(kNames[info.param.colour_type]) + std::to_string(info.param.depth) +
         (info.param.interlace != 0 ? "_interlaced" : "");
}

std::vector<Kind> kinds() {
  std::vector<Kind> out;
  for (int interlace : {PNG_INTERLACE_NONE, PNG_INTERLACE_ADAM7}) {
    for (int depth : {1, 2, 4, 8})
      out.push_back({PNG_COLOR_TYPE_PALETTE, depth, interlace});
    for (int depth : {1, 2, 4, 8, 16})
      out.push_back({PNG_COLOR_TYPE_GRAY, depth, interlace});
    for (int type : {PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA})
      for (int depth : {8, 16})
        out.push_back({type, depth, interlace});
  }
  return out;
}

/// Sample `c` of pixel (x, y): any pattern that uses every bit of the depth.
unsigned sample(int x, int y, int c, int depth) {
  return static_cast<unsigned>(x * 40503 + y * 9973 + c * 12289 + (x * y) % 7) &
         ((1u << depth) - 1);
}

png_color palette_entry(unsigned i) {
  return {static_cast<png_byte>(i * 3), static_cast<png_byte>(255 - i),
          static_cast<png_byte>(i ^ 0x55)};
}

void on_write(png_structp png, png_bytep data, std::size_t size) {
  auto& out = *static_cast<codec::Bytes*>(png_get_io_ptr(png));
  out.insert(out.end(), data, data + size);
}

/// Writes the pattern with libpng itself. gamma > 0 adds a gAMA chunk.
codec::Bytes encode(const Kind& kind, int width, int height, double gamma = 0) {
  codec::Bytes out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, &out, on_write, nullptr);
  png_set_IHDR(png, info, png_uint_32(width), png_uint_32(height), kind.depth, kind.colour_type,
               kind.interlace, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  std::vector<png_color> palette;
  for (unsigned i = 0; i < 1u << std::min(kind.depth, 8); ++i)
    palette.push_back(palette_entry(i));
  if (kind.colour_type == PNG_COLOR_TYPE_PALETTE)
    png_set_PLTE(png, info, palette.data(), int(palette.size()));
  if (gamma > 0)
    png_set_gAMA(png, info, gamma);
  png_write_info(png, info);
  const int channels = png_get_channels(png, info);
  std::vector<codec::Bytes> rows;
  std::vector<png_bytep> pointers;
  for (int y = 0; y < height; ++y) {
    codec::Bytes& row = rows.emplace_back(png_get_rowbytes(png, info));
    for (int i = 0; i < width * channels; ++i) {
      const unsigned v = sample(i / channels, y, i % channels, kind.depth);
      if (kind.depth == 16)
        row[std::size_t(2 * i)] = png_byte(v >> 8), row[std::size_t(2 * i + 1)] = png_byte(v);
      else
        row[std::size_t(i * kind.depth / 8)] |=
            png_byte(v << (8 - kind.depth - i * kind.depth % 8));
    }
  }
  for (auto& row : rows)
    pointers.push_back(row.data());
  png_write_image(png, pointers.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return out;
}

class PngKind : public testing::TestWithParam<Kind> {};

} // namespace

TEST_P(PngKind, IsReadAsLibpngWroteIt) {
  const TempDir dir;
  const auto [type, depth, interlace] = GetParam();
  codec::write_file(dir / "a.png", encode(GetParam(), 21, 13));
  const Bitmap bitmap = read_bitmap(dir / "a.png");
  ASSERT_EQ(bitmap.type, depth == 16 ? Bitmap::Type::u16 : Bitmap::Type::u8);
  ASSERT_TRUE(bitmap.srgb_encoded);
  const Image image = read_image(dir / "a.png");
  ASSERT_EQ(image.channels, bitmap.channel_names);
  const double top = (1 << depth) - 1;
  for (int y = 0; y < 13; ++y)
    for (int x = 0; x < 21; ++x)
      for (int c = 0; c < image.channel_count(); ++c) {
        double unit = sample(x, y, c, depth) / top;
        if (type == PNG_COLOR_TYPE_PALETTE) {
          const png_color entry = palette_entry(sample(x, y, 0, depth));
          unit = (c == 0 ? entry.red : c == 1 ? entry.green : entry.blue) / 255.0;
        }
        const bool alpha = image.channels[std::size_t(c)] == "A";
        const double want = alpha ? unit : srgb_to_linear(unit);
        ASSERT_NEAR(image.at(x, y, c), want, 1e-7) << x << " " << y << " " << c;
        ASSERT_EQ(bitmap.linear(x, y, c), image.at(x, y, c));
      }
}

INSTANTIATE_TEST_SUITE_P(All, PngKind, testing::ValuesIn(kinds()), name_of);

TEST(Png, GammaChunkOverrulesTheCurveForImagesOnly) {
  const TempDir dir;
  const Kind kind{PNG_COLOR_TYPE_RGB, 8, 0};
  for (double file_gamma : {1.0, 0.5, 0.45455}) {
    codec::write_file(dir / "g.png", encode(kind, 4, 4, file_gamma));
    const Image image = read_image(dir / "g.png");
    const double unit = sample(3, 2, 1, 8) / 255.0;
    const double want =
        file_gamma == 0.45455 ? srgb_to_linear(unit) : std::pow(unit, 1 / file_gamma);
    EXPECT_NEAR(image.at(3, 2, 1), want, 1e-6);
    // Mitsuba 3.9.1's bitmap texture takes 8 bits for sRGB whatever the chunk says.
    EXPECT_NEAR(read_bitmap(dir / "g.png").linear(3, 2, 1), srgb_to_linear(unit), 1e-6);
  }
}

TEST(Png, WritesRoundedSrgbWithExposureAndLinearAlpha) {
  const TempDir dir;
  Image image(3, 1, {"R", "G", "B", "A"});
  image.data = {0.18f, 1,    0, 0.5f, std::nanf(""), std::numeric_limits<float>::infinity(), -1, 2,
                0.09f, 0.5f, 4, 0};
  write_image(dir / "a.png", image);
  EXPECT_EQ(read_bitmap(dir / "a.png").bytes,
            (codec::Bytes{118, 255, 0, 128, 0, 255, 0, 255, 85, 188, 255, 0}));
  write_image(dir / "b.png", image, {.exposure = 1});
  const Bitmap brighter = read_bitmap(dir / "b.png");
  EXPECT_EQ(brighter.bytes[8], 118); // 0.09 two times
  EXPECT_EQ(brighter.bytes[3], 128); // alpha is not light
  EXPECT_EQ(brighter.channel_names, image.channels);

  Image grey(2, 1, {"Y"}, 0.18f);
  write_image(dir / "y.png", grey);
  EXPECT_EQ(read_bitmap(dir / "y.png").bytes, (codec::Bytes{118, 118}));
}

TEST(Png, HugeClaimsAreRefusedBeforeAllocation) {
  const TempDir dir;
  codec::Bytes bytes = encode({PNG_COLOR_TYPE_RGB, 8, 0}, 4, 4);
  const auto set_size = [&](std::uint32_t width, std::uint32_t height) {
    // Big-endian, at bytes 16 and 20; the chunk's checksum follows its 13 bytes of data.
    for (int i = 0; i < 4; ++i) {
      bytes[std::size_t(16 + i)] = std::uint8_t(width >> (24 - 8 * i));
      bytes[std::size_t(20 + i)] = std::uint8_t(height >> (24 - 8 * i));
    }
    std::uint32_t crc = ~0u;
    for (std::size_t i = 12; i < 29; ++i) {
      crc ^= bytes[i];
      for (int bit = 0; bit < 8; ++bit)
        crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    crc = ~crc;
    for (int i = 0; i < 4; ++i)
      bytes[std::size_t(29 + i)] = std::uint8_t(crc >> (24 - 8 * i));
    codec::write_file(dir / "h.png", bytes);
    return read_error(dir / "h.png");
  };
  EXPECT_CONTAINS(set_size(30000, 30000), "too short");
  EXPECT_CONTAINS(set_size(800, 800), "too short");
  EXPECT_CONTAINS(set_size(65536, 65536), "too large");
  EXPECT_CONTAINS(set_size(100000, 10), "h.png");
}
