#include "base/error.h"
#include "image/codecs.h"

#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace faceta::codec {
namespace {

/// The next word of a PNM-style header. Exactly one white-space character follows the last word.
std::string_view next_word(View file, std::size_t& at) {
  while (at < file.size() && std::isspace(file[at]))
    ++at;
  const std::size_t begin = at;
  while (at < file.size() && !std::isspace(file[at]) && at - begin < 64)
    ++at;
  return {reinterpret_cast<const char*>(file.data()) + begin, at - begin};
}

template <class Number>
Number number(std::string_view word, const char* what, const std::string& name) {
  Number value{};
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (code != std::errc() || end != word.data() + word.size())
    throw Error(fmt::format("'{}' is not the {} of a PFM file", word, what), {name});
  return value;
}

std::uint32_t swap_bytes(std::uint32_t v) {
  return v >> 24 | (v >> 8 & 0xff00u) | (v << 8 & 0xff0000u) | v << 24;
}

} // namespace

bool is_pfm(View file) {
  return file.size() >= 3 && file[0] == 'P' && (file[1] == 'F' || file[1] == 'f') &&
         std::isspace(file[2]);
}

Decoded read_pfm(View file, const std::string& name) {
  Decoded out;
  Bitmap& bitmap = out.bitmap;
  std::size_t at = 0;
  const bool colour = next_word(file, at) == "PF";
  bitmap.width = number<int>(next_word(file, at), "width", name);
  bitmap.height = number<int>(next_word(file, at), "height", name);
  const auto scale = number<double>(next_word(file, at), "scale", name);
  if (!std::isfinite(scale) || scale == 0)
    throw Error("the scale of a PFM file must be a finite number other than 0", {name});
  ++at;
  check_image_size(bitmap.width, bitmap.height, name);
  bitmap.channels = colour ? 3 : 1;
  bitmap.channel_names =
      colour ? std::vector<std::string>{"R", "G", "B"} : std::vector<std::string>{"Y"};
  bitmap.type = Bitmap::Type::f32;
  const std::size_t row = std::size_t(bitmap.width) * std::size_t(bitmap.channels) * 4;
  const std::size_t size = row * std::size_t(bitmap.height);
  if (at > file.size() || file.size() - at < size)
    throw Error(fmt::format("the file is truncated: {} x {} pixels need {} bytes after the header",
                            bitmap.width, bitmap.height, size),
                {name}, fmt::format("there are {}", at > file.size() ? 0 : file.size() - at));
  bitmap.bytes.resize(size);
  for (int y = 0; y < bitmap.height; ++y) // the bottom row comes first
    std::memcpy(bitmap.bytes.data() + row * std::size_t(bitmap.height - 1 - y),
                file.data() + at + row * std::size_t(y), row);
  const bool swap = (scale < 0) != (std::endian::native == std::endian::little);
  const float factor = static_cast<float>(std::abs(scale));
  if (!swap && factor == 1)
    return out;
  for (std::size_t i = 0; i < size; i += 4) {
    std::uint32_t bits;
    std::memcpy(&bits, bitmap.bytes.data() + i, 4);
    if (swap)
      bits = swap_bytes(bits);
    if (factor != 1)
      bits = std::bit_cast<std::uint32_t>(std::bit_cast<float>(bits) * factor);
    std::memcpy(bitmap.bytes.data() + i, &bits, 4);
  }
  return out;
}

Bytes write_pfm(const Image& image, const std::string&) {
  const Image out = picture_channels(image, false);
  const std::string header = fmt::format(
      "{}\n{} {}\n-1.0\n", out.channels.size() == 3 ? "PF" : "Pf", out.width, out.height);
  const std::size_t row = std::size_t(out.width) * out.channels.size();
  Bytes bytes(header.begin(), header.end());
  bytes.reserve(header.size() + out.data.size() * 4);
  for (int y = out.height - 1; y >= 0; --y)
    for (std::size_t i = 0; i < row; ++i) {
      const auto bits = std::bit_cast<std::uint32_t>(out.data[row * std::size_t(y) + i]);
      for (int shift = 0; shift < 32; shift += 8)
        bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
    }
  return bytes;
}

} // namespace faceta::codec
