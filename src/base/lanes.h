#pragma once

/// A whole SIMD register as a number: Lanes (float), LaneInt, LaneUint and LaneMask over Highway,
/// fixed at compile time (one set of translation units per instruction set; see
/// cmake/Modules.cmake). Only base/number.h includes this.

#define HWY_COMPILE_ONLY_STATIC
#include <hwy/highway.h>
#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace faceta {
namespace hn = hwy::HWY_NAMESPACE;

using LaneTag = hn::ScalableTag<float>;
using LaneIntTag = hn::ScalableTag<int32_t>;
using LaneUintTag = hn::ScalableTag<uint32_t>;
// -march without -maes -mpclmul makes Highway fall back to four lanes in silence.
static_assert(hn::MaxLanes(LaneTag()) == FACETA_LANE_WIDTH, "unexpected vector width");

template <class A>
concept Arithmetic = std::is_arithmetic_v<A>;

struct LaneMask {
  hn::Mask<LaneTag> m;
  LaneMask() = default;
  FACETA_INLINE LaneMask(hn::Mask<LaneTag> mask) : m(mask) {}
  FACETA_INLINE LaneMask(bool b)
      : m(hn::RebindMask(LaneTag(),
                         hn::Ne(hn::Set(LaneIntTag(), b ? 1 : 0), hn::Zero(LaneIntTag())))) {}
  friend FACETA_INLINE LaneMask operator&(LaneMask a, LaneMask b) { return hn::And(a.m, b.m); }
  friend FACETA_INLINE LaneMask operator|(LaneMask a, LaneMask b) { return hn::Or(a.m, b.m); }
  friend FACETA_INLINE LaneMask operator^(LaneMask a, LaneMask b) { return hn::Xor(a.m, b.m); }
  friend FACETA_INLINE LaneMask operator!(LaneMask a) { return hn::Not(a.m); }
  FACETA_INLINE LaneMask& operator&=(LaneMask b) { return *this = *this & b; }
  FACETA_INLINE LaneMask& operator|=(LaneMask b) { return *this = *this | b; }
};

#define FACETA_LANE_ARITHMETIC(Type, Tag)                                                          \
  friend FACETA_INLINE Type operator+(Type a, Type b) {                                            \
    return hn::Add(a.v, b.v);                                                                      \
  }                                                                                                \
  friend FACETA_INLINE Type operator-(Type a, Type b) {                                            \
    return hn::Sub(a.v, b.v);                                                                      \
  }                                                                                                \
  friend FACETA_INLINE Type operator*(Type a, Type b) {                                            \
    return hn::Mul(a.v, b.v);                                                                      \
  }                                                                                                \
  FACETA_INLINE Type& operator+=(Type b) {                                                         \
    return *this = *this + b;                                                                      \
  }                                                                                                \
  FACETA_INLINE Type& operator-=(Type b) {                                                         \
    return *this = *this - b;                                                                      \
  }                                                                                                \
  FACETA_INLINE Type& operator*=(Type b) {                                                         \
    return *this = *this * b;                                                                      \
  }

// a != b is the opposite of a == b: Highway's Ne calls a NaN equal to everything.
#define FACETA_LANE_COMPARISONS(Type)                                                              \
  friend FACETA_INLINE LaneMask operator<(Type a, Type b) {                                        \
    return mask(hn::Lt(a.v, b.v));                                                                 \
  }                                                                                                \
  friend FACETA_INLINE LaneMask operator>(Type a, Type b) {                                        \
    return mask(hn::Gt(a.v, b.v));                                                                 \
  }                                                                                                \
  friend FACETA_INLINE LaneMask operator==(Type a, Type b) {                                       \
    return mask(hn::Eq(a.v, b.v));                                                                 \
  }                                                                                                \
  friend FACETA_INLINE LaneMask operator!=(Type a, Type b) {                                       \
    return !(a == b);                                                                              \
  }

