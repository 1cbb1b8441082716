#include "scene/textures.h"

#include "bsdf/kernel.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace faceta {

namespace {

// Word offsets of texels must stay below 2^31.
constexpr int64_t kMaxFloatTexels = int64_t(1) << 29;
// Every level of checkerboards doubles the work of a lookup.
constexpr int kMaxNesting = 8;

int tiles(int size) {
  return (size + kTileStep - 1) / kTileStep;
}

size_t tile_texels(const Bitmap& b) {
  return size_t(tiles(b.width)) * size_t(tiles(b.height)) * kTileTexels;
}

/// Which channels hold red, green, blue and alpha (-1: none).
struct ChannelMap {
  int rgb[3] = {0, 0, 0};
  int alpha = -1;
  bool xyz = false;
};

ChannelMap map_channels(const Bitmap& b) {
  auto find = [&](const char* name) {
    auto at = std::find(b.channel_names.begin(), b.channel_names.end(), name);
    return at == b.channel_names.end() ? -1 : static_cast<int>(at - b.channel_names.begin());
  };
  ChannelMap map;
  map.alpha = find("A");
  int r = find("R"), g = find("G"), blue = find("B");
  int x = find("X"), y = find("Y"), z = find("Z");
  if (r >= 0 && g >= 0 && blue >= 0) {
    std::copy_n(std::array{r, g, blue}.begin(), 3, map.rgb);
  } else if (x >= 0 && y >= 0 && z >= 0) {
    std::copy_n(std::array{x, y, z}.begin(), 3, map.rgb);
    map.xyz = true;
  } else if (y >= 0) {
    std::fill_n(map.rgb, 3, y);
  } else if (b.channel_names.empty() && b.channels >= 3) {
    std::copy_n(std::array{0, 1, 2}.begin(), 3, map.rgb);
    map.alpha = b.channels >= 4 ? 3 : -1;
  } else if (b.channel_names.size() > 2 || (b.channel_names.size() == 2 && map.alpha < 0)) {
    throw Error("the bitmap of a texture has no channels R, G, B or Y", {},
                suggestion("", b.channel_names));
  } else if (map.alpha == 0 && b.channels == 2) {
    std::fill_n(map.rgb, 3, 1);
  }
  return map;
}

void check_bitmap(const Bitmap& b) {
  check_image_size(b.width, b.height);
  size_t texels = size_t(b.width) * size_t(b.height);
  if (b.channels < 1 || b.bytes.size() < texels * size_t(b.channels) * Bitmap::size_of(b.type) ||
      (!b.channel_names.empty() && b.channel_names.size() != size_t(b.channels)))
    throw Error("the bitmap of a texture is incomplete");
  if (b.type != Bitmap::Type::u8 && int64_t(tile_texels(b)) > kMaxFloatTexels)
    throw Error("the bitmap of a texture has more than 2^29 texels", {}, "make it smaller");
}

/// Stored integers to linear light.
std::vector<float> decoding_table(const Bitmap& b, bool decode) {
  size_t codes = b.type == Bitmap::Type::u8 ? 256 : 65536;
  std::vector<float> table(codes);
  for (size_t i = 0; i < codes; ++i) {
    double c = double(i) / double(codes - 1);
    if (decode)
      c = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    table[i] = static_cast<float>(c);
  }
  return table;
}

/// Reads the texels of any bitmap, with the power function tabulated.
class Reader {
public:
  Reader(const Bitmap& b, bool raw) : bitmap_(b), map_(map_channels(b)) {
    if (b.type == Bitmap::Type::u8 || b.type == Bitmap::Type::u16)
      table_ = decoding_table(b, b.srgb_encoded && !raw);
  }

  /// Linear RGB. Throws Error where it is not finite.
  std::array<double, 3> operator()(int x, int y) const {
    std::array<double, 3> rgb;
    for (int c = 0; c < 3; ++c)
      rgb[c] = linear(x, y, map_.rgb[c]);
    if (map_.xyz)
      rgb = xyz_to_rgb(rgb);
    for (double v : rgb)
      if (!std::isfinite(v))
        throw Error("the bitmap of a texture holds a value that is not finite");
    return rgb;
  }
  float alpha(int x, int y) const {
    return map_.alpha < 0 ? 1.0f : bitmap_.linear(x, y, map_.alpha);
  }
  /// The bytes R | G << 8 | B << 16 | A << 24.
  uint32_t packed(int x, int y) const {
    const uint8_t* from = &bitmap_.bytes[index(x, y, 0)];
    uint32_t alpha = map_.alpha < 0 ? 255 : from[map_.alpha];
    return uint32_t(from[map_.rgb[0]]) | uint32_t(from[map_.rgb[1]]) << 8 |
           uint32_t(from[map_.rgb[2]]) << 16 | alpha << 24;
  }

private:
  const Bitmap& bitmap_;
  ChannelMap map_;
  std::vector<float> table_;

  size_t index(int x, int y, int channel) const {
    return (size_t(y) * size_t(bitmap_.width) + size_t(x)) * size_t(bitmap_.channels) +
           size_t(channel);
  }
  float linear(int x, int y, int channel) const {
    size_t i = index(x, y, channel);
    if (bitmap_.type == Bitmap::Type::u8)
      return table_[bitmap_.bytes[i]];
    if (bitmap_.type == Bitmap::Type::u16) {
      uint16_t code;
      std::memcpy(&code, &bitmap_.bytes[2 * i], 2);
      return table_[code];
    }
    return bitmap_.linear(x, y, channel);
  }
};

} // namespace

