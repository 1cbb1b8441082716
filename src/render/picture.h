#pragma once

/// From a finished film to the picture a scene file asks for.

#include "render/render.h"

namespace faceta {

/// What a picture says about how it came to be (EXR attributes).
struct PictureFacts {
  std::string scene, version, command;
  uint32_t seed = 0;
};

/// The channels of the film's pixel_format (luminance, luminance_alpha, rgb, rgba, xyz, xyza),
/// behind them those of a moment integrator (name.X .Y .Z: the mean; m2_name.X .Y .Z: the mean of
/// squares), with typed metadata: scene, spp, seed, time (seconds), version, ...
Image make_picture(const RenderResult& result, const FilmDesc& film,
                   const IntegratorDesc& integrator, const PictureFacts& facts);

/// A picture of R, G, B for formats and viewers that know nothing else.
Image rgb_picture(const RenderResult& result);

} // namespace faceta
