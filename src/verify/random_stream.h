#pragma once

/// Reproducible uniform numbers for tests: a counter pushed through a 64-bit mixer.

#include <cstdint>

namespace faceta {

class RandomStream {
public:
  /// Different seeds give unrelated streams, consecutive ones too.
  explicit RandomStream(uint64_t seed) : state_(mix(mix(seed + 0x243f6a8885a308d3ull))) {}

  /// 64 random bits (SplitMix64: Steele, Lea, Flood 2014, "Fast splittable pseudorandom number
  /// generators").
  uint64_t bits() { return mix(state_ += 0x9e3779b97f4a7c15ull); }
  /// In [0, 1), 53 bits.
  double next() { return double(bits() >> 11) * 0x1p-53; }
  /// In [0, 1), 24 bits: every value is a float.
  float next_float() { return float(bits() >> 40) * 0x1p-24f; }

private:
  static uint64_t mix(uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }

  uint64_t state_;
};

} // namespace faceta
