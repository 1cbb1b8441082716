#pragma once

/// The textures of a scene as the kernels read them.

#include "base/huge_vector.h"
#include "scene/scene.h"

#include <memory>
#include <vector>

namespace faceta {

class TextureStore {
public:
  /// Adds a texture and returns its number. Throws Error for a bitmap that is missing, damaged or
  /// too large, and for children that have not been added before.
  int add(const TextureDesc& desc);

  int count() const { return static_cast<int>(views_.size()); }
  /// Throws Error unless a texture has this number; `user` names who asks.
  void check(int texture, const char* user) const;
  /// The mean linear colour over the unit square.
  const std::array<double, 3>& mean(int texture) const { return means_[texture]; }
  const std::vector<TextureView>& views() const { return views_; }
  size_t bytes() const;

private:
  /// Tiles of texels, shared by all textures of one bitmap.
  struct Texels {
    std::weak_ptr<const Bitmap> source;
    bool raw = false;
    bool repeats = false;        ///< after the last texel comes the first, not the last again
    HugeVector<uint32_t> packed; ///< R | G << 8 | B << 16 | A << 24
    HugeVector<float> rgba;
    std::array<double, 3> mean{};
  };

  const Texels& convert(const std::shared_ptr<const Bitmap>& bitmap, bool raw, bool repeats);
  void add_bitmap(const TextureDesc& desc, TextureView& view, std::array<double, 3>& mean);

  std::vector<TextureView> views_;
  std::vector<std::array<double, 3>> means_;
  std::vector<int> nesting_; ///< levels of textures below each
  std::vector<std::unique_ptr<Texels>> texels_;
};

} // namespace faceta
