#pragma once

/// Textures in lanes. A texture is evaluated for the lanes that use it; groups of lanes are sorted
/// by material, so that a group meets few.

#include "render/kernels/rows.h"
#include "scene/view.h"
#include "spectrum/color.h"

namespace faceta {

/// Decoding of sRGB bytes (IEC 61966-2-1), one table a module.
struct SrgbTable {
  float value[256];
  SrgbTable() {
    for (int i = 0; i < 256; ++i) {
      double c = i / 255.0;
      value[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
  }
};
inline const SrgbTable kSrgbTable;

/// Wraps a texel coordinate into [0, size).
template <class T> FACETA_INLINE IntOf<T> wrap_texel(const IntOf<T>& i, int size, WrapMode mode) {
  using I = IntOf<T>;
  I n(size);
  if (mode == WrapMode::clamp)
    return min(max(i, I(0)), I(size - 1));
  // The floor of i / size in float is exact enough: both are below 2^24 and one step mends the
  // rest.
  T quotient = floor((to_float(i) + T(0.5f)) * T(1.0f / float(size)));
  I period = to_int(quotient);
  I rest = i - period * n;
  rest = select(rest < I(0), rest + n, rest);
  rest = select(rest >= n, rest - n, rest);
  if (mode == WrapMode::mirror) {
    auto odd = (period & I(1)) != I(0);
    rest = select(odd, I(size - 1) - rest, rest);
  }
  return rest;
}

template <class T>
FACETA_INLINE Color<T> fetch_texel(const TextureView& t, const IntOf<T>& x, const IntOf<T>& y) {
  using I = IntOf<T>;
  I tile = (y >> 2) * I(t.tiles_x) + (x >> 2);
  I index = (tile << 4) + ((y & I(3)) << 2) + (x & I(3));
  if (t.type == TextureType::bitmap8) {
    I texel = gather_int<T>(reinterpret_cast<const int32_t*>(t.texels8), index);
    I r = texel & I(255), g = (texel >> 8) & I(255), b = (texel >> 16) & I(255);
    if (t.srgb)
      return Color<T>(gather<T>(kSrgbTable.value, r), gather<T>(kSrgbTable.value, g),
                      gather<T>(kSrgbTable.value, b));
    T scale = T(1.0f / 255.0f);
    return Color<T>(to_float(r) * scale, to_float(g) * scale, to_float(b) * scale);
  }
  I word = index << 2;
  return Color<T>(gather<T>(t.texels, word), gather<T>(t.texels + 1, word),
                  gather<T>(t.texels + 2, word));
}

template <class T> FACETA_INLINE Color<T> bitmap_texture(const TextureView& t, const Vec2<T>& st) {
  using I = IntOf<T>;
  // Beyond +-2^20 texels single precision has no fractions left.
  T limit = T(0x1p20f);
  T x = clamp(st.x * T(float(t.width)), -limit, limit);
  T y = clamp(st.y * T(float(t.height)), -limit, limit);
  if (t.nearest) {
    I ix = wrap_texel<T>(to_int(floor(x)), t.width, t.wrap);
    I iy = wrap_texel<T>(to_int(floor(y)), t.height, t.wrap);
    return fetch_texel<T>(t, ix, iy);
  }
  x = x - T(0.5f);
  y = y - T(0.5f);
  T wx = floor(x), wy = floor(y), fx = x - wx, fy = y - wy;
  I ix = to_int(wx), iy = to_int(wy);
  I x0 = wrap_texel<T>(ix, t.width, t.wrap), x1 = wrap_texel<T>(ix + I(1), t.width, t.wrap);
  I y0 = wrap_texel<T>(iy, t.height, t.wrap), y1 = wrap_texel<T>(iy + I(1), t.height, t.wrap);
  Color<T> c00 = fetch_texel<T>(t, x0, y0), c10 = fetch_texel<T>(t, x1, y0);
  Color<T> c01 = fetch_texel<T>(t, x0, y1), c11 = fetch_texel<T>(t, x1, y1);
  Color<T> r;
  for (int c = 0; c < 3; ++c)
    r[c] = lerp(lerp(c00[c], c10[c], fx), lerp(c01[c], c11[c], fx), fy);
  return r;
}

/// One texture at uv, for all lanes.
template <class T>
Color<T> evaluate_texture(const TextureView* textures, int id, const Vec2<T>& uv) {
  const TextureView& t = textures[id];
  if (t.type == TextureType::constant)
    return Color<T>(T(t.color[0][0]), T(t.color[0][1]), T(t.color[0][2]));
  Vec2<T> st{fma(T(t.to_uv[0]), uv.x, fma(T(t.to_uv[1]), uv.y, T(t.to_uv[2]))),
             fma(T(t.to_uv[3]), uv.x, fma(T(t.to_uv[4]), uv.y, T(t.to_uv[5])))};
  if (t.type != TextureType::checkerboard)
    return bitmap_texture<T>(t, st);
  auto right = st.x - floor(st.x) > T(0.5f), upper = st.y - floor(st.y) > T(0.5f);
  Color<T> side[2];
  for (int k = 0; k < 2; ++k)
    side[k] = t.child[k] >= 0 ? evaluate_texture<T>(textures, t.child[k], uv)
                              : Color<T>(T(t.color[k][0]), T(t.color[k][1]), T(t.color[k][2]));
  return select(right ^ upper, side[1], side[0]);
}

/// Each lane's own texture (id < 0: white), by a loop over the distinct ones among the active
/// lanes.
template <class T> Color<T> evaluate_textures(const TextureView* textures, const IntOf<T>& ids,
                                              const Vec2<T>& uv, MaskOf<T> active) {
  Color<T> result(T(1));
  auto remaining = active & (ids >= IntOf<T>(0));
  while (any(remaining)) {
    int id = lane(ids, __builtin_ctz(mask_bits(remaining)));
    auto mine = remaining & (ids == IntOf<T>(id));
    result = select(mine, evaluate_texture<T>(textures, id, uv), result);
    remaining = remaining & !mine;
  }
  return result;
}

/// Luminance of linear sRGB (ITU-R BT.709).
template <class T> FACETA_INLINE T luminance(const Color<T>& c) {
  return fma(T(0.212671f), c[0], fma(T(0.715160f), c[1], T(0.072169f) * c[2]));
}

} // namespace faceta