#define FACETA_LANE_BITWISE(Type)                                                                  \
  friend FACETA_INLINE Type operator&(Type a, Type b) {                                            \
    return hn::And(a.v, b.v);                                                                      \
  }                                                                                                \
  friend FACETA_INLINE Type operator|(Type a, Type b) {                                            \
    return hn::Or(a.v, b.v);                                                                       \
  }                                                                                                \
  friend FACETA_INLINE Type operator^(Type a, Type b) {                                            \
    return hn::Xor(a.v, b.v);                                                                      \
  }                                                                                                \
  friend FACETA_INLINE Type operator~(Type a) {                                                    \
    return hn::Not(a.v);                                                                           \
  }                                                                                                \
  FACETA_INLINE Type& operator^=(Type b) {                                                         \
    return *this = *this ^ b;                                                                      \
  }                                                                                                \
  FACETA_INLINE Type& operator&=(Type b) {                                                         \
    return *this = *this & b;                                                                      \
  }                                                                                                \
  FACETA_INLINE Type& operator|=(Type b) {                                                         \
    return *this = *this | b;                                                                      \
  }

struct Lanes {
  using Vector = hn::Vec<LaneTag>;
  Vector v;
  Lanes() = default;
  FACETA_INLINE Lanes(Vector vector) : v(vector) {}
  template <Arithmetic A> FACETA_INLINE Lanes(A a) : v(hn::Set(LaneTag(), static_cast<float>(a))) {}
  static FACETA_INLINE LaneMask mask(hn::Mask<LaneTag> m) { return m; }
  FACETA_LANE_ARITHMETIC(Lanes, LaneTag)
  FACETA_LANE_COMPARISONS(Lanes)
  friend FACETA_INLINE LaneMask operator<=(Lanes a, Lanes b) { return hn::Le(a.v, b.v); }
  friend FACETA_INLINE LaneMask operator>=(Lanes a, Lanes b) { return hn::Ge(a.v, b.v); }
  friend FACETA_INLINE Lanes operator/(Lanes a, Lanes b) { return hn::Div(a.v, b.v); }
  friend FACETA_INLINE Lanes operator-(Lanes a) { return hn::Neg(a.v); }
  FACETA_INLINE Lanes& operator/=(Lanes b) { return *this = *this / b; }
};

struct LaneInt {
  using Vector = hn::Vec<LaneIntTag>;
  Vector v;
  LaneInt() = default;
  FACETA_INLINE LaneInt(Vector vector) : v(vector) {}
  FACETA_INLINE LaneInt(int32_t a) : v(hn::Set(LaneIntTag(), a)) {}
  static FACETA_INLINE LaneMask mask(hn::Mask<LaneIntTag> m) {
    return hn::RebindMask(LaneTag(), m);
  }
  FACETA_LANE_ARITHMETIC(LaneInt, LaneIntTag)
  FACETA_LANE_COMPARISONS(LaneInt)
  FACETA_LANE_BITWISE(LaneInt)
  friend FACETA_INLINE LaneMask operator<=(LaneInt a, LaneInt b) { return !(b < a); }
  friend FACETA_INLINE LaneMask operator>=(LaneInt a, LaneInt b) { return !(a < b); }
  friend FACETA_INLINE LaneInt operator-(LaneInt a) { return hn::Neg(a.v); }
  friend FACETA_INLINE LaneInt operator<<(LaneInt a, int bits) {
    return hn::ShiftLeftSame(a.v, bits);
  }
  friend FACETA_INLINE LaneInt operator>>(LaneInt a, int bits) {
    return hn::ShiftRightSame(a.v, bits);
  }
};

struct LaneUint {
  using Vector = hn::Vec<LaneUintTag>;
  Vector v;
  LaneUint() = default;
  FACETA_INLINE LaneUint(Vector vector) : v(vector) {}
  FACETA_INLINE LaneUint(uint32_t a) : v(hn::Set(LaneUintTag(), a)) {}
  static FACETA_INLINE LaneMask mask(hn::Mask<LaneUintTag> m) {
    return hn::RebindMask(LaneTag(), m);
  }
  FACETA_LANE_ARITHMETIC(LaneUint, LaneUintTag)
  FACETA_LANE_COMPARISONS(LaneUint)
  FACETA_LANE_BITWISE(LaneUint)
  friend FACETA_INLINE LaneUint operator<<(LaneUint a, int bits) {
    return hn::ShiftLeftSame(a.v, bits);
  }
  friend FACETA_INLINE LaneUint operator>>(LaneUint a, int bits) {
    return hn::ShiftRightSame(a.v, bits);
  }
};

#undef FACETA_LANE_ARITHMETIC
#undef FACETA_LANE_COMPARISONS
#undef FACETA_LANE_BITWISE

