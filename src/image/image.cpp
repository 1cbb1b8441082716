#include "image/image.h"

#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace faceta {

void check_image_size(std::int64_t width, std::int64_t height, const std::string& file) {
  if (width < 1 || height < 1)
    throw Error(fmt::format("an image of {} x {} pixels has no content", width, height), {file});
  if (width > kMaxDimension || height > kMaxDimension || width * height > kMaxPixels)
    throw Error(fmt::format("an image of {} x {} pixels is too large", width, height), {file},
                fmt::format("at most {} a side and {} in all", kMaxDimension, kMaxPixels));
}

Image::Image(int w, int h, std::vector<std::string> names, float value)
    : width(w), height(h), channels(std::move(names)) {
  check_image_size(w, h);
  data.assign(pixel_count() * channels.size(), value);
}

std::optional<int> Image::find_channel(std::string_view name) const {
  const auto it = std::find(channels.begin(), channels.end(), name);
  if (it == channels.end())
    return std::nullopt;
  return static_cast<int>(it - channels.begin());
}

Image Image::select(const std::vector<std::string>& names) const {
  std::vector<std::size_t> index;
  for (const auto& name : names) {
    const auto found = find_channel(name);
    if (!found)
      throw Error(fmt::format("the image has no channel '{}'", name), {},
                  fmt::format("it has: {}", fmt::join(channels, ", ")));
    index.push_back(static_cast<std::size_t>(*found));
  }
  Image out(width, height, names);
  out.metadata = metadata;
  out.x = x, out.y = y, out.full_width = full_width, out.full_height = full_height;
  const std::size_t in_count = channels.size(), out_count = names.size();
  for (std::size_t p = 0; p < pixel_count(); ++p)
    for (std::size_t c = 0; c < out_count; ++c)
      out.data[p * out_count + c] = data[p * in_count + index[c]];
  return out;
}

Image Image::rgb(RgbFallback fallback, std::string_view layer) const {
  const std::string prefix = layer.empty() ? "" : std::string(layer) + ".";
  const auto has = [&](const char* name) { return find_channel(prefix + name).has_value(); };
  const auto take = [&](const char* a, const char* b, const char* c) {
    Image out = select({prefix + a, prefix + b, prefix + c});
    out.channels = {"R", "G", "B"};
    return out;
  };
  if (has("R") && has("G") && has("B"))
    return take("R", "G", "B");
  if (fallback == RgbFallback::luminance_or_xyz && has("X") && has("Y") && has("Z")) {
    Image out = take("X", "Y", "Z");
    for (std::size_t p = 0; p < out.data.size(); p += 3) {
      const auto rgb = xyz_to_rgb({out.data[p], out.data[p + 1], out.data[p + 2]});
      for (std::size_t c = 0; c < 3; ++c)
        out.data[p + c] = static_cast<float>(rgb[c]);
    }
    return out;
  }
  // Y beside X and Z is a colour: taking it for grey would lose two thirds of it in silence.
  if (fallback != RgbFallback::none && has("Y") && !has("X") && !has("Z"))
    return take("Y", "Y", "Y");
  throw Error(fmt::format("the image has no channels {0}R, {0}G, {0}B", prefix), {},
              fmt::format("it has: {}", fmt::join(channels, ", ")));
}

Image Image::crop(int left, int top, int w, int h) const {
  if (left < 0 || top < 0 || w < 1 || h < 1 || std::int64_t(left) + w > width ||
      std::int64_t(top) + h > height)
    throw Error(fmt::format("the crop {},{} {}x{} does not lie inside {}x{}", left, top, w, h,
                            width, height));
  Image out(w, h, channels);
  out.metadata = metadata;
  out.x = x + left, out.y = y + top;
  out.full_width = full_width > 0 ? full_width : width;
  out.full_height = full_width > 0 ? full_height : height;
  for (int row = 0; row < h; ++row)
    std::copy_n(data.begin() + static_cast<std::ptrdiff_t>(offset(left, top + row)),
                std::size_t(w) * channels.size(),
                out.data.begin() + static_cast<std::ptrdiff_t>(out.offset(0, row)));
  return out;
}

Image Image::frame(float value) const {
  if (full_width == 0)
    return *this;
  Image out(full_width, full_height, channels, value);
  out.metadata = metadata;
  const int left = std::max(0, x), right = std::min<int>(full_width, x + width);
  for (int row = std::max(0, y); row < std::min<int>(full_height, y + height) && left < right;
       ++row)
    std::copy_n(data.begin() + static_cast<std::ptrdiff_t>(offset(left - x, row - y)),
                std::size_t(right - left) * channels.size(),
                out.data.begin() + static_cast<std::ptrdiff_t>(out.offset(left, row)));
  return out;
}

std::array<double, 3> rgb_to_xyz(const std::array<double, 3>& c) {
  return {0.412453 * c[0] + 0.357580 * c[1] + 0.180423 * c[2],
          0.212671 * c[0] + 0.715160 * c[1] + 0.072169 * c[2],
          0.019334 * c[0] + 0.119193 * c[1] + 0.950227 * c[2]};
}

std::array<double, 3> xyz_to_rgb(const std::array<double, 3>& c) {
  return {3.240479 * c[0] - 1.537150 * c[1] - 0.498535 * c[2],
          -0.969256 * c[0] + 1.875991 * c[1] + 0.041556 * c[2],
          0.055648 * c[0] - 0.204043 * c[1] + 1.057311 * c[2]};
}

} // namespace faceta
