#pragma once

/// Textures in lanes. A texture is evaluated for the lanes that use it; groups of lanes are sorted
/// by material, so that a group meets few.

#include "render/kernels/rows.h"
#include "scene/view.h"
#include "spectrum/color.h"

namespace faceta {

/// sRGB's transfer curve (IEC 61966-2-1) from 11 / 255 on, by quartics in the lower half of a byte,
/// one for each upper half: sum of c[k][byte / 16] (byte mod 16)^k. Own minimax fits in the
/// relative error; 3e-7 with all roundings, and 1 for 255.
alignas(64) inline constexpr float kSrgbSegments[5][16] = {
    {0.000835192739f, 0.00518151792f, 0.0144438446f, 0.0295568351f, 0.0512694567f, 0.0802198201f,
     0.116970666f, 0.162029371f, 0.215860501f, 0.278894275f, 0.351532608f, 0.434153646f,
     0.527115107f, 0.630757153f, 0.745404184f, 0.871367097f},
    {0.000142111152f, 0.000414171285f, 0.000753180415f, 0.00114367332f, 0.00157701573f,
     0.00204762071f, 0.0025515072f, 0.00308566145f, 0.00364770414f, 0.00423569838f, 0.004848029f,
     0.00548332417f, 0.00614040205f, 0.0068182284f, 0.00751589146f, 0.00823257957f},
    {7.2186599e-06f, 9.65915206e-06f, 1.14564973e-05f, 1.2907889e-05f, 1.41485534e-05f,
     1.524443e-05f, 1.62333436e-05f, 1.7139284e-05f, 1.79785657e-05f, 1.87628521e-05f,
     1.95008179e-05f, 2.01991079e-05f, 2.08629481e-05f, 2.14965276e-05f, 2.2103266e-05f,
     2.26860011e-05f},
    {5.88864033e-08f, 4.22130277e-08f, 3.29275629e-08f, 2.76171495e-08f, 2.41022597e-08f,
     2.15694467e-08f, 1.96395344e-08f, 1.81097413e-08f, 1.68608523e-08f, 1.58177382e-08f,
     1.49304871e-08f, 1.41645078e-08f, 1.34949998e-08f, 1.29036684e-08f, 1.23766961e-08f,
     1.19034302e-08f},
    {-2.53760818e-10f, -1.53787275e-10f, -8.60094704e-11f, -5.63174438e-11f, -4.03320224e-11f,
     -3.06108645e-11f, -2.41991097e-11f, -1.97172868e-11f, -1.64446252e-11f, -1.39718194e-11f,
     -1.20514163e-11f, -1.05260496e-11f, -9.29145129e-12f, -8.27610463e-12f, -7.42954222e-12f,
     -6.71525249e-12f},
};
/// The linear value of a byte of sRGB.
template <class T> FACETA_INLINE T decode_srgb(const IntOf<T>& byte) {
  using I = IntOf<T>;
  T t = to_float(byte & I(15)), curve = polynomial(t, kSrgbSegments, byte >> 4);
  return select(byte < I(11), t * T(1 / (255 * 12.92)), curve);
}

/// The texture's own coordinates at uv.
template <class T> FACETA_INLINE Vec2<T> texture_place(const TextureView& t, const Vec2<T>& uv) {
  return {fma(T(t.to_uv[0]), uv.x, fma(T(t.to_uv[1]), uv.y, T(t.to_uv[2]))),
          fma(T(t.to_uv[3]), uv.x, fma(T(t.to_uv[4]), uv.y, T(t.to_uv[5])))};
}

/// Along one side of a bitmap: the texel at or before a point, as a number, and how far the point
/// lies on the way to the next.
template <class T> struct TexelStep {
  T texel, fraction;
};
template <class T>
FACETA_INLINE TexelStep<T> texel_step(const T& coordinate, int size, const TextureView& t) {
  T n = T(float(size)), last = T(float(size - 1));
  T s = coordinate;
  if (t.wrap == WrapMode::repeat)
    s = s - floor(s);
  if (t.wrap == WrapMode::mirror) {
    s = abs(s);
    s = fma(T(-2), floor(s * T(0.5f)), s);
    s = min(s, T(2) - s);
  }
  // What is infinite or no number ends up at texel 0: max() returns its second operand then.
  if (t.nearest)
    return {min(floor(max(s * n, T(0))), last), T(0)};
  T x = fma(s, n, T(-0.5f));
  if (t.wrap == WrapMode::repeat)
    x = max(select(x < T(0), x + n, x), T(0)); // up to n, which is texel n - 1 and a whole step
  else
    x = min(max(x, T(0)), last);
  T texel = min(floor(x), last);
  return {texel, x - texel};
}

/// Where in memory, in texels, the first of the 2 x 2 texels around a point lies, and the point's
/// place between them. Of those that are looked up `nearest` the first is the one.
template <class T> struct TexelPlace {
  IntOf<T> index;
  T fx, fy;
};
template <class T>
FACETA_INLINE TexelPlace<T> texel_place(const TextureView& t, const Vec2<T>& uv) {
  using I = IntOf<T>;
  Vec2<T> st = texture_place(t, uv);
  TexelStep<T> x = texel_step(st.x, t.width, t), y = texel_step(st.y, t.height, t);
  // Divided by three: up to 2^16 texels a side the product's error is far from the sixth.
  auto tile = [](const T& texel) {
    return floor(fma(texel, T(1.0f / kTileStep), T(0.5f / kTileStep)));
  };
  T tx = tile(x.texel), ty = tile(y.texel);
  T inside = fma(T(float(kTileSide)), fma(T(-float(kTileStep)), ty, y.texel),
                 fma(T(-float(kTileStep)), tx, x.texel));
  I first = (to_int(ty) * I(t.tiles_x) + to_int(tx)) * I(kTileTexels);
  return {first + to_int(inside), x.fraction, y.fraction};
}

/// The linear colour of texels R | G << 8 | B << 16.
template <class T> FACETA_INLINE Color<T> decode_bytes(const IntOf<T>& texel, bool srgb) {
  using I = IntOf<T>;
  I r = texel & I(255), g = (texel >> 8) & I(255), b = (texel >> 16) & I(255);
  if (srgb)
    return Color<T>(decode_srgb<T>(r), decode_srgb<T>(g), decode_srgb<T>(b));
  T scale = T(1.0f / 255.0f);
  return Color<T>(to_float(r) * scale, to_float(g) * scale, to_float(b) * scale);
}

/// Two texels side by side.
template <class T> struct TexelPair {
  Color<T> first, second;
};
/// The texel `after` those at the indices, and the next.
template <class T>
FACETA_INLINE TexelPair<T> fetch_texels(const TextureView& t, const IntOf<T>& index, int after) {
  if (t.type == TextureType::bitmap8) {
    const float* words = reinterpret_cast<const float*>(t.texels8 + after);
    Neighbours<T> texels = gather_pair<T>(words, index);
    return {decode_bytes<T>(as_integer(texels.first), t.srgb),
            decode_bytes<T>(as_integer(texels.second), t.srgb)};
  }
  T a[4], b[4];
  load_quads<T>(t.texels + 4 * after, index, a);
  load_quads<T>(t.texels + 4 * after + 4, index, b);
  return {Color<T>(a[0], a[1], a[2]), Color<T>(b[0], b[1], b[2])};
}

template <class T> FACETA_INLINE Color<T> bitmap_texture(const TextureView& t, const Vec2<T>& uv) {
  TexelPlace<T> place = texel_place(t, uv);
  TexelPair<T> upper = fetch_texels<T>(t, place.index, 0);
  if (t.nearest)
    return upper.first;
  TexelPair<T> lower = fetch_texels<T>(t, place.index, kTileSide);
  Color<T> r;
  for (int c = 0; c < 3; ++c)
    r[c] = lerp(lerp(upper.first[c], upper.second[c], place.fx),
                lerp(lower.first[c], lower.second[c], place.fx), place.fy);
  return r;
}

/// One texture at uv, for all lanes.
template <class T>
Color<T> evaluate_texture(const TextureView* textures, int id, const Vec2<T>& uv) {
  const TextureView& t = textures[id];
  if (t.type == TextureType::constant)
    return Color<T>(T(t.color[0][0]), T(t.color[0][1]), T(t.color[0][2]));
  if (t.type != TextureType::checkerboard)
    return bitmap_texture<T>(t, uv);
  Vec2<T> st = texture_place(t, uv);
  auto right = st.x - floor(st.x) > T(0.5f), upper = st.y - floor(st.y) > T(0.5f);
  Color<T> side[2];
  for (int k = 0; k < 2; ++k)
    side[k] = t.child[k] >= 0 ? evaluate_texture<T>(textures, t.child[k], uv)
                              : Color<T>(T(t.color[k][0]), T(t.color[k][1]), T(t.color[k][2]));
  return select(right ^ upper, side[1], side[0]);
}

/// Calls visit(id, mask) for each distinct id >= 0 among the active lanes.
template <class I, class M, class Visit>
FACETA_INLINE void for_each_texture(const I& ids, M active, const Visit& visit) {
  auto remaining = active & (ids >= I(0));
  while (any(remaining)) {
    int id = lane(ids, __builtin_ctz(mask_bits(remaining)));
    auto mine = remaining & (ids == I(id));
    visit(id, mine);
    remaining = remaining & !mine;
  }
}

/// Each lane's own texture (id < 0: white).
template <class T> Color<T> evaluate_textures(const TextureView* textures, const IntOf<T>& ids,
                                              const Vec2<T>& uv, MaskOf<T> active) {
  Color<T> result(T(1));
  for_each_texture(ids, active, [&](int id, MaskOf<T> mine) {
    result = select(mine, evaluate_texture<T>(textures, id, uv), result);
  });
  return result;
}

/// Fetches ahead the texels of texture `id` (below 0: none) that the active lanes will read.
template <class T>
void prefetch_texture(const TextureView* textures, int id, const Vec2<T>& uv, MaskOf<T> active) {
  if (id < 0)
    return;
  const TextureView& t = textures[id];
  if (t.type != TextureType::bitmap8 && t.type != TextureType::bitmap_float)
    return;
  constexpr int kWidth = kWidthOf<T>;
  alignas(64) int32_t first[kWidth];
  store(first, texel_place(t, uv).index);
  for (uint32_t bits = mask_bits(active); bits; bits &= bits - 1) {
    int i = __builtin_ctz(bits);
    if (t.type == TextureType::bitmap8) {
      prefetch_once(t.texels8 + first[i]);
    } else {
      prefetch_once(t.texels + 4 * size_t(first[i]));
      prefetch_once(t.texels + 4 * size_t(first[i] + kTileSide));
    }
  }
}

/// The same of each lane's own texture, for evaluate_textures().
template <class T> void prefetch_textures(const TextureView* textures, const IntOf<T>& ids,
                                          const Vec2<T>& uv, MaskOf<T> active) {
  for_each_texture(ids, active,
                   [&](int id, MaskOf<T> mine) { prefetch_texture<T>(textures, id, uv, mine); });
}

/// Luminance of linear sRGB (ITU-R BT.709).
template <class T> FACETA_INLINE T luminance(const Color<T>& c) {
  return fma(T(0.212671f), c[0], fma(T(0.715160f), c[1], T(0.072169f) * c[2]));
}

} // namespace faceta
