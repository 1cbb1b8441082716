#include "base/error.h"
#include "image/codecs.h"

#include <cstring>
#include <fmt/format.h>

/// The layout of an OpenEXR file up to the chunk tables ("OpenEXR File Layout", openexr.com).
namespace faceta::codec {
namespace {

constexpr std::uint32_t kTiled = 0x200, kDeep = 0x800, kMultiPart = 0x1000;

class Walker {
public:
  Walker(View file, const std::string& name) : file_(file), name_(name) {}

  std::uint32_t u32() {
    const auto b = take(4);
    return b[0] | std::uint32_t(b[1]) << 8 | std::uint32_t(b[2]) << 16 | std::uint32_t(b[3]) << 24;
  }
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  View take(std::size_t count) {
    if (file_.size() - at_ < count)
      fail("the header is truncated");
    at_ += count;
    return file_.subspan(at_ - count, count);
  }
  std::string text() {
    std::string out;
    for (char c = char(take(1)[0]); c != 0; c = char(take(1)[0])) {
      out += c;
      if (out.size() > 255)
        fail("a name of more than 255 characters");
    }
    return out;
  }
  std::size_t left() const { return file_.size() - at_; }
  View rest() const { return file_.subspan(at_); }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error("not a valid OpenEXR file: " + what, {name_});
  }

private:
  View file_;
  std::size_t at_ = 0;
  const std::string& name_;
};

struct Part {
  std::int64_t width = 0, height = 0, tile_width = 0, tile_height = 0, chunk_count = 0;
  std::uint8_t compression = 0;
  std::string type;
};

struct FixedSize {
  std::string_view type;
  std::size_t bytes;
};
constexpr FixedSize kFixedSizes[] = {
    {"box2f", 16},      {"box2i", 16},   {"chromaticities", 32},
    {"compression", 1}, {"double", 8},   {"envmap", 1},
    {"float", 4},       {"int", 4},      {"keycode", 28},
    {"lineOrder", 1},   {"m33d", 72},    {"m33f", 36},
    {"m44d", 128},      {"m44f", 64},    {"rational", 8},
    {"tiledesc", 9},    {"timecode", 8}, {"v2d", 16},
    {"v2f", 8},         {"v2i", 8},      {"v3d", 24},
    {"v3f", 12},        {"v3i", 12},     {"deepImageState", 1},
};

/// Bytes that the value of an attribute really takes; OpenEXR reads so many whatever the header
/// says, and would take the header to go on there. What it reads by the size alone is left out.
std::size_t size_of_value(View file, const std::string& name, const std::string& type) {
  for (const FixedSize& fixed : kFixedSizes)
    if (type == fixed.type)
      return fixed.bytes;
  Walker w(file, name);
  if (type == "chlist")
    while (!w.text().empty())
      w.take(16);
  else if (type == "stringvector")
    while (w.left() > 0)
      w.take(w.u32());
  else if (type == "preview") {
    const std::uint64_t width = w.u32(), height = w.u32();
    if (width != 0 && height > w.left() / 4 / width)
      w.fail("its preview is truncated");
    w.take(4 * width * height);
  } else {
    return file.size();
  }
  return file.size() - w.left();
}

void read_window(Walker& w, Part& part) {
  const std::int64_t x0 = w.i32(), y0 = w.i32(), x1 = w.i32(), y1 = w.i32();
  part.width = x1 - x0 + 1, part.height = y1 - y0 + 1;
}

void check_tiles(const Part& part, const Walker& w) {
  if (part.tile_width < 1 || part.tile_height < 1 || part.tile_width > kMaxDimension ||
      part.tile_height > kMaxDimension)
    w.fail(fmt::format("tiles of {} x {} pixels", part.tile_width, part.tile_height));
}

void read_attribute(View file, const std::string& name, const std::string& key,
                    const std::string& type, Part& part) {
  Walker w(file, name);
  if (key == "dataWindow" && type == "box2i")
    read_window(w, part);
  if (key == "compression" && type == "compression")
    part.compression = w.take(1)[0];
  if (key == "type" && type == "string")
    part.type.assign(reinterpret_cast<const char*>(file.data()), file.size());
  if (key == "chunkCount" && type == "int")
    part.chunk_count = w.u32();
  if (key == "tiles" && type == "tiledesc") {
    part.tile_width = w.u32(), part.tile_height = w.u32();
    check_tiles(part, w); // OpenEXR rounds up to tiles in files of scan lines too
  }
}

/// One header up to its empty name. False if it is empty: the end of a multi-part file's headers.
bool read_part(Walker& w, const std::string& name, Part& part) {
  for (int count = 0;; ++count) {
    const std::string key = w.text();
    if (key.empty())
      return count > 0;
    const std::string type = w.text();
    const std::uint32_t size = w.u32();
    if (size > w.left())
      w.fail(fmt::format("its attribute '{}' claims {} bytes, more than the file has", key, size));
    const View value = w.take(size);
    if (const std::size_t real = size_of_value(value, name, type); real != size)
      w.fail(fmt::format("its attribute '{}' of type {} claims {} bytes, but has {}", key, type,
                         size, real));
    read_attribute(value, name, key, type, part);
  }
}

std::int64_t ceil_div(std::int64_t a, std::int64_t b) {
  return (a + b - 1) / b;
}

/// Number of entries in the chunk table (at least, where there are mip-maps).
std::int64_t chunks(const Part& part, bool tiled, Walker& w) {
  if (tiled) {
    check_tiles(part, w);
    return ceil_div(part.width, part.tile_width) * ceil_div(part.height, part.tile_height);
  }
  // Scan lines in one chunk: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
  static constexpr int kLines[] = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
  if (part.compression >= std::size(kLines))
    w.fail(fmt::format("unknown compression {}", part.compression));
  return ceil_div(part.height, kLines[part.compression]);
}

} // namespace

bool is_exr(View file) {
  static constexpr std::uint8_t kMagic[] = {0x76, 0x2f, 0x31, 0x01};
  return file.size() >= 4 && std::memcmp(file.data(), kMagic, 4) == 0;
}

void check_exr_headers(View file, const std::string& name) {
  Walker w(file, name);
  w.take(4);
  const std::uint32_t version = w.u32();
  if ((version & 0xff) != 2)
    w.fail(fmt::format("unknown version {}", version & 0xff));
  std::int64_t table_entries = 0;
  for (int count = 0; count < 10000; ++count) {
    Part part;
    if (!read_part(w, name, part)) {
      if (count == 0)
        w.fail("it has no header");
      break;
    }
    if ((version & kDeep) != 0 || part.type.starts_with("deep"))
      throw Error("deep OpenEXR images are not supported", {name}, "flatten the file first");
    check_image_size(part.width, part.height, name);
    const bool tiled = (version & kTiled) != 0 || part.type == "tiledimage";
    table_entries += std::max(chunks(part, tiled, w), part.chunk_count);
    if ((version & kMultiPart) == 0)
      break;
  }
  // Each chunk has an entry of 8 bytes in the table and a head of at least 8.
  if (table_entries > static_cast<std::int64_t>(w.left() / 16))
    w.fail("the file is truncated: it is too short for its table of chunks");
}

} // namespace faceta::codec
