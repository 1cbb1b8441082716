#include "image/tonemap.h"
#include "support.h"

#include <cstdio>
#include <cstdlib>
#include <jpeglib.h>

using namespace faceta;
using namespace faceta::test;

namespace {

/// Encodes a smooth picture with libjpeg itself.
codec::Bytes encode(int width, int height, J_COLOR_SPACE space, bool progressive, int scans = 0) {
  const int channels = space == JCS_GRAYSCALE ? 1 : space == JCS_CMYK ? 4 : 3;
  jpeg_compress_struct jpeg;
  jpeg_error_mgr errors;
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &data, &size);
  jpeg.image_width = JDIMENSION(width), jpeg.image_height = JDIMENSION(height);
  jpeg.input_components = channels;
  jpeg.in_color_space = space;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 97, TRUE);
  if (progressive)
    jpeg_simple_progression(&jpeg);
  std::vector<jpeg_scan_info> script{{1, {0}, 0, 0, 0, 0}}; // grey: each coefficient, bit by bit
  for (int i = 0; i + 1 < scans; ++i)
    script.push_back({1, {0}, 1 + i / 4, 1 + i / 4, i % 4 == 0 ? 0 : 4 - i % 4, 3 - i % 4});
  if (scans > 0)
    jpeg.scan_info = script.data(), jpeg.num_scans = scans;
  jpeg_start_compress(&jpeg, TRUE);
  codec::Bytes row(std::size_t(width * channels));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c)
        row[std::size_t(x * channels + c)] = std::uint8_t(40 + 2 * x + y + 20 * c);
    JSAMPROW pointer = row.data();
    jpeg_write_scanlines(&jpeg, &pointer, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  codec::Bytes out(data, data + size);
  std::free(data);
  return out;
}

} // namespace

TEST(Jpeg, BaselineAndProgressiveGreyAndColour) {
  const TempDir dir;
  for (bool progressive : {false, true})
    for (auto space : {JCS_GRAYSCALE, JCS_RGB}) {
      codec::write_file(dir / "a.jpg", encode(37, 29, space, progressive));
      const Bitmap bitmap = read_bitmap(dir / "a.jpg");
      ASSERT_EQ(bitmap.channels, space == JCS_GRAYSCALE ? 1 : 3);
      ASSERT_TRUE(bitmap.srgb_encoded);
      ASSERT_EQ(bitmap.type, Bitmap::Type::u8);
      const Image image = read_image(dir / "a.jpg");
      for (int y = 0; y < 29; ++y)
        for (int x = 0; x < 37; ++x)
          for (int c = 0; c < bitmap.channels; ++c) {
            const int code = bitmap.bytes[std::size_t((y * 37 + x) * bitmap.channels + c)];
            ASSERT_NEAR(code, 40 + 2 * x + y + 20 * c, 4);
            ASSERT_NEAR(image.at(x, y, c), srgb_to_linear(code / 255.0), 1e-6);
          }
    }
}

TEST(Jpeg, CmykIsRefused) {
  const TempDir dir;
  codec::write_file(dir / "c.jpg", encode(8, 8, JCS_CMYK, false));
  EXPECT_CONTAINS(read_error(dir / "c.jpg"), "CMYK");
}

TEST(Jpeg, EveryTruncationIsAnError) {
  for (bool progressive : {false, true}) {
    const codec::Bytes bytes = encode(40, 40, JCS_RGB, progressive);
    // All but the end mark itself (two bytes), whose absence loses no picture data.
    for (std::size_t size = 0; size + 2 < bytes.size(); size += 3)
      ASSERT_THROW(codec::decode(codec::View(bytes).first(size), "t"), Error)
          << size << " of " << bytes.size();
  }
}

TEST(Jpeg, DamagedFilesEndInAnErrorOrAPicture) {
  std::mt19937 random(7);
  for (bool progressive : {false, true}) {
    const codec::Bytes bytes = encode(40, 40, JCS_RGB, progressive);
    int errors = 0;
    for (std::size_t i = 0; i < 2000; ++i) {
      codec::Bytes damaged = bytes;
      damaged[(i < 1500 ? i / 2 : random()) % bytes.size()] = std::uint8_t(random());
      try {
        codec::decode(damaged, "damaged");
      } catch (const Error&) {
        ++errors;
      }
    }
    EXPECT_GT(errors, 0);
  }
}

TEST(Jpeg, HugeClaimsAreRefusedBeforeAllocation) {
  const TempDir dir;
  codec::Bytes bytes = encode(8, 8, JCS_RGB, false);
  for (std::size_t i = 2; i + 9 < bytes.size(); ++i)
    if (bytes[i] == 0xff && bytes[i + 1] == 0xc0) { // start of frame: height and width at 5, 7
      bytes[i + 5] = bytes[i + 7] = 0x7f;
      break;
    }
  codec::write_file(dir / "h.jpg", bytes);
  EXPECT_CONTAINS(read_error(dir / "h.jpg"), "too short");
}

TEST(Jpeg, FilesOfMoreScansThanAnyoneMakesAreRefused) {
  const codec::Bytes some = encode(16, 16, JCS_GRAYSCALE, true, 150);
  EXPECT_EQ(codec::decode(some, "some").bitmap.width, 16);
  const codec::Bytes many = encode(16, 16, JCS_GRAYSCALE, true, 240);
  try {
    codec::decode(many, "many");
    FAIL();
  } catch (const Error& error) {
    EXPECT_CONTAINS(error.what(), "more than 200 scans");
  }
}
