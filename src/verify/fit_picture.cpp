#include "verify/fit_picture.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>

namespace faceta {

Image draw_fit_map(std::span<const double> values, double range, int scale) {
  constexpr int n = FitMap::kSize;
  if (!(range > 0) || scale < 1 || scale > 64)
    throw Error("a residual map needs a positive range and 1 to 64 pixels a cell");
  if (values.size() != size_t(n) * n)
    throw Error("a residual map has 45 x 45 values");
  Image image(n * scale, n * scale);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      double v = values[size_t(n - 1 - y / scale) * n + size_t(x / scale)];
      float rgb[3] = {0.2f, 0.2f, 0.2f};
      if (std::isfinite(v)) {
        auto t = static_cast<float>(std::clamp(v / range, -1.0, 1.0));
        float fade = 1 - 0.9f * std::abs(t);
        rgb[0] = t > 0 ? 1 : fade;
        rgb[1] = fade;
        rgb[2] = t < 0 ? 1 : fade;
      }
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = rgb[c];
    }
  return image;
}

} // namespace faceta
