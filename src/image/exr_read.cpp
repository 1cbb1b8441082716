#include "base/error.h"
#include "image/codecs.h"

#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <set>

namespace faceta::codec {
namespace {

class MemoryInput final : public Imf::IStream {
public:
  MemoryInput(View file, const std::string& name) : IStream(name.c_str()), file_(file) {}
  bool read(char to[], int count) override {
    if (count < 0 || file_.size() - at_ < std::size_t(count))
      throw std::runtime_error("the file is truncated");
    std::memcpy(to, file_.data() + at_, std::size_t(count));
    at_ += std::size_t(count);
    return at_ < file_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t to) override {
    if (to > file_.size())
      throw std::runtime_error("the file is truncated");
    at_ = to;
  }
  void clear() override {}

private:
  View file_;
  std::size_t at_ = 0;
};

bool is_structural(const std::string& key) {
  static const std::set<std::string> kKeys{"channels",
                                           "compression",
                                           "dataWindow",
                                           "displayWindow",
                                           "lineOrder",
                                           "pixelAspectRatio",
                                           "screenWindowCenter",
                                           "tiles",
                                           "type",
                                           "name",
                                           "screenWindowWidth",
                                           "version",
                                           "chunkCount"};
  return kKeys.contains(key);
}

Metadata read_metadata(const Imf::Header& header) {
  Metadata out;
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string key = it.name();
    if (is_structural(key))
      continue;
    const Imf::Attribute& a = it.attribute();
    if (const auto* v = dynamic_cast<const Imf::IntAttribute*>(&a))
      out[key] = v->value();
    if (const auto* v = dynamic_cast<const Imf::FloatAttribute*>(&a))
      out[key] = double(v->value());
    if (const auto* v = dynamic_cast<const Imf::DoubleAttribute*>(&a))
      out[key] = v->value();
    if (const auto* v = dynamic_cast<const Imf::StringAttribute*>(&a))
      out[key] = v->value();
    if (const auto* v = dynamic_cast<const Imf::V3fAttribute*>(&a))
      out[key] = V3f{v->value().x, v->value().y, v->value().z};
    if (const auto* v = dynamic_cast<const Imf::M44fAttribute*>(&a)) {
      M44f m;
      std::memcpy(m.m.data(), v->value().x, sizeof m.m);
      out[key] = m;
    }
    if (const auto* v = dynamic_cast<const Imf::ChromaticitiesAttribute*>(&a)) {
      const Imf::Chromaticities& c = v->value();
      out[key] = Chromaticities{
          {c.red.x, c.red.y}, {c.green.x, c.green.y}, {c.blue.x, c.blue.y}, {c.white.x, c.white.y}};
    }
  }
  return out;
}

/// Orders "layer.R" by layer (unnamed first, else as in the file), then R, G, B, A and X, Y, Z
/// before other names.
void sort_channels(std::vector<std::string>& names) {
  const auto key = [](const std::string& full) {
    static constexpr std::string_view kOrder = "RGBXYZA";
    const auto dot = full.rfind('.');
    const std::string layer = dot == std::string::npos ? "" : full.substr(0, dot);
    const std::string name = dot == std::string::npos ? full : full.substr(dot + 1);
    const auto rank = name.size() == 1 ? kOrder.find(name) : std::string_view::npos;
    return std::tuple(layer, std::min(rank, kOrder.size()), name);
  };
  std::stable_sort(names.begin(), names.end(),
                   [&](const auto& a, const auto& b) { return key(a) < key(b); });
}

/// Bytes that decoding a part takes, its last tiles filled up.
std::int64_t decoded_bytes(const Imf::Header& header) {
  const auto& window = header.dataWindow();
  std::int64_t width = std::int64_t(window.max.x) - window.min.x + 1;
  std::int64_t height = std::int64_t(window.max.y) - window.min.y + 1;
  if (header.hasTileDescription()) {
    const auto& tile = header.tileDescription();
    width = (width + tile.xSize - 1) / tile.xSize * tile.xSize;
    height = (height + tile.ySize - 1) / tile.ySize * tile.ySize;
  }
  std::int64_t channels = 0;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it)
    ++channels;
  return width * height * channels * 4;
}

/// The most a compression can shrink: deflate 1032-fold; the others' constant blocks nearly without
/// bound, so a generous figure that still stops a small file from asking for gigabytes.
std::int64_t largest_ratio(Imf::Compression compression) {
  switch (compression) {
  case Imf::NO_COMPRESSION:
    return 2;
  case Imf::RLE_COMPRESSION:
    return 2 * 64;
  case Imf::ZIPS_COMPRESSION:
  case Imf::ZIP_COMPRESSION:
  case Imf::PXR24_COMPRESSION:
    return 2 * 1032;
  default:
    return 20000;
  }
}

