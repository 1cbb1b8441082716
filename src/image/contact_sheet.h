#pragma once

/// Labelled contact sheets: rows of pictures with headings, drawn with the house's font.

#include "image/image.h"

#include <array>
#include <string>
#include <vector>

namespace faceta {

struct SheetCell {
  std::string title, label;
  Image picture; ///< linear R, G, B; all of one size
};

struct SheetRow {
  std::string heading, note;
  std::vector<SheetCell> cells;
};

/// Lengths in pixels, font sizes as draw_text() takes them, colours linear.
struct SheetStyle {
  using Rgb = std::array<float, 3>;
  double margin = 48, column_gap = 12, row_gap = 30;
  double title_height = 112, heading_height = 44, label_height = 50;
  Rgb background{}, border{}, title{}, subtitle{}, heading{}, note{}, cell_title{}, cell_label{};
  double title_size = 40, subtitle_size = 20, heading_size = 22, note_size = 16;
  double cell_title_size = 17, cell_label_size = 14;
};

/// The linear colour of "#rrggbb" (sRGB). Anything else is an Error.
SheetStyle::Rgb parse_hex_colour(const std::string& text);

/// One picture with everything on it.
Image compose_sheet(const std::string& title, const std::string& subtitle,
                    const std::vector<SheetRow>& rows, const SheetStyle& style);

} // namespace faceta
