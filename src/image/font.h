#pragma once

#include "image/image.h"

#include <array>
#include <string_view>

namespace faceta {

/// Faceta's own stroke font: a light geometric sans, drawn as round-ended lines. It has printable
/// ASCII and – — − · × ± ° ² ³ α β γ δ ε η θ κ λ µ μ ν π ρ σ τ φ ω á é í ó ú ñ ä ö ü Å ı; any other
/// character shows as an empty box.
///
/// `height` is the font size in pixels: capitals are kFontCapHeight of it tall, letters reach at
/// most kFontDescent below the base line.
inline constexpr double kFontCapHeight = 0.70, kFontDescent = 0.22, kFontLineHeight = 1.30;

/// Width in pixels of UTF-8 text on one line at a font size.
double text_width(std::string_view text, double height);

/// Draws UTF-8 text with its left edge at x and its base line at y (pixels, fractions welcome;
/// pixel (0, 0) covers [0, 1) x [0, 1)). '\n' begins a new line kFontLineHeight further down. Each
/// pixel is mixed towards `rgb` (linear) by its coverage; an alpha channel is mixed towards 1; what
/// falls outside is cut.
/// \param weight stroke width as a share of height: 0.045 very light, 0.065 light, 0.09 medium
/// \return x behind the last character. Error if the image has no R, G, B.
double draw_text(Image& image, double x, double y, double height, std::string_view text,
                 const std::array<float, 3>& rgb, double weight = 0.065);

} // namespace faceta
