#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace faceta {

/// Three floats in a file header (OpenEXR attribute type "v3f").
struct V3f {
  float x = 0, y = 0, z = 0;
  bool operator==(const V3f&) const = default;
};

/// A 4x4 matrix in a file header, row by row (OpenEXR attribute type "m44f").
struct M44f {
  std::array<float, 16> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  bool operator==(const M44f&) const = default;
};

/// CIE xy of the primaries and the white point. The default is Rec. 709 / sRGB with D65.
struct Chromaticities {
  std::array<float, 2> red{0.64f, 0.33f}, green{0.30f, 0.60f}, blue{0.15f, 0.06f},
      white{0.3127f, 0.3290f};
  bool operator==(const Chromaticities&) const = default;
};

using MetadataValue = std::variant<int, double, std::string, V3f, M44f, Chromaticities>;
/// Named values that travel with an image, ordered by name.
using Metadata = std::map<std::string, MetadataValue>;

/// Largest width or height, and largest number of pixels, of any image.
inline constexpr int kMaxDimension = 65536;
inline constexpr std::int64_t kMaxPixels = std::int64_t(1) << 30;

/// What to do when an image has no R, G, B channels.
enum class RgbFallback {
  none,            ///< an Error
  luminance,       ///< Y alone is taken for all three
  luminance_or_xyz ///< as above, or X, Y, Z are converted to linear Rec. 709
};

/// Linear floats, interleaved, row-major, top row first.
///
/// Channel names are OpenEXR's: "R", "G", "B", "A", "Y", "X", "Z", layers as "layer.R".
/// `x`, `y` place the top left pixel inside a frame of `full_width` x `full_height` pixels
/// (OpenEXR's data window relative to its display window); full_width = 0 means the image is the
/// whole frame.
struct Image {
  int width = 0, height = 0;
  std::vector<std::string> channels;
  std::vector<float> data;
  Metadata metadata;
  int x = 0, y = 0, full_width = 0, full_height = 0;

  Image() = default;
  /// An image filled with one value. Error if a size is < 1 or above the caps.
  Image(int width, int height, std::vector<std::string> channels = {"R", "G", "B"},
        float value = 0);

  int channel_count() const { return static_cast<int>(channels.size()); }
  std::size_t pixel_count() const { return std::size_t(width) * std::size_t(height); }

  /// Position of the first value of a pixel in `data`.
  std::size_t offset(int px, int py) const {
    return (std::size_t(py) * std::size_t(width) + std::size_t(px)) * channels.size();
  }
  float& at(int px, int py, int c) { return data[offset(px, py) + std::size_t(c)]; }
  float at(int px, int py, int c) const { return data[offset(px, py) + std::size_t(c)]; }

  /// Index of a channel by exact name.
  std::optional<int> find_channel(std::string_view name) const;

  /// A copy with these channels in this order. Error naming the channels there are if one is
  /// missing.
  Image select(const std::vector<std::string>& names) const;

  /// A copy with the channels R, G, B (taken from "layer.R" … if a layer is given).
  Image rgb(RgbFallback fallback = RgbFallback::luminance, std::string_view layer = {}) const;

  /// The rectangle [left, left + w) x [top, top + h), which must lie inside. `x`, `y`, `full_*` are
  /// set so that the result knows its place in the frame.
  Image crop(int left, int top, int w, int h) const;

  /// The whole frame: cut to `full_width` x `full_height`, missing pixels filled with `value`.
  Image frame(float value = 0) const;
};

/// Throws an Error if width, height or their product is < 1 or above the caps. `what` begins the
/// message, `file` names its source.
void check_image_size(std::int64_t width, std::int64_t height, const std::string& file = {});

/// Linear Rec. 709 to CIE XYZ and back, with the six-digit matrices that Mitsuba uses (ITU-R BT.709
/// primaries and white; the two are inverse to each other to about 1e-6).
std::array<double, 3> rgb_to_xyz(const std::array<double, 3>& rgb);
std::array<double, 3> xyz_to_rgb(const std::array<double, 3>& xyz);

} // namespace faceta
