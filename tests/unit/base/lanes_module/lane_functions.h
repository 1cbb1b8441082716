#pragma once

/// Every function of the number types as a loop over arrays: compiled once per instruction set into
/// a small module, and once for float into the test that compares them bit for bit.

#include "base/maths.h"

#include <cstdint>
#include <initializer_list>

namespace faceta::test {

/// One function of up to three numbers; out has the size of the inputs, a multiple of 16.
struct LaneFunction {
  const char* name;
  void (*run)(const float* a, const float* b, const float* c, float* out, int n);
};

/// What is defined per register and not per number.
struct LaneTable {
  int width;
  int count;
  const LaneFunction* functions;
  /// For each group of `width` numbers, of the mask a < b: any, all, none, count, bits, and bits as
  /// lane() tells them.
  void (*masks)(const float* a, const float* b, int32_t* out, int n);
  /// For each group the numbers a of the lanes with a < b side by side; returns how many in all.
  int (*compress)(const float* a, const float* b, float* out, int32_t* int_out, int n);
  /// gather, gather_int, load_int, iota, first_lanes (for 0 .. width), lane: see lanes_test.cpp.
  void (*memory)(const float* values, const int32_t* indices, float* floats, int32_t* ints, int n);
  uint32_t (*first)(int n);
  /// gather_pair at the indices, first all of them, then those of the lanes with an odd index;
  /// returns how many pairs in all.
  int (*pairs)(const float* values, const int32_t* indices, float* out, int n);
};

template <class T> FACETA_INLINE T truth(const MaskOf<T>& m) {
  return select(m, T(1), T(0));
}
template <class T> FACETA_INLINE IntOf<T> bits_of(const T& a) {
  return float_bits(a);
}
template <class T> FACETA_INLINE T number(const IntOf<T>& i) {
  return bits_float(i);
}
template <class T> FACETA_INLINE T number_u(const UintOf<T>& i) {
  return bits_float(as_int(i));
}
/// An argument that to_int() accepts.
template <class T> FACETA_INLINE T small(const T& a) {
  return clamp(select(a == a, a, T(0)), T(-1e9f), T(1e9f));
}

// X(name, expression in a, b, c of type T; i, j are the bits of a and b, u, v the same unsigned).
#define FACETA_FOR_LANE_FUNCTIONS(X)                                                               \
  X(add, a + b)                                                                                    \
  X(subtract, a - b)                                                                               \
  X(multiply, a* b)                                                                                \
  X(divide, a / b)                                                                                 \
  X(negate, -a)                                                                                    \
  X(add_assign, (a += b, a))                                                                       \
  X(subtract_assign, (a -= b, a))                                                                  \
  X(multiply_assign, (a *= b, a))                                                                  \
  X(divide_assign, (a /= b, a))                                                                    \
  X(less, truth<T>(a < b))                                                                         \
  X(greater, truth<T>(a > b))                                                                      \
  X(less_equal, truth<T>(a <= b))                                                                  \
  X(greater_equal, truth<T>(a >= b))                                                               \
  X(equal, truth<T>(a == b))                                                                       \
  X(not_equal, truth<T>(a != b))                                                                   \
  X(mask_and, truth<T>((a < b) & (b < c)))                                                         \
  X(mask_or, truth<T>((a < b) | (b < c)))                                                          \
  X(mask_xor, truth<T>(MaskOf<T>((a < b) ^ (b < c))))                                              \
  X(mask_not, truth<T>(!(a < b)))                                                                  \
  X(mask_and_assign, (m &= b < c, truth<T>(m)))                                                    \
  X(mask_or_assign, (m |= b < c, truth<T>(m)))                                                     \
  X(mask_of_bool, truth<T>(MaskOf<T>(true)) + truth<T>(MaskOf<T>(false)))                          \
  X(select_float, select(a < b, b, c))                                                             \
  X(select_int, number<T>(select(a < b, i, j)))                                                    \
  X(select_uint, number_u<T>(select(a < b, u, v)))                                                 \
  X(select_mask, truth<T>(select(a < b, b < c, a < c)))                                            \
  X(min_float, min(a, b))                                                                          \
  X(max_float, max(a, b))                                                                          \
  X(min_int, number<T>(min(i, j)))                                                                 \
  X(max_int, number<T>(max(i, j)))                                                                 \
  X(fma_float, fma(a, b, c))                                                                       \
  X(sqrt_float, sqrt(a))                                                                           \
  X(abs_float, abs(a))                                                                             \
  X(floor_float, floor(a))                                                                         \
  X(copysign_float, copysign(a, b))                                                                \
  X(is_finite_float, truth<T>(is_finite(a)))                                                       \
  X(int_add, number<T>(IntOf<T>(as_int(u + v))))                                                   \
  X(int_add_assign, (k += IntOf<T>(7), number<T>(k)))                                              \
  X(int_subtract, number<T>((i >> 2) - (j >> 2)))                                                  \
  X(int_multiply, number<T>((i >> 17) * (j >> 17)))                                                \
  X(int_negate, number<T>(-(i >> 1)))                                                              \
  X(int_less, truth<T>(i < j))                                                                     \
  X(int_greater, truth<T>(i > j))                                                                  \
  X(int_less_equal, truth<T>(i <= j))                                                              \
  X(int_greater_equal, truth<T>(i >= j))                                                           \
  X(int_equal, truth<T>(i == j))                                                                   \
  X(int_not_equal, truth<T>(i != j))                                                               \
  X(int_and, number<T>(i & j))                                                                     \
  X(int_or, number<T>(i | j))                                                                      \
  X(int_xor, number<T>(i ^ j))                                                                     \
  X(int_not, number<T>(~i))                                                                        \
  X(int_shift_left, number<T>((i & IntOf<T>(0xffff)) << 7))                                        \
  X(int_shift_right, number<T>(i >> 7))                                                            \
  X(uint_add, number_u<T>(u + v))                                                                  \
  X(uint_subtract, number_u<T>(u - v))                                                             \
  X(uint_multiply, number_u<T>(u * v))                                                             \
  X(uint_less, truth<T>(u < v))                                                                    \
  X(uint_greater, truth<T>(u > v))                                                                 \
  X(uint_and_or_xor, number_u<T>(((u & v) | (u ^ ~v)) ^ UintOf<T>(0x9e3779b9u)))                   \
  X(uint_assign, (w ^= v, w &= UintOf<T>(0x7fffffffu), w |= UintOf<T>(5u), number_u<T>(w)))        \
  X(uint_shift_left, number_u<T>(u << 7))                                                          \
  X(uint_shift_right, number_u<T>(u >> 7))                                                         \
  X(to_int_float, number<T>(to_int(small(a))))                                                     \
  X(to_float_int, to_float(i))                                                                     \
  X(from_int_float, from_int<T>(-12345) * a)                                                       \
  X(sqr_float, sqr(a))                                                                             \
  X(clamp_float, clamp(a, b, c))                                                                   \
  X(clamp01_float, clamp01(a))                                                                     \
  X(safe_sqrt_float, safe_sqrt(a))                                                                 \
  X(lerp_float, lerp(a, b, c))                                                                     \
  X(power_of_two_float, power_of_two<T>(to_int(clamp(small(a), T(-126), T(127)))))                 \
  X(exp_float, exp(a))                                                                             \
  X(log_float, log(a))                                                                             \
  X(pow_float, pow(abs(a), b))                                                                     \
  X(sin_float, sin(clamp(small(a), T(-1e4f), T(1e4f))))                                            \
  X(cos_float, cos(clamp(small(a), T(-1e4f), T(1e4f))))                                            \
  X(tan_float, tan(clamp(small(a), T(-1e4f), T(1e4f))))                                            \
  X(sincos_float, sincos(clamp(small(a), T(-7), T(7))).sin* b + sincos(small(c) * T(1e-8f)).cos)   \
  X(atan2_float, atan2(a, b))                                                                      \
  X(asin_float, asin(a))                                                                           \
  X(acos_float, acos(a))                                                                           \
  X(erf_float, erf(a))                                                                             \
  X(erfinv_float, erfinv(clamp(a, T(-kOneMinusEpsilon), T(kOneMinusEpsilon))))

template <class T> struct LaneLoops {
#define FACETA_LANE_LOOP(name, expression)                                                         \
  static void name(const float* pa, const float* pb, const float* pc, float* out, int n) {         \
    for (int at = 0; at < n; at += kWidthOf<T>) {                                                  \
      T a = load<T>(pa + at), b = load<T>(pb + at), c = load<T>(pc + at);                          \
      IntOf<T> i = bits_of(a), j = bits_of(b), k = i >> 3;                                         \
      UintOf<T> u = as_uint(i), v = as_uint(j), w = u;                                             \
      MaskOf<T> m = a < b;                                                                         \
      (void)c, (void)k, (void)v, (void)w, (void)m;                                                 \
      T result = expression;                                                                       \
      store(out + at, result);                                                                     \
    }                                                                                              \
  }
  FACETA_FOR_LANE_FUNCTIONS(FACETA_LANE_LOOP)
#undef FACETA_LANE_LOOP

  static void masks(const float* a, const float* b, int32_t* out, int n) {
    for (int at = 0; at < n; at += kWidthOf<T>) {
      MaskOf<T> m = load<T>(a + at) < load<T>(b + at);
      uint32_t by_lane = 0;
      for (int i = 0; i < kWidthOf<T>; ++i)
        by_lane |= uint32_t(lane(m, i)) << i;
      for (int32_t word : {int32_t(any(m)), int32_t(all(m)), int32_t(none(m)), int32_t(count(m)),
                           int32_t(mask_bits(m)), int32_t(by_lane)})
        *out++ = word;
    }
  }
  static int compress(const float* a, const float* b, float* out, int32_t* int_out, int n) {
    int written = 0;
    for (int at = 0; at < n; at += kWidthOf<T>) {
      T x = load<T>(a + at);
      MaskOf<T> m = x < load<T>(b + at);
      compress_store(out + written, x, m);
      compress_store(int_out + written, float_bits(x), m);
      written += count(m);
    }
    return written;
  }
  static void memory(const float* values, const int32_t* indices, float* floats, int32_t* ints,
                     int n) {
    for (int at = 0; at < n; at += kWidthOf<T>) {
      IntOf<T> index = load_int<T>(indices + at);
      store(floats + at, gather<T>(values, index));
      store(ints + at, gather_int<T>(indices, index) + iota<T>() + IntOf<T>(at));
      // lane() of the last lane must be what the arrays hold there.
      int last = kWidthOf<T> - 1;
      if (lane(load<T>(values + at), last) != values[at + last] ||
          lane(index, last) != indices[at + last])
        floats[at] = -1;
    }
  }
  static int pairs(const float* values, const int32_t* indices, float* out, int n) {
    int written = n;
    for (int at = 0; at < n; at += kWidthOf<T>) {
      IntOf<T> index = load_int<T>(indices + at);
      Neighbours<T> pair = gather_pair<T>(values, index);
      store_pairs(out + 2 * at, pair.first, pair.second);
      MaskOf<T> odd = (index & IntOf<T>(1)) != IntOf<T>(0);
      compress_store_pairs(out + 2 * written, pair.first, pair.second, odd);
      written += count(odd);
    }
    return written;
  }
  static uint32_t first(int n) { return mask_bits(first_lanes<T>(n)); }

  static const LaneTable& table() {
#define FACETA_LANE_ENTRY(name, expression) {#name, name},
    static const LaneFunction functions[] = {FACETA_FOR_LANE_FUNCTIONS(FACETA_LANE_ENTRY)};
#undef FACETA_LANE_ENTRY
    static const LaneTable result{kWidthOf<T>, int(sizeof functions / sizeof *functions),
                                  functions,   masks,
                                  compress,    memory,
                                  first,       pairs};
    return result;
  }
};

} // namespace faceta::test