void check_decoded_size(Imf::MultiPartInputFile& in, View file, const std::string& name) {
  std::int64_t bytes = 0, ratio = 0;
  for (int part = 0; part < in.parts(); ++part) {
    bytes += decoded_bytes(in.header(part));
    ratio = std::max(ratio, largest_ratio(in.header(part).compression()));
  }
  constexpr std::int64_t kAlwaysFine = 64 << 20;
  if (bytes > kAlwaysFine + ratio * static_cast<std::int64_t>(file.size()))
    throw Error(fmt::format("not a valid OpenEXR file: {} bytes cannot hold {} bytes of pixels",
                            file.size(), bytes),
                {name});
}

/// The place in the frame, if it is not the whole frame.
void read_windows(const Imf::Header& header, Decoded& out) {
  const auto &data = header.dataWindow(), &display = header.displayWindow();
  out.bitmap.width = data.max.x - data.min.x + 1;
  out.bitmap.height = data.max.y - data.min.y + 1;
  if (data == display)
    return;
  out.x = data.min.x - display.min.x, out.y = data.min.y - display.min.y;
  out.full_width = display.max.x - display.min.x + 1;
  out.full_height = display.max.y - display.min.y + 1;
}

bool is_luminance_chroma(const Imf::ChannelList& channels) {
  return channels.findChannel("Y") != nullptr && channels.findChannel("RY") != nullptr &&
         channels.findChannel("BY") != nullptr;
}

/// Luminance and sub-sampled chroma: OpenEXR's own filter makes R, G, B of them.
void read_luminance_chroma(Imf::IStream& stream, Decoded& out) {
  stream.seekg(0);
  Imf::RgbaInputFile in(stream, 0);
  const auto window = in.dataWindow();
  const bool alpha = (in.channels() & Imf::WRITE_A) != 0;
  Bitmap& bitmap = out.bitmap;
  bitmap.channels = alpha ? 4 : 3;
  bitmap.channel_names = {"R", "G", "B"};
  if (alpha)
    bitmap.channel_names.push_back("A");
  bitmap.type = Bitmap::Type::f16;
  const std::size_t pixel = std::size_t(bitmap.channels) * 2;
  bitmap.bytes.resize(std::size_t(bitmap.width) * std::size_t(bitmap.height) * pixel);
  Imf::Array<Imf::Rgba> row(bitmap.width);
  for (int y = 0; y < bitmap.height; ++y) {
    in.setFrameBuffer(&row[0] - window.min.x, 1, 0);
    in.readPixels(window.min.y + y);
    for (int x = 0; x < bitmap.width; ++x)
      std::memcpy(bitmap.bytes.data() + std::size_t(y * std::int64_t(bitmap.width) + x) * pixel,
                  &row[x], pixel);
  }
}

struct PartChannels {
  std::vector<std::string> in_file, in_image;
};

