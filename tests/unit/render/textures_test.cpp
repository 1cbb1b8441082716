// Bitmaps looked up by the kernels of every instruction set, against bilinear interpolation in
// double precision.

#include "bsdf/columns.h"
#include "materials/builtin.h"
#include "render/job.h"
#include "scene/scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <random>

using namespace faceta;

namespace {

double decode_srgb(double c) { // IEC 61966-2-1
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// Random texels: bytes, or floats in [0, 1].
Bitmap random_bitmap(int width, int height, bool floats, bool srgb) {
  std::mt19937 random(width * 100 + height);
  Bitmap b;
  b.width = width, b.height = height, b.channels = 3;
  b.channel_names = {"R", "G", "B"};
  b.srgb_encoded = srgb;
  b.type = floats ? Bitmap::Type::f32 : Bitmap::Type::u8;
  for (int i = 0; i < width * height * 3; ++i) {
    if (floats) {
      float v = std::uniform_real_distribution<float>(0, 1)(random);
      uint8_t bytes[4];
      std::memcpy(bytes, &v, 4);
      b.bytes.insert(b.bytes.end(), bytes, bytes + 4);
    } else {
      b.bytes.push_back(static_cast<uint8_t>(random() & 255));
    }
  }
  return b;
}

double texel(const Bitmap& b, int x, int y, int c) {
  size_t i = (size_t(y) * b.width + x) * 3 + c;
  if (b.type == Bitmap::Type::f32) {
    float v;
    std::memcpy(&v, &b.bytes[4 * i], 4);
    return v;
  }
  double v = b.bytes[i] / 255.0;
  return b.srgb_encoded ? decode_srgb(v) : v;
}

int wrap(int64_t i, int size, WrapMode mode) {
  if (mode == WrapMode::clamp)
    return static_cast<int>(std::clamp<int64_t>(i, 0, size - 1));
  int64_t period = (i % size + size) % size;
  bool odd = ((i - period) / size) % 2 != 0;
  return static_cast<int>(mode == WrapMode::mirror && odd ? size - 1 - period : period);
}

double expected(const Bitmap& b, const TextureDesc& t, double u, double v, int c) {
  double x = u * b.width - (t.nearest ? 0 : 0.5), y = v * b.height - (t.nearest ? 0 : 0.5);
  auto ix = static_cast<int64_t>(std::floor(x)), iy = static_cast<int64_t>(std::floor(y));
  auto at = [&](int64_t i, int64_t j) {
    return texel(b, wrap(i, b.width, t.wrap), wrap(j, b.height, t.wrap), c);
  };
  if (t.nearest)
    return at(ix, iy);
  double fx = x - double(ix), fy = y - double(iy);
  return std::lerp(std::lerp(at(ix, iy), at(ix + 1, iy), fx),
                   std::lerp(at(ix, iy + 1), at(ix + 1, iy + 1), fx), fy);
}

/// The places to look up: borders, whole numbers, small and large ones, and random ones.
std::vector<float> coordinates(std::mt19937& random, int count) {
  std::vector<float> list = {0,      1,          -1,         2,      0.5f,   1e-9f,
                             -1e-9f, 0.9999999f, 1.0000001f, 3,      -0.25f, -1.75f,
                             7.3f,   100.4f,     -4096.7f,   1e-30f, -1e-30f};
  std::shuffle(list.begin(), list.end(), random);
  std::uniform_real_distribution<float> near(-0.2f, 1.2f), far(-5, 5);
  while (int(list.size()) < count)
    list.push_back(list.size() % 4 ? near(random) : far(random));
  return list;
}

/// Reflectances of a diffuse surface with this texture at the columns' uv.
EvalColumns look_up(const TextureDesc& texture, const EvalColumns& where, Isa isa) {
  Scene scene;
  auto node = std::make_shared<MaterialNode>();
  node->parameters = std::make_shared<Parameters>(Registry::global().get("diffuse"));
  node->textures = {{"reflectance", scene.add_texture(texture)}};
  int material = scene.add_material(node);
  scene.build(isa);
  scene.use_sensor(CameraDesc{}, FilmDesc{});
  EvalColumns columns = where;
  EvalArrays arrays = columns.arrays();
  Registry::global().render_kernels(isa)->scatter(scene.view(), scene.view_root(material), 0,
                                                  &arrays, nullptr, columns.count);
  for (auto& channel : columns.value)
    for (float& v : channel)
      v *= kPi;
  return columns;
}

EvalColumns straight_down(const std::vector<float>& u, const std::vector<float>& v) {
  EvalColumns columns(static_cast<int>(u.size()));
  for (int i = 0; i < columns.count; ++i) {
    columns.wo[2][i] = columns.wi[2][i] = 1;
    columns.uv[0][i] = u[i];
    columns.uv[1][i] = v[i];
  }
  return columns;
}

bool near_border(double u, int size) {
  double x = u * size;
  return std::abs(x - std::round(x)) < 1e-3 + 2e-7 * std::abs(x);
}

void expect_lookups(int width, int height, bool floats, bool srgb, WrapMode mode, bool nearest) {
  SCOPED_TRACE(testing::Message() << width << " x " << height << (floats ? " floats" : " bytes")
                                  << ", wrap mode " << int(mode) << (nearest ? ", nearest" : ""));
  const Bitmap bitmap = random_bitmap(width, height, floats, srgb);
  TextureDesc t;
  t.type = TextureType::bitmap8;
  t.bitmap = std::make_shared<Bitmap>(bitmap);
  t.wrap = mode;
  t.nearest = nearest;
  std::mt19937 random(7);
  std::vector<float> u = coordinates(random, 600), v = coordinates(random, 600);
  const EvalColumns where = straight_down(u, v);
  EvalColumns first = look_up(t, where, Isa::scalar);
  for (Isa isa : {Isa::v3, Isa::v4})
    if (isa_supported(isa))
      EXPECT_EQ(look_up(t, where, isa).value, first.value);
  int compared = 0;
  for (int i = 0; i < first.count; ++i) {
    if (nearest && (near_border(u[i], width) || near_border(v[i], height)))
      continue;
    ++compared;
    // An ulp of a coordinate or of 1, in texels, between texels that differ by at most 1.
    double slack = 6e-8 * ((1 + std::abs(u[i])) * width + (1 + std::abs(v[i])) * height) + 2e-6;
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(first.value[c][i], expected(bitmap, t, u[i], v[i], c), slack)
          << "u " << u[i] << ", v " << v[i] << ", channel " << c;
  }
  EXPECT_GT(compared, 300);
}

} // namespace

TEST(TextureLookups, AreBilinearInEveryWrapMode) {
  const int sizes[][2] = {{1, 1}, {2, 1}, {1, 5}, {3, 3}, {4, 7}, {6, 9}, {37, 64}};
  for (auto [width, height] : sizes)
    for (WrapMode mode : {WrapMode::repeat, WrapMode::mirror, WrapMode::clamp})
      for (bool floats : {false, true})
        expect_lookups(width, height, floats, !floats, mode, false);
  expect_lookups(37, 64, false, false, WrapMode::repeat, false);
}

TEST(TextureLookups, TakeTheNearestTexel) {
  for (WrapMode mode : {WrapMode::repeat, WrapMode::mirror, WrapMode::clamp})
    for (bool floats : {false, true})
      expect_lookups(5, 8, floats, !floats, mode, true);
}

TEST(TextureLookups, OfNoNumbersGiveSomeTexel) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::nanf("");
  std::vector<float> u, v, special = {inf, -inf, nan, 1e30f, -1e30f, 3e38f, -3e38f, 0.3f};
  for (float a : special)
    for (float b : special) {
      u.push_back(a);
      v.push_back(b);
    }
  const Bitmap bitmap = random_bitmap(5, 4, false, false);
  for (WrapMode mode : {WrapMode::repeat, WrapMode::mirror, WrapMode::clamp})
    for (bool nearest : {false, true})
      for (Isa isa : {Isa::scalar, Isa::v3, Isa::v4}) {
        if (!isa_supported(isa))
          continue;
        TextureDesc t;
        t.type = TextureType::bitmap8;
        t.bitmap = std::make_shared<Bitmap>(bitmap);
        t.wrap = mode;
        t.nearest = nearest;
        const EvalColumns found = look_up(t, straight_down(u, v), isa);
        for (int i = 0; i < found.count; ++i)
          EXPECT_TRUE(found.value[0][i] >= 0 && found.value[0][i] <= 1.0001f)
              << u[i] << ", " << v[i] << ": " << found.value[0][i];
      }
}
