#pragma once

/// Half precision (IEEE 754 binary16) as a way to store numbers.

#include <bit>
#include <cstdint>

namespace faceta {

/// The half nearest to x (ties to even), as bits. |x| must be below 65520.
inline uint16_t half_bits(float x) {
  uint32_t bits = std::bit_cast<uint32_t>(x), sign = bits >> 16 & 0x8000;
  bits &= 0x7fffffff;
  if (bits < 0x38800000) { // below 2^-14: whole multiples of 2^-24, rounded by an addition
    float magic = 0.5f, sum = std::bit_cast<float>(bits) + magic;
    return static_cast<uint16_t>(sign | (std::bit_cast<uint32_t>(sum) - 0x3f000000));
  }
  bits += 0xfff + (bits >> 13 & 1);
  return static_cast<uint16_t>(sign | (bits - 0x38000000) >> 13);
}

/// The value of half bits (no infinity, no NaN).
inline float half_value(uint16_t half) {
  uint32_t bits = uint32_t(half & 0x8000) << 16 | uint32_t(half & 0x7fff) << 13;
  return std::bit_cast<float>(bits) * 0x1p112f;
}

} // namespace faceta
