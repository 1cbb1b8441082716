#pragma once

#include "image/image.h"
#include "verify/fit_data.h"

namespace faceta {

/// A map of residuals as a picture of linear R, G, B, `scale` pixels a cell: theta_d from left (0)
/// to right (90 degrees), theta_h from the bottom (0) to the top, in the grid's own steps. Blue
/// where the fit is too dark, red where it is too bright, white where it agrees, full at +-range;
/// grey where no direction is. @throws Error if range is not positive or scale not in [1, 64].
Image draw_fit_map(std::span<const double> values, double range, int scale = 8);

} // namespace faceta
