#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace faceta {

/// Texels as a file stores them, for textures: interleaved, row-major, top row first, in the
/// machine's byte order, without padding.
///
/// PNG keeps 8 or 16 bits (palettes, 1, 2 and 4 bits become 8), JPEG 8, an EXR whose channels are
/// all half 16-bit floats, everything else 32-bit floats.
struct Bitmap {
  enum class Type { u8, u16, f16, f32 };

  int width = 0, height = 0, channels = 0;
  Type type = Type::u8;
  std::vector<std::uint8_t> bytes;
  /// True if integers hold the sRGB signal, not linear light (never applies to alpha).
  bool srgb_encoded = false;
  /// One name a channel, as in Image.
  std::vector<std::string> channel_names;

  /// Bytes of one value: 1, 2, 2, 4.
  static int size_of(Type type);
  /// One value as a linear float: integers divided by their maximum, the sRGB signal decoded (alpha
  /// never is).
  float linear(int x, int y, int channel) const;
};

} // namespace faceta
