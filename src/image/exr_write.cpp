#include "base/error.h"
#include "image/codecs.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <set>

namespace faceta::codec {
namespace {

class MemoryOutput final : public Imf::OStream {
public:
  explicit MemoryOutput(const std::string& name) : OStream(name.c_str()) {}
  void write(const char from[], int count) override {
    const auto size = static_cast<std::size_t>(count);
    if (at_ + size > bytes.size())
      bytes.resize(at_ + size);
    std::memcpy(bytes.data() + at_, from, size);
    at_ += size;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t to) override { at_ = to; }

  Bytes bytes;

private:
  std::size_t at_ = 0;
};

struct AddAttribute {
  Imf::Header& header;
  const std::string& key;
  void operator()(int v) const { header.insert(key, Imf::IntAttribute(v)); }
  void operator()(double v) const { header.insert(key, Imf::DoubleAttribute(v)); }
  void operator()(const std::string& v) const { header.insert(key, Imf::StringAttribute(v)); }
  void operator()(const V3f& v) const {
    header.insert(key, Imf::V3fAttribute(Imath::V3f(v.x, v.y, v.z)));
  }
  void operator()(const M44f& v) const {
    Imath::M44f m;
    std::memcpy(m.x, v.m.data(), sizeof v.m);
    header.insert(key, Imf::M44fAttribute(m));
  }
  void operator()(const Chromaticities& v) const {
    const auto xy = [](const std::array<float, 2>& p) { return Imath::V2f(p[0], p[1]); };
    header.insert(key, Imf::ChromaticitiesAttribute(
                           Imf::Chromaticities(xy(v.red), xy(v.green), xy(v.blue), xy(v.white))));
  }
};

Imf::Header make_header(const Image& image, const std::string& name) {
  const Imath::Box2i data({image.x, image.y},
                          {image.x + image.width - 1, image.y + image.height - 1});
  const Imath::Box2i display =
      image.full_width > 0 ? Imath::Box2i({0, 0}, {image.full_width - 1, image.full_height - 1})
                           : data;
  Imf::Header header(display, data);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const auto& [key, value] : image.metadata) {
    // An attribute of the format itself, under the same name, would be replaced.
    if (key.empty() || header.find(key) != header.end() || key == "tiles" || key == "type" ||
        key == "chunkCount" || key == "name" || key == "version" || key == "preview")
      throw Error(fmt::format("'{}' cannot be the name of a metadata value in an EXR file", key),
                  {name}, "the format uses that name itself");
    std::visit(AddAttribute{header, key}, value);
  }
  if (!image.metadata.contains("chromaticities") && image.find_channel("R"))
    AddAttribute{header, "chromaticities"}(Chromaticities{});
  return header;
}

std::vector<half> to_half(const std::vector<float>& values) {
  std::vector<half> out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    // Only finite values are clamped: an infinity in a picture should stay visible as one.
    out[i] = std::isfinite(values[i]) ? std::clamp(values[i], -65504.0f, 65504.0f) : values[i];
  return out;
}

} // namespace

Bytes write_exr(const Image& image, const WriteOptions& options, const std::string& name) {
  const std::size_t count = image.channels.size();
  if (std::set<std::string>(image.channels.begin(), image.channels.end()).size() != count)
    throw Error("two channels of the image have the same name", {name});
  try {
    Imf::Header header = make_header(image, name);
    const auto type = options.half ? Imf::HALF : Imf::FLOAT;
    const std::vector<half> halves = options.half ? to_half(image.data) : std::vector<half>();
    const auto* base = options.half ? reinterpret_cast<const char*>(halves.data())
                                    : reinterpret_cast<const char*>(image.data.data());
    const std::size_t value = options.half ? 2 : 4;
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < count; ++c) {
      header.channels().insert(image.channels[c], Imf::Channel(type));
      frame.insert(image.channels[c],
                   Imf::Slice::Make(type, base + c * value, header.dataWindow().min, image.width,
                                    image.height, count * value,
                                    count * value * std::size_t(image.width)));
    }
    MemoryOutput stream(name);
    { // the destructor completes the chunk table
      Imf::OutputFile out(stream, header, 0);
      out.setFrameBuffer(frame);
      out.writePixels(image.height);
    }
    return std::move(stream.bytes);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(fmt::format("cannot encode the OpenEXR image: {}", e.what()), {name});
  }
}

} // namespace faceta::codec
