#include "base/error.h"
#include "scene/textures.h"

#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

using namespace faceta;

namespace {

double decode_srgb(double c) { // IEC 61966-2-1
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// A bitmap of 8-bit values that tell where they are.
Bitmap numbered(int width, int height, int channels) {
  Bitmap b;
  b.width = width, b.height = height, b.channels = channels;
  b.srgb_encoded = true;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c)
        b.bytes.push_back(static_cast<uint8_t>(10 * y + x + 60 * c));
  const char* names[][4] = {{"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
  b.channel_names.assign(names[channels - 1], names[channels - 1] + channels);
  return b;
}

TextureDesc bitmap_texture(const Bitmap& b, bool raw = false) {
  TextureDesc desc;
  desc.type = TextureType::bitmap8;
  desc.bitmap = std::make_shared<Bitmap>(b);
  desc.raw = raw;
  return desc;
}

size_t index_of(const TextureView& t, int x, int y) {
  return size_t((y / 3 * t.tiles_x + x / 3) * 16 + y % 3 * 4 + x % 3);
}

TEST(Textures, BytesLieInTilesAndStayBytes) {
  for (int channels = 1; channels <= 4; ++channels) {
    TextureStore store;
    const TextureDesc desc = bitmap_texture(numbered(6, 9, channels));
    store.add(desc);
    const TextureView& t = store.views()[0];
    EXPECT_EQ(t.type, TextureType::bitmap8);
    EXPECT_EQ(t.tiles_x, 2);
    EXPECT_EQ(t.srgb, 1);
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < 6; ++x) {
        uint32_t texel = t.texels8[index_of(t, x, y)];
        uint32_t first = 10 * y + x;
        bool grey = channels < 3;
        EXPECT_EQ(texel & 255, first);
        EXPECT_EQ(texel >> 8 & 255, grey ? first : first + 60);
        EXPECT_EQ(texel >> 16 & 255, grey ? first : first + 120);
        uint32_t alpha = channels == 2 ? first + 60 : (first + 180) & 255;
        EXPECT_EQ(texel >> 24, channels % 2 == 0 ? alpha : 255);
      }
  }
}

TEST(Textures, TexelsHaveTheirNeighboursBesideThem) {
  for (WrapMode mode : {WrapMode::repeat, WrapMode::clamp, WrapMode::mirror}) {
    TextureStore store;
    TextureDesc desc = bitmap_texture(numbered(7, 6, 1));
    desc.wrap = mode;
    store.add(desc);
    const TextureView& t = store.views()[0];
    auto after = [&](int i, int size) {
      return i + 1 < size ? i + 1 : mode == WrapMode::repeat ? 0 : i;
    };
    for (int y = 0; y < 6; ++y)
      for (int x = 0; x < 7; ++x) {
        const uint32_t* texel = t.texels8 + index_of(t, x, y);
        EXPECT_EQ(int(texel[1] & 255), 10 * y + after(x, 7));
        EXPECT_EQ(int(texel[4] & 255), 10 * after(y, 6) + x);
        EXPECT_EQ(int(texel[5] & 255), 10 * after(y, 6) + after(x, 7));
      }
  }
}

TEST(Textures, MeanIsThatOfLinearTexels) {
  TextureStore store;
  Bitmap b = numbered(6, 9, 3);
  store.add(bitmap_texture(b));
  store.add(bitmap_texture(b, true));
  double decoded = 0, raw = 0;
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 6; ++x) {
      decoded += decode_srgb((10 * y + x + 60) / 255.0) / 54;
      raw += (10 * y + x + 60) / 255.0 / 54;
    }
  EXPECT_NEAR(store.mean(0)[1], decoded, 1e-6);
  EXPECT_NEAR(store.mean(1)[1], raw, 1e-6);
  EXPECT_EQ(store.views()[1].srgb, 0);
}

TEST(Textures, WordsAndFloatsBecomeLinearFloats) {
  Bitmap words;
  words.width = 2, words.height = 1, words.channels = 1;
  words.type = Bitmap::Type::u16;
  words.srgb_encoded = true;
  words.channel_names = {"Y"};
  uint16_t codes[2] = {30000, 65535};
  words.bytes.resize(4);
  std::memcpy(words.bytes.data(), codes, 4);
  Bitmap floats = words;
  floats.type = Bitmap::Type::f32;
  floats.srgb_encoded = false;
  float values[2] = {0.25f, 7.5f};
  floats.bytes.resize(8);
  std::memcpy(floats.bytes.data(), values, 8);

  TextureStore store;
  store.add(bitmap_texture(words));
  store.add(bitmap_texture(words, true));
  store.add(bitmap_texture(floats));
  auto texel = [&](int texture, int x) { return store.views()[texture].texels + 4 * x; };
  EXPECT_EQ(store.views()[0].type, TextureType::bitmap_float);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(texel(0, 0)[c], decode_srgb(30000 / 65535.0), 1e-6);
    EXPECT_NEAR(texel(1, 0)[c], 30000 / 65535.0, 1e-6);
    EXPECT_EQ(texel(2, 0)[c], 0.25f);
    EXPECT_EQ(texel(2, 1)[c], 7.5f);
  }
  EXPECT_EQ(texel(2, 0)[3], 1);
}

TEST(Textures, OfOneBitmapShareTexels) {
  TextureStore store;
  TextureDesc desc = bitmap_texture(numbered(4, 4, 3));
  store.add(desc);
  desc.to_uv[0] = 5;
  store.add(desc);
  desc.raw = true;
  store.add(desc);
  EXPECT_EQ(store.views()[0].texels8, store.views()[1].texels8);
  EXPECT_EQ(store.views()[1].to_uv[0], 5);
  desc.wrap = WrapMode::clamp;
  store.add(desc);
  desc.wrap = WrapMode::mirror; // needs the same neighbours as clamp
  store.add(desc);
  EXPECT_EQ(store.views()[3].texels8, store.views()[4].texels8);
  EXPECT_NE(store.views()[2].texels8, store.views()[3].texels8);
  EXPECT_NE(store.views()[0].texels8, store.views()[2].texels8);
}

TEST(Textures, CheckerboardsMeanTheirParts) {
  TextureStore store;
  TextureDesc white;
  white.color[0] = {1, 0.5, 0};
  int child = store.add(white);
  TextureDesc board;
  board.type = TextureType::checkerboard;
  board.color[1] = {0.2, 0.2, 0.2};
  board.child[0] = child;
  int parent = store.add(board);
  EXPECT_NEAR(store.mean(parent)[0], 0.6, 1e-12);
  EXPECT_NEAR(store.mean(parent)[1], 0.35, 1e-12);
  board.child[0] = 7;
  EXPECT_THROW(store.add(board), Error);
  board.child[0] = parent;
  EXPECT_THROW(
      {
        for (int i = 0; i < 20; ++i)
          board.child[0] = board.child[1] = store.add(board);
      },
      Error);
}

TEST(Textures, RefuseDamagedBitmaps) {
  TextureStore store;
  TextureDesc none;
  none.type = TextureType::bitmap8;
  EXPECT_THROW(store.add(none), Error);
  Bitmap b = numbered(4, 4, 3);
  b.bytes.pop_back();
  EXPECT_THROW(store.add(bitmap_texture(b)), Error);
  b = numbered(4, 4, 3);
  b.channel_names = {"U", "V", "W"};
  EXPECT_THROW(store.add(bitmap_texture(b)), Error);
  TextureDesc infinite;
  infinite.to_uv[2] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(store.add(infinite), Error);
}

} // namespace
