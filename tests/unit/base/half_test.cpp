// Half floats against their definition: sign, 5 bits of exponent, 10 of mantissa (IEEE 754).

#include "base/half.h"

#include <cmath>
#include <gtest/gtest.h>

namespace {

using namespace faceta;

double definition(int half) {
  int exponent = half >> 10 & 31, mantissa = half & 1023;
  double value =
      exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
  return half & 0x8000 ? -value : value;
}

TEST(Half, HoldsWhatItsBitsSay) {
  for (int half = 0; half < 0x10000; ++half) {
    if ((half >> 10 & 31) == 31)
      continue; // infinities and NaNs are not stored
    double value = definition(half);
    ASSERT_EQ(half_value(static_cast<uint16_t>(half)), value);
    ASSERT_EQ(half_bits(static_cast<float>(value)), half);
  }
}

TEST(Half, RoundsToTheNearestAndTiesToEven) {
  for (int half = 0; half + 1 < 0x7c00; ++half) {
    float low = half_value(static_cast<uint16_t>(half)),
          high = half_value(static_cast<uint16_t>(half + 1)), middle = (low + high) / 2;
    ASSERT_EQ(half_bits(middle), half + (half & 1)) << middle;
    ASSERT_EQ(half_bits(std::nextafter(middle, 0.0f)), half) << middle;
    ASSERT_EQ(half_bits(std::nextafter(middle, 1e9f)), half + 1) << middle;
    ASSERT_EQ(half_bits(-std::nextafter(middle, 0.0f)), half | 0x8000) << middle;
  }
}

} // namespace
