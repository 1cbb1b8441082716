#include "image/io.h"

#include "base/error.h"
#include "image/codecs.h"
#include "image/tonemap.h"

#include <Imath/half.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <memory>
#include <unistd.h>

namespace faceta {
namespace {

namespace fs = std::filesystem;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

std::string reason() {
  return std::strerror(errno);
}

bool is_alpha(const std::string& name) {
  return name == "A" || name.ends_with(".A");
}

/// Turns stored integers into linear floats by a table: 256 or 65536 entries, instead of a power
/// per texel.
template <class Stored>
void decode_integers(const Bitmap& bitmap, double gamma, std::vector<float>& out) {
  constexpr std::size_t kCodes = std::size_t(1) << (8 * sizeof(Stored));
  std::vector<float> colour(kCodes), alpha(kCodes);
  for (std::size_t i = 0; i < kCodes; ++i) {
    const double unit = static_cast<double>(i) / static_cast<double>(kCodes - 1);
    alpha[i] = static_cast<float>(unit);
    colour[i] = static_cast<float>(gamma > 0 ? std::pow(unit, gamma) : srgb_to_linear(unit));
  }
  const auto count = static_cast<std::size_t>(bitmap.channels);
  for (std::size_t c = 0; c < count; ++c) {
    const auto& table = is_alpha(bitmap.channel_names[c]) ? alpha : colour;
    for (std::size_t i = c; i < out.size(); i += count) {
      Stored code;
      std::memcpy(&code, bitmap.bytes.data() + i * sizeof(Stored), sizeof(Stored));
      out[i] = table[code];
    }
  }
}

std::string ending_of(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

void check_image(const Image& image, const std::string& name) {
  check_image_size(image.width, image.height, name);
  if (image.channels.empty() || image.data.size() != image.pixel_count() * image.channels.size())
    throw Error("the image's data do not fit its size and channels", {name});
}

} // namespace

codec::Bytes codec::read_file(const fs::path& path) {
  const std::string name = path.string();
  std::error_code code;
  const auto status = fs::status(path, code);
  if (!fs::exists(status))
    throw Error("there is no such file", {name});
  if (!fs::is_regular_file(status))
    throw Error("this is not a regular file", {name});
  File file(std::fopen(path.c_str(), "rb"));
  if (!file)
    throw Error("cannot open the file: " + reason(), {name});
  const auto size = fs::file_size(path, code);
  if (code)
    throw Error("cannot tell the file's size: " + code.message(), {name});
  Bytes bytes(size);
  if (std::fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size())
    throw Error("cannot read the file: " + reason(), {name});
  return bytes;
}

codec::Decoded codec::decode(View file, const std::string& name) {
  if (file.empty())
    throw Error("the file is empty", {name}, "an image was expected");
  if (is_exr(file))
    return read_exr(file, name);
  if (is_png(file))
    return read_png(file, name);
  if (is_jpeg(file))
    return read_jpeg(file, name);
  if (is_hdr(file))
    return read_hdr(file, name);
  if (is_pfm(file))
    return read_pfm(file, name);
  throw Error("not an image of a known format", {name},
              "known by their first bytes: OpenEXR, PNG, JPEG, Radiance HDR, PFM");
}

void codec::write_file(const fs::path& path, View bytes) {
  static std::atomic<unsigned> counter{0};
  const std::string name = path.string();
  std::error_code code;
  const auto status = fs::status(path, code);
  if (fs::is_directory(status))
    throw Error("cannot write: this is a folder", {name});
  const bool direct = fs::exists(status) && !fs::is_regular_file(status);
  const std::string target =
      direct ? name : fmt::format("{}.{}-{}.tmp", name, ::getpid(), counter.fetch_add(1));
  const auto fail = [&](const std::string& what) {
    const std::string why = reason();
    if (!direct)
      fs::remove(target, code);
    throw Error(what + ": " + why, {name});
  };
  File file(std::fopen(target.c_str(), "wb"));
  if (!file)
    throw Error("cannot write: " + reason(), {name}, "does its folder exist?");
  if (std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size() ||
      std::fflush(file.get()) != 0)
    fail("cannot write");
  // The result of fclose counts: a full network disk says so only here.
  if (std::fclose(file.release()) != 0)
    fail("cannot write");
  if (!direct && std::rename(target.c_str(), name.c_str()) != 0)
    fail("cannot rename into place");
}

Image codec::picture_channels(const Image& image, bool alpha) {
  const bool grey = image.find_channel("Y") && !image.find_channel("R") &&
                    !image.find_channel("X") && !image.find_channel("Z");
  Image out = grey ? image.select({"Y"}) : image.rgb(RgbFallback::luminance_or_xyz);
  const auto a = image.find_channel("A");
  if (!alpha || !a)
    return out;
  Image with(out.width, out.height, out.channels);
  with.channels.push_back("A");
  with.data.resize(with.pixel_count() * with.channels.size());
  const std::size_t n = out.channels.size();
  for (std::size_t p = 0; p < out.pixel_count(); ++p) {
    std::copy_n(out.data.begin() + static_cast<std::ptrdiff_t>(p * n), n,
                with.data.begin() + static_cast<std::ptrdiff_t>(p * (n + 1)));
    with.data[p * (n + 1) + n] = image.data[p * image.channels.size() + std::size_t(*a)];
  }
  return with;
}

int Bitmap::size_of(Type type) {
  return type == Type::u8 ? 1 : type == Type::f32 ? 4 : 2;
}

float Bitmap::linear(int x, int y, int channel) const {
  const std::size_t index =
      (std::size_t(y) * std::size_t(width) + std::size_t(x)) * std::size_t(channels) +
      std::size_t(channel);
  const std::uint8_t* at = bytes.data() + index * std::size_t(size_of(type));
  if (type == Type::f32) {
    float v;
    std::memcpy(&v, at, 4);
    return v;
  }
  std::uint16_t code = *at;
  if (type != Type::u8)
    std::memcpy(&code, at, 2);
  if (type == Type::f16) {
    half h;
    h.setBits(code);
    return h;
  }
  const double unit = code / (type == Type::u8 ? 255.0 : 65535.0);
  const bool decode = srgb_encoded && !is_alpha(channel_names[std::size_t(channel)]);
  return static_cast<float>(decode ? srgb_to_linear(unit) : unit);
}

Bitmap read_bitmap(const fs::path& path) {
  return codec::decode(codec::read_file(path), path.string()).bitmap;
}

Image read_image(const fs::path& path) {
  return decode_image(codec::read_file(path), path.string());
}

Image decode_image(std::span<const std::uint8_t> file, const std::string& name) {
  codec::Decoded in = codec::decode(file, name);
  const Bitmap& bitmap = in.bitmap;
  Image out;
  out.width = bitmap.width, out.height = bitmap.height;
  out.channels = bitmap.channel_names;
  out.metadata = std::move(in.metadata);
  out.x = in.x, out.y = in.y, out.full_width = in.full_width, out.full_height = in.full_height;
  out.data.resize(out.pixel_count() * out.channels.size());
  switch (bitmap.type) {
  case Bitmap::Type::u8:
    decode_integers<std::uint8_t>(bitmap, in.decode_gamma, out.data);
    break;
  case Bitmap::Type::u16:
    decode_integers<std::uint16_t>(bitmap, in.decode_gamma, out.data);
    break;
  case Bitmap::Type::f16:
    for (std::size_t i = 0; i < out.data.size(); ++i) {
      std::uint16_t bits;
      std::memcpy(&bits, bitmap.bytes.data() + 2 * i, 2);
      half h;
      h.setBits(bits);
      out.data[i] = h;
    }
    break;
  case Bitmap::Type::f32:
    std::memcpy(out.data.data(), bitmap.bytes.data(), bitmap.bytes.size());
    break;
  }
  return out;
}

bool can_write_image(const fs::path& path) {
  static constexpr std::array kEndings{".exr", ".png", ".pfm", ".hdr"};
  return std::find(kEndings.begin(), kEndings.end(), ending_of(path)) != kEndings.end();
}

std::vector<std::uint8_t> encode_png(const Image& image, const WriteOptions& options) {
  check_image(image, {});
  return codec::write_png(image, options, {});
}

void write_image(const fs::path& path, const Image& image, const WriteOptions& options) {
  const std::string ending = ending_of(path), name = path.string();
  check_image(image, name);
  if (ending == ".exr")
    codec::write_file(path, codec::write_exr(image, options, name));
  else if (ending == ".png")
    codec::write_file(path, codec::write_png(image, options, name));
  else if (ending == ".pfm")
    codec::write_file(path, codec::write_pfm(image, name));
  else if (ending == ".hdr")
    codec::write_file(path, codec::write_hdr(image, name));
  else
    throw Error(fmt::format("cannot write images with the ending '{}'", ending), {name},
                "known: .exr, .png, .pfm, .hdr");
}

} // namespace faceta
