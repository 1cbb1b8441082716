#pragma once

/// Fetching records by index: W rows of 16 words, transposed into 16 lanes values. Loads and
/// shuffles instead of 16 gathers, which cost 20 cycles and more each on current CPUs.

#include "base/number.h"

namespace faceta {

/// out[k] lane i = row(index[i])[k] for 16 words; rows are 64-byte aligned and `stride` words
/// apart.
template <class T>
FACETA_INLINE void load_rows(const float* base, int stride, const int32_t* index, T (&out)[16]) {
  for (int k = 0; k < 16; ++k)
    out[k] = T(base[int64_t(index[0]) * stride + k]);
}

/// Fetches ahead what is read once and soon: past the second-level cache, which Embree needs for
/// its nodes.
FACETA_INLINE void prefetch_once(const void* address) {
  __builtin_prefetch(address, 0, 0);
}

/// The same row in all lanes.
template <class T> FACETA_INLINE void spread_row(const float* row, T (&out)[16]) {
  for (int k = 0; k < 16; ++k)
    out[k] = T(row[k]);
}

/// Writes the rows of the lanes in `mask` one after the other; returns how many.
template <class T>
FACETA_INLINE int store_rows(float* out, MaskOf<T> mask, const T (&columns)[16]) {
  if (mask)
    for (int k = 0; k < 16; ++k)
      out[k] = columns[k];
  return mask ? 1 : 0;
}

/// out[k] lane i = base[4 index[i] + k]; below 2^31 words.
template <class T>
FACETA_INLINE void load_quads(const float* base, const IntOf<T>& index, T (&out)[4]) {
  const float* p = base + 4 * int64_t(index);
  for (int k = 0; k < 4; ++k)
    out[k] = T(p[k]);
}

/// out[k] lane i = base[8 index[i] + k]: rows of 32 bytes, on 32-byte lines; below 2^31 words.
template <class T>
FACETA_INLINE void load_octets(const float* base, const IntOf<T>& index, T (&out)[8]) {
  const float* p = base + 8 * int64_t(index);
  for (int k = 0; k < 8; ++k)
    out[k] = T(p[k]);
}

#if FACETA_LANE_WIDTH == 16
template <>
FACETA_INLINE void load_octets<Lanes>(const float* base, const LaneInt& index, Lanes (&out)[8]) {
  alignas(64) int32_t at[16];
  store(at, index << 3);
  auto row = [&](int i) { return _mm256_load_ps(base + at[i]); };
  // r[i]: rows i and 4 + i; r[4 + i]: rows 8 + i and 12 + i.
  __m512 r[8], t[8];
  for (int i = 0; i < 4; ++i) {
    r[i] = _mm512_insertf32x8(_mm512_castps256_ps512(row(i)), row(4 + i), 1);
    r[4 + i] = _mm512_insertf32x8(_mm512_castps256_ps512(row(8 + i)), row(12 + i), 1);
  }
  for (int i = 0; i < 4; ++i) {
    t[2 * i] = _mm512_unpacklo_ps(r[2 * i], r[2 * i + 1]);
    t[2 * i + 1] = _mm512_unpackhi_ps(r[2 * i], r[2 * i + 1]);
  }
  for (int i = 0; i < 2; ++i) {
    __m512d a = _mm512_castps_pd(t[4 * i]), b = _mm512_castps_pd(t[4 * i + 1]);
    __m512d c = _mm512_castps_pd(t[4 * i + 2]), d = _mm512_castps_pd(t[4 * i + 3]);
    r[4 * i] = _mm512_castpd_ps(_mm512_unpacklo_pd(a, c));
    r[4 * i + 1] = _mm512_castpd_ps(_mm512_unpackhi_pd(a, c));
    r[4 * i + 2] = _mm512_castpd_ps(_mm512_unpacklo_pd(b, d));
    r[4 * i + 3] = _mm512_castpd_ps(_mm512_unpackhi_pd(b, d));
  }
  for (int j = 0; j < 4; ++j) {
    out[j].v.raw = _mm512_shuffle_f32x4(r[j], r[4 + j], 0x88);
    out[4 + j].v.raw = _mm512_shuffle_f32x4(r[j], r[4 + j], 0xdd);
  }
}
template <>
FACETA_INLINE void load_quads<Lanes>(const float* base, const LaneInt& index, Lanes (&out)[4]) {
  alignas(64) int32_t at[16];
  store(at, index << 2);
  auto quad = [&](int i) { return _mm_loadu_ps(base + at[i]); };
  __m512 r[4]; // r[j]: lanes j, 4 + j, 8 + j, 12 + j
  for (int j = 0; j < 4; ++j) {
    r[j] = _mm512_castps128_ps512(quad(j));
    r[j] = _mm512_insertf32x4(r[j], quad(4 + j), 1);
    r[j] = _mm512_insertf32x4(r[j], quad(8 + j), 2);
    r[j] = _mm512_insertf32x4(r[j], quad(12 + j), 3);
  }
  __m512d a = _mm512_castps_pd(_mm512_unpacklo_ps(r[0], r[1]));
  __m512d b = _mm512_castps_pd(_mm512_unpackhi_ps(r[0], r[1]));
  __m512d c = _mm512_castps_pd(_mm512_unpacklo_ps(r[2], r[3]));
  __m512d d = _mm512_castps_pd(_mm512_unpackhi_ps(r[2], r[3]));
  out[0].v.raw = _mm512_castpd_ps(_mm512_unpacklo_pd(a, c));
  out[1].v.raw = _mm512_castpd_ps(_mm512_unpackhi_pd(a, c));
  out[2].v.raw = _mm512_castpd_ps(_mm512_unpacklo_pd(b, d));
  out[3].v.raw = _mm512_castpd_ps(_mm512_unpackhi_pd(b, d));
}

/// r becomes out with out[i] lane j = r[j] lane i.
FACETA_INLINE void transpose16(__m512 (&r)[16], __m512 (&out)[16]) {
  __m512 t[16];
  for (int i = 0; i < 8; ++i) {
    t[2 * i] = _mm512_unpacklo_ps(r[2 * i], r[2 * i + 1]);
    t[2 * i + 1] = _mm512_unpackhi_ps(r[2 * i], r[2 * i + 1]);
  }
  for (int i = 0; i < 4; ++i) {
    __m512d a = _mm512_castps_pd(t[4 * i]), b = _mm512_castps_pd(t[4 * i + 1]);
    __m512d c = _mm512_castps_pd(t[4 * i + 2]), d = _mm512_castps_pd(t[4 * i + 3]);
    r[4 * i] = _mm512_castpd_ps(_mm512_unpacklo_pd(a, c));
    r[4 * i + 1] = _mm512_castpd_ps(_mm512_unpackhi_pd(a, c));
    r[4 * i + 2] = _mm512_castpd_ps(_mm512_unpacklo_pd(b, d));
    r[4 * i + 3] = _mm512_castpd_ps(_mm512_unpackhi_pd(b, d));
  }
  // r[4g + j]: column 4q + j of rows 4g .. 4g+3 in the 128-bit quarter q.
  for (int j = 0; j < 4; ++j) {
    __m512 a = _mm512_shuffle_f32x4(r[j], r[4 + j], 0x88);
    __m512 b = _mm512_shuffle_f32x4(r[j], r[4 + j], 0xdd);
    __m512 c = _mm512_shuffle_f32x4(r[8 + j], r[12 + j], 0x88);
    __m512 d = _mm512_shuffle_f32x4(r[8 + j], r[12 + j], 0xdd);
    out[j] = _mm512_shuffle_f32x4(a, c, 0x88);
    out[4 + j] = _mm512_shuffle_f32x4(b, d, 0x88);
    out[8 + j] = _mm512_shuffle_f32x4(a, c, 0xdd);
    out[12 + j] = _mm512_shuffle_f32x4(b, d, 0xdd);
  }
}
template <> FACETA_INLINE void load_rows<Lanes>(const float* base, int stride, const int32_t* index,
                                                Lanes (&out)[16]) {
  __m512 r[16], t[16];
  for (int i = 0; i < 16; ++i)
    r[i] = _mm512_load_ps(base + int64_t(index[i]) * stride);
  transpose16(r, t);
  for (int i = 0; i < 16; ++i)
    out[i].v.raw = t[i];
}
template <>
FACETA_INLINE int store_rows<Lanes>(float* out, LaneMask mask, const Lanes (&columns)[16]) {
  __m512 r[16], t[16];
  for (int i = 0; i < 16; ++i)
    r[i] = columns[i].v.raw;
  transpose16(r, t);
  uint32_t bits = mask_bits(mask);
  int count = 0;
  for (int i = 0; i < 16; ++i) { // stores of skipped rows are overwritten by the next
    _mm512_store_ps(out + 16 * count, t[i]);
    count += (bits >> i) & 1;
  }
  return count;
}
#endif

#if FACETA_LANE_WIDTH == 1
/// Adds n colours to the RGBA pixels at `slots`, each its own, but for those with far below 0.
inline void add_unblocked(const float* const (&rgb)[3], const float* far, const int32_t* slots,
                          int n, float* pixels) {
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 3; ++k)
      pixels[4 * size_t(slots[i]) + k] += far[i] < 0 ? 0.0f : rgb[k][i];
}
#else
/// Adds n colours to the RGBA pixels at `slots`, each its own, but for those with far below 0.
inline void add_unblocked(const float* const (&rgb)[3], const float* far, const int32_t* slots,
                          int n, float* pixels) {
  for (int i = 0; i < n; i += 4) {
    // No branch: whether a light is seen is hard to predict.
    __m128 seen = _mm_cmpge_ps(_mm_loadu_ps(far + i), _mm_setzero_ps());
    __m128 rows[4];
    for (int k = 0; k < 3; ++k)
      rows[k] = _mm_and_ps(_mm_loadu_ps(rgb[k] + i), seen);
    rows[3] = _mm_setzero_ps();
    _MM_TRANSPOSE4_PS(rows[0], rows[1], rows[2], rows[3]);
    for (int k = 0; k < min(4, n - i); ++k) {
      float* pixel = pixels + 4 * size_t(slots[i + k]);
      _mm_store_ps(pixel, _mm_add_ps(_mm_load_ps(pixel), rows[k]));
    }
  }
}
#endif