const TextureStore::Texels& TextureStore::convert(const std::shared_ptr<const Bitmap>& bitmap,
                                                  bool raw, bool repeats) {
  for (const auto& t : texels_)
    if (t->raw == raw && t->repeats == repeats && t->source.lock() == bitmap)
      return *t;
  const Bitmap& b = *bitmap;
  check_bitmap(b);
  auto texels = std::make_unique<Texels>();
  texels->source = bitmap;
  texels->raw = raw;
  texels->repeats = repeats;
  bool bytes = b.type == Bitmap::Type::u8;
  if (bytes)
    texels->packed.assign(tile_texels(b) + kLanePadding, 0);
  else
    texels->rgba.assign(4 * tile_texels(b) + kLanePadding, 0.0f);
  Reader read(b, raw);
  auto within = [&](int i, int size) { return repeats ? i % size : std::min(i, size - 1); };
  int tiles_x = tiles(b.width), tiles_y = tiles(b.height);
  size_t to = 0;
  std::array<double, 3> sum{};
  for (int tile = 0; tile < tiles_x * tiles_y; ++tile)
    for (int k = 0; k < kTileTexels; ++k, ++to) {
      int i = k % kTileSide, j = k / kTileSide;
      int x = tile % tiles_x * kTileStep + i, y = tile / tiles_x * kTileStep + j;
      bool own = i < kTileStep && j < kTileStep && x < b.width && y < b.height;
      x = within(x, b.width);
      y = within(y, b.height);
      std::array<double, 3> rgb = read(x, y);
      for (int c = 0; c < 3; ++c)
        sum[c] += own ? rgb[c] : 0;
      if (bytes) {
        texels->packed[to] = read.packed(x, y);
      } else {
        for (int c = 0; c < 3; ++c)
          texels->rgba[4 * to + c] = static_cast<float>(rgb[c]);
        texels->rgba[4 * to + 3] = read.alpha(x, y);
      }
    }
  for (int c = 0; c < 3; ++c)
    texels->mean[c] = sum[c] / (double(b.width) * double(b.height));
  texels_.push_back(std::move(texels));
  return *texels_.back();
}

void TextureStore::add_bitmap(const TextureDesc& desc, TextureView& view,
                              std::array<double, 3>& mean) {
  if (!desc.bitmap)
    throw Error("a bitmap texture has no bitmap");
  const Texels& texels = convert(desc.bitmap, desc.raw, desc.wrap == WrapMode::repeat);
  view.type = texels.packed.empty() ? TextureType::bitmap_float : TextureType::bitmap8;
  view.width = desc.bitmap->width;
  view.height = desc.bitmap->height;
  view.tiles_x = tiles(view.width);
  view.srgb = view.type == TextureType::bitmap8 && desc.bitmap->srgb_encoded && !desc.raw;
  view.texels8 = texels.packed.data();
  view.texels = texels.rgba.data();
  mean = texels.mean;
}

int TextureStore::add(const TextureDesc& desc) {
  TextureView view{};
  view.type = desc.type;
  view.wrap = desc.wrap;
  view.nearest = desc.nearest;
  std::array<double, 3> mean = desc.color[0];
  int nesting = 0;
  for (int i = 0; i < 6; ++i) {
    if (!std::isfinite(desc.to_uv[i]))
      throw Error("to_uv of a texture holds a number that is not finite");
    view.to_uv[i] = static_cast<float>(desc.to_uv[i]);
  }
  for (int k = 0; k < 2; ++k) {
    view.child[k] = -1;
    for (int c = 0; c < 3; ++c) {
      if (!std::isfinite(desc.color[k][c]))
        throw Error("a colour of a texture is not finite");
      view.color[k][c] = static_cast<float>(desc.color[k][c]);
    }
  }
  if (desc.type == TextureType::bitmap8 || desc.type == TextureType::bitmap_float)
    add_bitmap(desc, view, mean);
  if (desc.type == TextureType::checkerboard) {
    mean = {};
    for (int k = 0; k < 2; ++k) {
      // A child was added before its parent, so that there are no cycles.
      if (desc.child[k] >= 0)
        check(desc.child[k], "checkerboard");
      if (desc.child[k] >= 0)
        nesting = std::max(nesting, nesting_[desc.child[k]] + 1);
      view.child[k] = std::max(desc.child[k], -1);
      const auto& part = view.child[k] >= 0 ? means_[view.child[k]] : desc.color[k];
      for (int c = 0; c < 3; ++c)
        mean[c] += 0.5 * part[c];
    }
  }
  if (nesting > kMaxNesting)
    throw Error("checkerboards are nested more than " + std::to_string(kMaxNesting) + " deep");
  nesting_.push_back(nesting);
  views_.push_back(view);
  means_.push_back(mean);
  return count() - 1;
}

void TextureStore::check(int texture, const char* user) const {
  if (texture < 0 || texture >= count())
    throw Error("texture " + std::to_string(texture) + " of the " + user + " does not exist");
}

size_t TextureStore::bytes() const {
  size_t total = views_.size() * sizeof(TextureView);
  for (const auto& t : texels_)
    total += t->packed.size() * 4 + t->rgba.size() * 4;
  return total;
}

} // namespace faceta
