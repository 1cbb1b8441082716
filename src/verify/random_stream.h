#pragma once

/// Reproducible uniform numbers for tests: a counter pushed through a 64-bit mixer.

#include <cstdint>

namespace faceta {

class RandomStream {
public:
  explicit RandomStream(uint64_t seed)
      : state_(seed * 0x9e3779b97f4a7c15ull + 0x243f6a8885a308d3) {}

  /// 64 random bits (SplitMix64: Steele, Lea, Flood 2014, "Fast splittable pseudorandom number
  /// generators").
  uint64_t bits() {
    uint64_t z = state_ += 0x9e3779b97f4a7c15ull;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  /// In [0, 1), 53 bits.
  double next() { return double(bits() >> 11) * 0x1p-53; }
  /// In [0, 1), 24 bits: every value is a float.
  float next_float() { return float(bits() >> 40) * 0x1p-24f; }

private:
  uint64_t state_;
};

} // namespace faceta