#if FACETA_LANE_WIDTH >= 8
/// r becomes its own transpose.
FACETA_INLINE void transpose8(__m256 (&r)[8]) {
  __m256 t[8];
  for (int i = 0; i < 4; ++i) {
    t[2 * i] = _mm256_unpacklo_ps(r[2 * i], r[2 * i + 1]);
    t[2 * i + 1] = _mm256_unpackhi_ps(r[2 * i], r[2 * i + 1]);
  }
  for (int i = 0; i < 2; ++i) {
    __m256d a = _mm256_castps_pd(t[4 * i]), b = _mm256_castps_pd(t[4 * i + 1]);
    __m256d c = _mm256_castps_pd(t[4 * i + 2]), d = _mm256_castps_pd(t[4 * i + 3]);
    t[4 * i] = _mm256_castpd_ps(_mm256_unpacklo_pd(a, c));
    t[4 * i + 1] = _mm256_castpd_ps(_mm256_unpackhi_pd(a, c));
    t[4 * i + 2] = _mm256_castpd_ps(_mm256_unpacklo_pd(b, d));
    t[4 * i + 3] = _mm256_castpd_ps(_mm256_unpackhi_pd(b, d));
  }
  for (int j = 0; j < 4; ++j) {
    r[j] = _mm256_permute2f128_ps(t[j], t[4 + j], 0x20);
    r[4 + j] = _mm256_permute2f128_ps(t[j], t[4 + j], 0x31);
  }
}
#endif

