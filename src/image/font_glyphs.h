#pragma once

#include <span>

namespace faceta::font {

/// One character of the stroke font. Units: 100 to the font size, y up, base line 0, capitals 70,
/// small letters 48, descenders -20. `left` and `right` are the bearings beside [0, width].
///
/// `path` is a list of operations on the pen's centre line, numbers separated by blanks:
///   M x y                 begins a stroke
///   L x y                 a line
///   C x1 y1 x2 y2 x y     a cubic Bezier curve
///   A cx cy rx ry a0 a1   an arc from angle a0 to a1 (degrees, counter-clockwise from +x); joins
///   the
///                         stroke by a line, or begins one
///   D x y                 a dot, somewhat thicker than the pen
///   G code scale x y      another character, scaled and moved; ends the stroke
struct Glyph {
  char32_t code;
  float width, left, right;
  const char* path;
};

/// Every glyph, ordered by code.
std::span<const Glyph> glyphs();

/// What stands for a character that the font lacks: an empty box.
const Glyph& missing_glyph();

} // namespace faceta::font