/// Names of all channels, part by part: a part's name goes before those that another part has too.
std::vector<PartChannels> name_channels(Imf::MultiPartInputFile& in, const std::string& name) {
  std::vector<PartChannels> parts;
  std::set<std::string> taken;
  for (int p = 0; p < in.parts(); ++p) {
    const Imf::Header& header = in.header(p);
    PartChannels part;
    for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
      if (it.channel().xSampling != 1 || it.channel().ySampling != 1)
        throw Error(
            fmt::format("the channel '{}' is sub-sampled, which is not supported", it.name()),
            {name}, "convert the file to full resolution");
      part.in_file.emplace_back(it.name());
    }
    sort_channels(part.in_file);
    const bool clash = std::any_of(part.in_file.begin(), part.in_file.end(),
                                   [&](const auto& c) { return taken.contains(c); });
    for (const auto& channel : part.in_file) {
      const std::string unique =
          clash
              ? fmt::format("{}.{}", header.hasName() ? header.name() : std::to_string(p), channel)
              : channel;
      if (!taken.insert(unique).second)
        throw Error(fmt::format("two parts have a channel '{}'", unique), {name});
      part.in_image.push_back(unique);
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

bool all_half(Imf::MultiPartInputFile& in) {
  for (int p = 0; p < in.parts(); ++p)
    for (auto it = in.header(p).channels().begin(); it != in.header(p).channels().end(); ++it)
      if (it.channel().type != Imf::HALF)
        return false;
  return true;
}

/// Reads a part's channels to their places, from `first` on, in each pixel of the bitmap. A part
/// with a data window of its own is copied to where it overlaps the first part's.
void read_part(Imf::MultiPartInputFile& in, int index, const PartChannels& names, std::size_t first,
               Bitmap& bitmap) {
  Imf::InputPart part(in, index);
  const auto window = part.header().dataWindow(), whole = in.header(0).dataWindow();
  const std::size_t value = std::size_t(Bitmap::size_of(bitmap.type));
  const std::size_t pixel = std::size_t(bitmap.channels) * value;
  const auto type = bitmap.type == Bitmap::Type::f16 ? Imf::HALF : Imf::FLOAT;
  const std::int64_t width = window.max.x - window.min.x + 1;
  const std::int64_t height = window.max.y - window.min.y + 1;
  std::vector<std::uint8_t> own;
  std::uint8_t* base = bitmap.bytes.data();
  if (window != whole) {
    own.resize(std::size_t(width * height) * pixel);
    base = own.data();
  }
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < names.in_file.size(); ++c)
    frame.insert(names.in_file[c],
                 Imf::Slice::Make(type, base + (first + c) * value, window.min, width, height,
                                  pixel, pixel * std::size_t(width)));
  part.setFrameBuffer(frame);
  part.readPixels(window.min.y, window.max.y);
  if (own.empty())
    return;
  const std::size_t bytes = names.in_file.size() * value;
  for (int y = std::max(window.min.y, whole.min.y); y <= std::min(window.max.y, whole.max.y); ++y)
    for (int x = std::max(window.min.x, whole.min.x); x <= std::min(window.max.x, whole.max.x); ++x)
      std::memcpy(
          bitmap.bytes.data() +
              (std::size_t(y - whole.min.y) * std::size_t(bitmap.width) +
               std::size_t(x - whole.min.x)) *
                  pixel +
              first * value,
          own.data() +
              (std::size_t(y - window.min.y) * std::size_t(width) + std::size_t(x - window.min.x)) *
                  pixel +
              first * value,
          bytes);
}

/// "R", "G", "B" of a file whose primaries are those of XYZ are X, Y, Z.
void rename_xyz(Decoded& out) {
  const auto it = out.metadata.find("chromaticities");
  const Chromaticities xyz{{1, 0}, {0, 1}, {0, 0}, {1 / 3.0f, 1 / 3.0f}};
  const auto near = [](const std::array<float, 2>& a, const std::array<float, 2>& b) {
    return std::abs(a[0] - b[0]) < 1e-3f && std::abs(a[1] - b[1]) < 1e-3f;
  };
  if (it == out.metadata.end())
    return;
  const auto* c = std::get_if<Chromaticities>(&it->second);
  if (c == nullptr || !near(c->red, xyz.red) || !near(c->green, xyz.green) ||
      !near(c->blue, xyz.blue) || !near(c->white, xyz.white))
    return;
  auto& names = out.bitmap.channel_names;
  if (names.size() < 3 || names[0] != "R" || names[1] != "G" || names[2] != "B")
    return;
  std::copy_n(std::array{"X", "Y", "Z"}.begin(), 3, names.begin());
}

Decoded decode_parts(View file, const std::string& name) {
  MemoryInput stream(file, name);
  Imf::MultiPartInputFile in(stream, 0, false);
  check_decoded_size(in, file, name);
  Decoded out;
  out.metadata = read_metadata(in.header(0));
  read_windows(in.header(0), out);
  if (in.parts() == 1 && is_luminance_chroma(in.header(0).channels())) {
    MemoryInput again(file, name);
    read_luminance_chroma(again, out);
    return out;
  }
  const auto parts = name_channels(in, name);
  Bitmap& bitmap = out.bitmap;
  for (const auto& part : parts)
    bitmap.channel_names.insert(bitmap.channel_names.end(), part.in_image.begin(),
                                part.in_image.end());
  bitmap.channels = static_cast<int>(bitmap.channel_names.size());
  if (bitmap.channels == 0)
    throw Error("the OpenEXR file has no channels", {name});
  bitmap.type = all_half(in) ? Bitmap::Type::f16 : Bitmap::Type::f32;
  bitmap.bytes.resize(std::size_t(bitmap.width) * std::size_t(bitmap.height) *
                      std::size_t(bitmap.channels) * std::size_t(Bitmap::size_of(bitmap.type)));
  std::size_t first = 0;
  for (int p = 0; p < in.parts(); ++p) {
    const auto& names = parts[std::size_t(p)];
    read_part(in, p, names, first, bitmap);
    first += names.in_file.size();
  }
  return out;
}

} // namespace

Decoded read_exr(View file, const std::string& name) {
  check_exr_headers(file, name);
  try {
    Decoded out = decode_parts(file, name);
    rename_xyz(out);
    return out;
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(fmt::format("not a readable OpenEXR file: {}", e.what()), {name});
  }
}

} // namespace faceta::codec