#if FACETA_LANE_WIDTH == 8
template <>
FACETA_INLINE void load_octets<Lanes>(const float* base, const LaneInt& index, Lanes (&out)[8]) {
  alignas(32) int32_t at[8];
  store(at, index << 3);
  __m256 r[8];
  for (int i = 0; i < 8; ++i)
    r[i] = _mm256_load_ps(base + at[i]);
  transpose8(r);
  for (int i = 0; i < 8; ++i)
    out[i].v.raw = r[i];
}
template <>
FACETA_INLINE void load_quads<Lanes>(const float* base, const LaneInt& index, Lanes (&out)[4]) {
  alignas(32) int32_t at[8];
  store(at, index << 2);
  auto quad = [&](int i) { return _mm_loadu_ps(base + at[i]); };
  __m256 r[4]; // r[j]: lanes j, 4 + j
  for (int j = 0; j < 4; ++j)
    r[j] = _mm256_insertf128_ps(_mm256_castps128_ps256(quad(j)), quad(4 + j), 1);
  __m256d a = _mm256_castps_pd(_mm256_unpacklo_ps(r[0], r[1]));
  __m256d b = _mm256_castps_pd(_mm256_unpackhi_ps(r[0], r[1]));
  __m256d c = _mm256_castps_pd(_mm256_unpacklo_ps(r[2], r[3]));
  __m256d d = _mm256_castps_pd(_mm256_unpackhi_ps(r[2], r[3]));
  out[0].v.raw = _mm256_castpd_ps(_mm256_unpacklo_pd(a, c));
  out[1].v.raw = _mm256_castpd_ps(_mm256_unpackhi_pd(a, c));
  out[2].v.raw = _mm256_castpd_ps(_mm256_unpacklo_pd(b, d));
  out[3].v.raw = _mm256_castpd_ps(_mm256_unpackhi_pd(b, d));
}
template <> FACETA_INLINE void load_rows<Lanes>(const float* base, int stride, const int32_t* index,
                                                Lanes (&out)[16]) {
  for (int half = 0; half < 2; ++half) {
    __m256 r[8];
    for (int i = 0; i < 8; ++i)
      r[i] = _mm256_load_ps(base + int64_t(index[i]) * stride + 8 * half);
    transpose8(r);
    for (int i = 0; i < 8; ++i)
      out[8 * half + i].v.raw = r[i];
  }
}
template <>
FACETA_INLINE int store_rows<Lanes>(float* out, LaneMask mask, const Lanes (&columns)[16]) {
  __m256 r[2][8];
  for (int half = 0; half < 2; ++half) {
    for (int i = 0; i < 8; ++i)
      r[half][i] = columns[8 * half + i].v.raw;
    transpose8(r[half]);
  }
  uint32_t bits = mask_bits(mask);
  int count = 0;
  for (int i = 0; i < 8; ++i) { // stores of skipped rows are overwritten by the next
    _mm256_store_ps(out + 16 * count, r[0][i]);
    _mm256_store_ps(out + 16 * count + 8, r[1][i]);
    count += (bits >> i) & 1;
  }
  return count;
}
#endif

/// One word of the rows as integers.
template <class T> FACETA_INLINE IntOf<T> as_integer(const T& word) {
  return float_bits(word);
}

} // namespace faceta
