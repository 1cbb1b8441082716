#pragma once

/// Random numbers without state: a hash of (pixel, sample, dimension), either independent or an
/// Owen-scrambled Sobol sequence padded by pairs.

#include "base/vec.h"

namespace faceta {

/// A bijective mixing of 32 bits ("lowbias32" of Wellons' hash-prospector search).
template <class U> FACETA_INLINE U mix_bits(U x) {
  x ^= x >> 16;
  x *= U(0x7feb352du);
  x ^= x >> 15;
  x *= U(0x846ca68bu);
  x ^= x >> 16;
  return x;
}

/// The 32 bits in reverse (lanes have their own, by shuffles).
template <class U> FACETA_INLINE U reverse_bits(U x) {
  x = ((x >> 1) & U(0x55555555u)) | ((x & U(0x55555555u)) << 1);
  x = ((x >> 2) & U(0x33333333u)) | ((x & U(0x33333333u)) << 2);
  x = ((x >> 4) & U(0x0f0f0f0fu)) | ((x & U(0x0f0f0f0fu)) << 4);
  x = ((x >> 8) & U(0x00ff00ffu)) | ((x & U(0x00ff00ffu)) << 8);
  return (x >> 16) | (x << 16);
}

/// A random permutation in which each bit depends on the lower ones only: Owen scrambling of a
/// number whose lowest bit is its first binary digit (Laine and Karras 2011; constants of Vegdahl's
/// search, see Burley 2020, "Practical Hash-based Owen Scrambling", JCGT 9(4)).
template <class U> FACETA_INLINE U owen_scramble_reversed(U x, const U& seed) {
  x += seed;
  x ^= x * U(0x6c50b47cu);
  x ^= x * U(0xb82f1e52u);
  x ^= x * U(0xc7afe638u);
  x ^= x * U(0x8d22f6e6u);
  return x;
}

/// The digits of the second Sobol dimension, lowest bit first, from those of the index: the Pascal
/// matrix modulo 2, whose entry (r, c) is odd exactly if the bits of r are among those of c
/// (Lucas).
template <class U> FACETA_INLINE U sobol_second_reversed(U x) {
  x ^= (x >> 1) & U(0x55555555u);
  x ^= (x >> 2) & U(0x33333333u);
  x ^= (x >> 4) & U(0x0f0f0f0fu);
  x ^= (x >> 8) & U(0x00ff00ffu);
  x ^= (x >> 16) & U(0x0000ffffu);
  return x;
}

/// The upper 24 bits as a number in [0, 1).
template <class T> FACETA_INLINE T unit_float(const UintOf<T>& bits) {
  return to_float(as_int(bits >> 8)) * T(0x1p-24f);
}

/// The number stream of one path in each lane.
template <class T> struct SampleStream {
  using U = UintOf<T>;
  U pixel_seed; ///< hash of pixel and seed
  U sample;
  bool sobol;

  FACETA_INLINE SampleStream(const U& pixel, const U& sample_index, uint32_t seed, bool use_sobol)
      : pixel_seed(mix_bits(pixel ^ U(seed * 0x9e3779b9u + 0x7f4a7c15u))), sample(sample_index),
        sobol(use_sobol) {}

  /// Pair number `pair`: two numbers in [0, 1), stratified together over the samples of a pixel.
  FACETA_INLINE Vec2<T> pair(const U& number) const {
    U key = mix_bits(pixel_seed + number * U(0x9e3779b1u));
    if (!sobol) {
      U a = mix_bits(key ^ (sample * U(0x85ebca6bu)));
      U b = mix_bits(a + U(0x6a09e667u));
      return {unit_float<T>(a), unit_float<T>(b)};
    }
    // An Owen shuffle of the index decorrelates the pairs; blocks of 2^k samples stay nets.
    U index = reverse_bits(owen_scramble_reversed(reverse_bits(sample), key));
    U x = owen_scramble_reversed(index, key * U(0xc2b2ae35u) + U(0x27d4eb2fu));
    U y =
        owen_scramble_reversed(sobol_second_reversed(index), key * U(0x165667b1u) + U(0x9e3779b9u));
    return {unit_float<T>(reverse_bits(x)), unit_float<T>(reverse_bits(y))};
  }
};

} // namespace faceta
