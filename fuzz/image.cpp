// An image file, and the texture and environment that a scene makes of it.

#include "fuzz.h"
#include "image/codecs.h"
#include "scene/scene.h"

#include <cstring>

using namespace faceta;

namespace {

void check(const codec::Decoded& in) {
  const Bitmap& b = in.bitmap;
  fuzz::require(b.width > 0 && b.height > 0 && b.channels > 0, "a picture has pixels");
  fuzz::require(b.channel_names.size() == size_t(b.channels), "every channel has a name");
  fuzz::require(b.bytes.size() == size_t(b.width) * size_t(b.height) * size_t(b.channels) *
                                      size_t(Bitmap::size_of(b.type)),
                "the bytes fit the size");
  for (int channel = 0; channel < b.channels; ++channel)
    b.linear(b.width - 1, b.height - 1, channel);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  codec::Decoded in;
  if (!fuzz::accepts([&] { in = codec::decode({data, size}, "image"); }))
    return 0;
  check(in);
  if (in.bitmap.bytes.size() > 1 << 16)
    return 0;
  Scene scene;
  try {
    TextureDesc texture;
    texture.bitmap = std::make_shared<Bitmap>(in.bitmap);
    texture.type =
        in.bitmap.type == Bitmap::Type::u8 ? TextureType::bitmap8 : TextureType::bitmap_float;
    scene.add_texture(texture);
  } catch (const Error&) {
  }
  try {
    auto image =
        std::make_shared<Image>(in.bitmap.width, in.bitmap.height, in.bitmap.channel_names);
    for (int y = 0; y < image->height; ++y)
      for (int x = 0; x < image->width; ++x)
        for (int c = 0; c < image->channel_count(); ++c)
          image->at(x, y, c) = in.bitmap.linear(x, y, c);
    EnvironmentDesc environment;
    environment.image = image;
    scene.set_environment(environment);
  } catch (const Error&) {
  }
  return 0;
}