template <> struct NumberTraits<Lanes> {
  using Mask = LaneMask;
  using Int = LaneInt;
  using Uint = LaneUint;
  using Scalar = float;
  static constexpr int kWidth = FACETA_LANE_WIDTH;
};

FACETA_INLINE Lanes select(LaneMask m, Lanes a, Lanes b) {
  return hn::IfThenElse(m.m, a.v, b.v);
}
FACETA_INLINE LaneInt select(LaneMask m, LaneInt a, LaneInt b) {
  return hn::IfThenElse(hn::RebindMask(LaneIntTag(), m.m), a.v, b.v);
}
FACETA_INLINE LaneUint select(LaneMask m, LaneUint a, LaneUint b) {
  return hn::IfThenElse(hn::RebindMask(LaneUintTag(), m.m), a.v, b.v);
}
FACETA_INLINE LaneMask select(LaneMask m, LaneMask a, LaneMask b) {
  return (m & a) | ((!m) & b);
}

FACETA_INLINE bool any(LaneMask m) {
  return !hn::AllFalse(LaneTag(), m.m);
}
FACETA_INLINE bool all(LaneMask m) {
  return hn::AllTrue(LaneTag(), m.m);
}
FACETA_INLINE bool none(LaneMask m) {
  return hn::AllFalse(LaneTag(), m.m);
}
FACETA_INLINE int count(LaneMask m) {
  return static_cast<int>(hn::CountTrue(LaneTag(), m.m));
}
FACETA_INLINE uint32_t mask_bits(LaneMask m) {
#if FACETA_LANE_WIDTH == 16
  return m.m.raw;
#elif FACETA_LANE_WIDTH == 8
  return static_cast<uint32_t>(_mm256_movemask_ps(hn::VecFromMask(LaneTag(), m.m).raw));
#else
  alignas(16) uint8_t bits[8] = {};
  hn::StoreMaskBits(LaneTag(), m.m, bits);
  uint32_t word;
  std::memcpy(&word, bits, 4);
  return word;
#endif
}

#if FACETA_LANE_WIDTH == 16
FACETA_INLINE Lanes min(Lanes a, Lanes b) {
  return Lanes::Vector{_mm512_min_ps(a.v.raw, b.v.raw)};
}
FACETA_INLINE Lanes max(Lanes a, Lanes b) {
  return Lanes::Vector{_mm512_max_ps(a.v.raw, b.v.raw)};
}
#elif FACETA_LANE_WIDTH == 8
FACETA_INLINE Lanes min(Lanes a, Lanes b) {
  return Lanes::Vector{_mm256_min_ps(a.v.raw, b.v.raw)};
}
FACETA_INLINE Lanes max(Lanes a, Lanes b) {
  return Lanes::Vector{_mm256_max_ps(a.v.raw, b.v.raw)};
}
#else
FACETA_INLINE Lanes min(Lanes a, Lanes b) {
  return select(a < b, a, b);
}
FACETA_INLINE Lanes max(Lanes a, Lanes b) {
  return select(a > b, a, b);
}
#endif
FACETA_INLINE LaneInt min(LaneInt a, LaneInt b) {
  return hn::Min(a.v, b.v);
}
FACETA_INLINE LaneInt max(LaneInt a, LaneInt b) {
  return hn::Max(a.v, b.v);
}
FACETA_INLINE Lanes fma(Lanes a, Lanes b, Lanes c) {
  return hn::MulAdd(a.v, b.v, c.v);
}
FACETA_INLINE Lanes sqrt(Lanes a) {
  return hn::Sqrt(a.v);
}
FACETA_INLINE Lanes abs(Lanes a) {
  return hn::Abs(a.v);
}
FACETA_INLINE Lanes floor(Lanes a) {
  return hn::Floor(a.v);
}
FACETA_INLINE Lanes copysign(Lanes a, Lanes b) {
  return hn::CopySign(a.v, b.v);
}

