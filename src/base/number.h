#pragma once

/// The number types a formula can be written in, and the free functions they share.
///
/// A model is templated on its number type T: double (the reference), float (plain C++), Lanes (a
/// whole SIMD register, in the per-instruction-set modules) or ceres::Jet (derivatives, see
/// base/jet.h). Code branches on parameters only; what differs per lane goes through
/// select(mask, a, b). float and Lanes give the same bits: every operation here is either exact by
/// IEEE 754 (+ - * / sqrt fma) or defined bit by bit, and nothing is contracted behind our back.

#include "base/sanitizers.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

// Whole models in one function, as speed demands, take a quarter of an hour to compile with the
// checks of a sanitizer in it, and seconds as functions that call each other.
#ifdef FACETA_SANITIZED
#define FACETA_INLINE inline
#define FACETA_INLINE_LAMBDA
#define FACETA_FLATTEN
#else
#define FACETA_INLINE inline __attribute__((always_inline))
/// After the parameters of a lambda: its body goes where it is called.
#define FACETA_INLINE_LAMBDA __attribute__((always_inline))
/// All that a function calls is inlined into it: a model travels in registers only so.
#define FACETA_FLATTEN __attribute__((flatten))
#endif
#define FACETA_NOINLINE __attribute__((noinline))

namespace faceta {

/// The companions of a number type: its mask, its integers and how many values it holds.
template <class T> struct NumberTraits {
  using Mask = bool;
  using Int = int32_t;
  using Uint = uint32_t;
  using Scalar = T;
  static constexpr int kWidth = 1;
};

template <class T> using MaskOf = typename NumberTraits<T>::Mask;
template <class T> using IntOf = typename NumberTraits<T>::Int;
template <class T> using UintOf = typename NumberTraits<T>::Uint;
template <class T> inline constexpr int kWidthOf = NumberTraits<T>::kWidth;

// select: the only branch on a lane.
template <class T>
  requires std::is_scalar_v<T>
FACETA_INLINE T select(bool mask, const T& a, const T& b) {
  return mask ? a : b;
}
FACETA_INLINE float select(bool mask, float a, float b) {
  return mask ? a : b;
}
FACETA_INLINE double select(bool mask, double a, double b) {
  return mask ? a : b;
}
FACETA_INLINE int32_t select(bool mask, int32_t a, int32_t b) {
  return mask ? a : b;
}
FACETA_INLINE uint32_t select(bool mask, uint32_t a, uint32_t b) {
  return mask ? a : b;
}
FACETA_INLINE bool select(bool mask, bool a, bool b) {
  return mask ? a : b;
}
FACETA_INLINE bool any(bool mask) {
  return mask;
}
FACETA_INLINE bool all(bool mask) {
  return mask;
}
FACETA_INLINE bool none(bool mask) {
  return !mask;
}
FACETA_INLINE int count(bool mask) {
  return mask ? 1 : 0;
}
FACETA_INLINE uint32_t mask_bits(bool mask) {
  return mask ? 1u : 0u;
}

// min and max return the second operand if either is a NaN, as the SSE instructions do.
FACETA_INLINE float min(float a, float b) {
  return a < b ? a : b;
}
FACETA_INLINE float max(float a, float b) {
  return a > b ? a : b;
}
FACETA_INLINE double min(double a, double b) {
  return a < b ? a : b;
}
FACETA_INLINE double max(double a, double b) {
  return a > b ? a : b;
}
FACETA_INLINE int32_t min(int32_t a, int32_t b) {
  return a < b ? a : b;
}
FACETA_INLINE int32_t max(int32_t a, int32_t b) {
  return a > b ? a : b;
}

FACETA_INLINE float fma(float a, float b, float c) {
  return __builtin_fmaf(a, b, c);
}
FACETA_INLINE double fma(double a, double b, double c) {
  return __builtin_fma(a, b, c);
}
FACETA_INLINE float sqrt(float a) {
  return __builtin_sqrtf(a);
}
FACETA_INLINE double sqrt(double a) {
  return __builtin_sqrt(a);
}
FACETA_INLINE float abs(float a) {
  return __builtin_fabsf(a);
}
FACETA_INLINE double abs(double a) {
  return __builtin_fabs(a);
}
FACETA_INLINE float floor(float a) {
  return __builtin_floorf(a);
}
FACETA_INLINE double floor(double a) {
  return __builtin_floor(a);
}
FACETA_INLINE float copysign(float a, float b) {
  return __builtin_copysignf(a, b);
}
FACETA_INLINE double copysign(double a, double b) {
  return __builtin_copysign(a, b);
}

FACETA_INLINE bool is_finite(float a) {
  return (std::bit_cast<uint32_t>(a) & 0x7f800000u) != 0x7f800000u;
}
FACETA_INLINE bool is_finite(double a) {
  return std::isfinite(a);
}

// Conversions. to_int truncates; the argument must lie in the range of int32 (callers clamp).
template <class T> FACETA_INLINE T from_int(int32_t i) {
  return T(i);
}
FACETA_INLINE int32_t to_int(float a) {
  return static_cast<int32_t>(a);
}
FACETA_INLINE int32_t to_int(double a) {
  return static_cast<int32_t>(a);
}
FACETA_INLINE int32_t float_bits(float a) {
  return std::bit_cast<int32_t>(a);
}
FACETA_INLINE float bits_float(int32_t a) {
  return std::bit_cast<float>(a);
}
FACETA_INLINE uint32_t as_uint(int32_t a) {
  return static_cast<uint32_t>(a);
}
FACETA_INLINE int32_t as_int(uint32_t a) {
  return static_cast<int32_t>(a);
}
FACETA_INLINE float to_float(int32_t a) {
  return static_cast<float>(a);
}

/// Two neighbours in memory.
template <class T> struct Neighbours {
  T first, second;
};

// Memory. Lane arrays are float/int32 arrays of NumberTraits<T>::kWidth consecutive values.
template <class T> struct Memory {
  static T load(const float* p) { return T(*p); }
  static T gather(const float* base, int32_t index) { return T(base[index]); }
  static Neighbours<T> gather_pair(const float* base, int32_t index) {
    return {T(base[index]), T(base[index + 1])};
  }
  static T entry16(const float* table, int32_t index) { return T(table[index & 15]); }
  static T entry32(const float* table, int32_t index) { return T(table[index & 31]); }
  static int32_t load_int(const int32_t* p) { return *p; }
  static int32_t gather_int(const int32_t* base, int32_t index) { return base[index]; }
};
template <class T> FACETA_INLINE T load(const float* p) {
  return Memory<T>::load(p);
}
template <class T> FACETA_INLINE T gather(const float* base, IntOf<T> index) {
  return Memory<T>::gather(base, index);
}
/// base[index] and base[index + 1], for less than one gather costs.
template <class T> FACETA_INLINE Neighbours<T> gather_pair(const float* base, IntOf<T> index) {
  return Memory<T>::gather_pair(base, index);
}
/// table[index mod 16].
template <class T> FACETA_INLINE T entry16(const float* table, IntOf<T> index) {
  return Memory<T>::entry16(table, index);
}
/// table[index mod 32].
template <class T> FACETA_INLINE T entry32(const float* table, IntOf<T> index) {
  return Memory<T>::entry32(table, index);
}
template <class T> FACETA_INLINE IntOf<T> load_int(const int32_t* p) {
  return Memory<T>::load_int(p);
}
template <class T> FACETA_INLINE IntOf<T> gather_int(const int32_t* base, IntOf<T> index) {
  return Memory<T>::gather_int(base, index);
}
FACETA_INLINE void store(float* p, float a) {
  *p = a;
}
FACETA_INLINE void store(int32_t* p, int32_t a) {
  *p = a;
}
/// Writes the values whose mask is set side by side; may overwrite up to a full width after them.
FACETA_INLINE void compress_store(float* p, float a, bool) {
  *p = a;
}
FACETA_INLINE void compress_store(int32_t* p, int32_t a, bool) {
  *p = a;
}
/// Writes a and b of each lane side by side.
FACETA_INLINE void store_pairs(float* p, float a, float b) {
  p[0] = a;
  p[1] = b;
}
/// store_pairs() of the lanes whose mask is set; may overwrite up to two full widths after them.
FACETA_INLINE void compress_store_pairs(float* p, float a, float b, bool) {
  store_pairs(p, a, b);
}
/// 0, 1, 2, ... across the lanes.
template <class T> FACETA_INLINE IntOf<T> iota() {
  return IntOf<T>(0);
}
/// The mask of the first n lanes.
template <class T> FACETA_INLINE MaskOf<T> first_lanes(int n) {
  return MaskOf<T>(n > 0);
}
/// The value of one lane.
FACETA_INLINE float lane(float a, int) {
  return a;
}
FACETA_INLINE int32_t lane(int32_t a, int) {
  return a;
}
FACETA_INLINE bool lane(bool a, int) {
  return a;
}

} // namespace faceta

#if defined(FACETA_LANE_WIDTH) && FACETA_LANE_WIDTH > 1
#include "base/lanes.h"
#else
namespace faceta {
/// One lane: what the scalar module and the plain library run.
using Lanes = float;
} // namespace faceta
#endif
