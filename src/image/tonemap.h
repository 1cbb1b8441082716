#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace faceta {

/// Linear light to the sRGB signal, piecewise exact (IEC 61966-2-1). Odd beyond 0, so that negative
/// values survive a round trip; not clamped above 1.
inline double linear_to_srgb(double v) {
  const double a = std::abs(v);
  const double s = a <= 0.0031308 ? 12.92 * a : 1.055 * std::pow(a, 1 / 2.4) - 0.055;
  return std::copysign(s, v);
}

/// The sRGB signal to linear light, inverse of linear_to_srgb.
inline double srgb_to_linear(double v) {
  const double a = std::abs(v);
  const double s = a <= 0.04045 ? a / 12.92 : std::pow((a + 0.055) / 1.055, 2.4);
  return std::copysign(s, v);
}

/// The factor of an exposure in photographic stops.
inline double exposure_factor(double stops) {
  return std::exp2(stops);
}

/// A unit signal to 8 bits, rounded to nearest. NaN gives 0, infinities the nearer end.
inline std::uint8_t to_u8(double v) {
  if (!(v > 0))
    return 0;
  return static_cast<std::uint8_t>(std::lround(std::min(v, 1.0) * 255.0));
}

/// Linear light to an 8-bit sRGB code after an exposure in stops.
inline std::uint8_t linear_to_srgb8(double v, double stops = 0) {
  return to_u8(linear_to_srgb(v * exposure_factor(stops)));
}

} // namespace faceta