template <> FACETA_INLINE Lanes from_int<Lanes>(int32_t i) {
  return Lanes(i);
}
FACETA_INLINE LaneInt to_int(Lanes a) {
  return hn::ConvertTo(LaneIntTag(), a.v);
}
FACETA_INLINE Lanes to_float(LaneInt a) {
  return hn::ConvertTo(LaneTag(), a.v);
}
FACETA_INLINE LaneInt float_bits(Lanes a) {
  return hn::BitCast(LaneIntTag(), a.v);
}
FACETA_INLINE Lanes bits_float(LaneInt a) {
  return hn::BitCast(LaneTag(), a.v);
}
FACETA_INLINE LaneUint as_uint(LaneInt a) {
  return hn::BitCast(LaneUintTag(), a.v);
}
FACETA_INLINE LaneInt as_int(LaneUint a) {
  return hn::BitCast(LaneIntTag(), a.v);
}
#if FACETA_LANE_WIDTH == 16
/// The 32 bits of each lane in reverse: bytes turned round, then nibbles by two tables.
FACETA_INLINE LaneUint reverse_bits(LaneUint a) {
  const __m512i turn =
      _mm512_broadcast_i32x4(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
  const __m512i nibbles =
      _mm512_broadcast_i32x4(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
  const __m512i high_nibbles = _mm512_slli_epi16(nibbles, 4), low = _mm512_set1_epi8(15);
  __m512i x = _mm512_shuffle_epi8(a.v.raw, turn);
  __m512i from_low = _mm512_shuffle_epi8(high_nibbles, _mm512_and_si512(x, low));
  x = _mm512_and_si512(_mm512_srli_epi16(x, 4), low);
  return LaneUint::Vector{_mm512_or_si512(from_low, _mm512_shuffle_epi8(nibbles, x))};
}
#elif FACETA_LANE_WIDTH == 8
/// The 32 bits of each lane in reverse: bytes turned round, then nibbles by two tables.
FACETA_INLINE LaneUint reverse_bits(LaneUint a) {
  const __m256i turn = _mm256_broadcastsi128_si256(
      _mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
  const __m256i nibbles = _mm256_broadcastsi128_si256(
      _mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
  const __m256i high_nibbles = _mm256_slli_epi16(nibbles, 4), low = _mm256_set1_epi8(15);
  __m256i x = _mm256_shuffle_epi8(a.v.raw, turn);
  __m256i from_low = _mm256_shuffle_epi8(high_nibbles, _mm256_and_si256(x, low));
  x = _mm256_and_si256(_mm256_srli_epi16(x, 4), low);
  return LaneUint::Vector{_mm256_or_si256(from_low, _mm256_shuffle_epi8(nibbles, x))};
}
#endif
FACETA_INLINE LaneMask is_finite(Lanes a) {
  return (float_bits(a) & LaneInt(0x7f800000)) != LaneInt(0x7f800000);
}

template <> struct Memory<Lanes> {
  static FACETA_INLINE Lanes load(const float* p) { return hn::LoadU(LaneTag(), p); }
  static FACETA_INLINE Lanes gather(const float* base, LaneInt index) {
    return hn::GatherIndex(LaneTag(), base, index.v);
  }
  // Loads and shuffles: gathers are slow on current CPUs.
  static FACETA_INLINE Neighbours<Lanes> gather_pair(const float* base, LaneInt index) {
#if FACETA_LANE_WIDTH >= 8
    alignas(64) int32_t at[FACETA_LANE_WIDTH];
    hn::Store(index.v, LaneIntTag(), at);
    asm("" : "+m"(at)); // indices are read back from memory: extracting them costs shuffles
    auto two = [&](int i) FACETA_INLINE_LAMBDA {
      auto at_pair = [&](int k) { return reinterpret_cast<const __m128i*>(base + at[k]); };
      return _mm_unpacklo_epi64(_mm_loadl_epi64(at_pair(i)), _mm_loadl_epi64(at_pair(i + 1)));
    };
#if FACETA_LANE_WIDTH == 16
    auto eight = [&](int i) FACETA_INLINE_LAMBDA { // lanes i, i + 1 and every fourth after them
      __m512i r = _mm512_castsi128_si512(two(i));
      r = _mm512_inserti32x4(r, two(i + 4), 1);
      r = _mm512_inserti32x4(r, two(i + 8), 2);
      return _mm512_castsi512_ps(_mm512_inserti32x4(r, two(i + 12), 3));
    };
    __m512 a = eight(0), b = eight(2);
    return {Lanes(Lanes::Vector{_mm512_shuffle_ps(a, b, 0x88)}),
            Lanes(Lanes::Vector{_mm512_shuffle_ps(a, b, 0xdd)})};
#else
    auto four = [&](int i) FACETA_INLINE_LAMBDA { // lanes i, i + 1, i + 4, i + 5
      return _mm256_castsi256_ps(
          _mm256_inserti128_si256(_mm256_castsi128_si256(two(i)), two(i + 4), 1));
    };
    __m256 a = four(0), b = four(2);
    return {Lanes(Lanes::Vector{_mm256_shuffle_ps(a, b, 0x88)}),
            Lanes(Lanes::Vector{_mm256_shuffle_ps(a, b, 0xdd)})};
#endif
#else
    return {gather(base, index), gather(base, index + LaneInt(1))};
#endif
  }
  // Permutations of registers, which take a fraction of a gather's time.
  static FACETA_INLINE Lanes entry16(const float* table, LaneInt index) {
#if FACETA_LANE_WIDTH == 16
    return Lanes::Vector{_mm512_permutexvar_ps(index.v.raw, _mm512_loadu_ps(table))};
#elif FACETA_LANE_WIDTH == 8
    __m256 bit3 = _mm256_castsi256_ps(_mm256_slli_epi32(index.v.raw, 28));
    return Lanes::Vector{
        _mm256_blendv_ps(_mm256_permutevar8x32_ps(_mm256_loadu_ps(table), index.v.raw),
                         _mm256_permutevar8x32_ps(_mm256_loadu_ps(table + 8), index.v.raw), bit3)};
#else
    return gather(table, index & LaneInt(15));
#endif
  }
  static FACETA_INLINE Lanes entry32(const float* table, LaneInt index) {
#if FACETA_LANE_WIDTH == 16
    return Lanes::Vector{
        _mm512_permutex2var_ps(_mm512_loadu_ps(table), index.v.raw, _mm512_loadu_ps(table + 16))};
#elif FACETA_LANE_WIDTH == 8
    __m256 bit4 = _mm256_castsi256_ps(_mm256_slli_epi32(index.v.raw, 27));
    return Lanes::Vector{
        _mm256_blendv_ps(entry16(table, index).v.raw, entry16(table + 16, index).v.raw, bit4)};
#else
    return gather(table, index & LaneInt(31));
#endif
  }
  static FACETA_INLINE LaneInt load_int(const int32_t* p) { return hn::LoadU(LaneIntTag(), p); }
  static FACETA_INLINE LaneInt gather_int(const int32_t* base, LaneInt index) {
    return hn::GatherIndex(LaneIntTag(), base, index.v);
  }
};
FACETA_INLINE void store(float* p, Lanes a) {
  hn::StoreU(a.v, LaneTag(), p);
}
FACETA_INLINE void store(int32_t* p, LaneInt a) {
  hn::StoreU(a.v, LaneIntTag(), p);
}
// A plain overlapping store: Highway's CompressStore uses masked stores, slow on AVX2.
FACETA_INLINE void compress_store(float* p, Lanes a, LaneMask m) {
  hn::StoreU(hn::Compress(a.v, m.m), LaneTag(), p);
}
FACETA_INLINE void compress_store(int32_t* p, LaneInt a, LaneMask m) {
  hn::StoreU(hn::Compress(a.v, hn::RebindMask(LaneIntTag(), m.m)), LaneIntTag(), p);
}
FACETA_INLINE void store_pairs(float* p, Lanes a, Lanes b) {
  hn::StoreInterleaved2(a.v, b.v, LaneTag(), p);
}
FACETA_INLINE void compress_store_pairs(float* p, Lanes a, Lanes b, LaneMask m) {
  hn::StoreInterleaved2(hn::Compress(a.v, m.m), hn::Compress(b.v, m.m), LaneTag(), p);
}
template <> FACETA_INLINE LaneInt iota<Lanes>() {
  return hn::Iota(LaneIntTag(), 0);
}
template <> FACETA_INLINE LaneMask first_lanes<Lanes>(int n) {
  return iota<Lanes>() < LaneInt(n);
}

FACETA_INLINE float lane(Lanes a, int i) {
  alignas(64) float values[FACETA_LANE_WIDTH];
  store(values, a);
  return values[i];
}
FACETA_INLINE int32_t lane(LaneInt a, int i) {
  alignas(64) int32_t values[FACETA_LANE_WIDTH];
  store(values, a);
  return values[i];
}
FACETA_INLINE bool lane(LaneMask m, int i) {
  return (mask_bits(m) >> i) & 1;
}

} // namespace faceta
