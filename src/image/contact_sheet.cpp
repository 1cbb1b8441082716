#include "image/contact_sheet.h"

#include "base/error.h"
#include "image/font.h"
#include "image/tonemap.h"

#include <algorithm>

namespace faceta {

namespace {

void fill(Image& image, int x0, int y0, int x1, int y1, const SheetStyle::Rgb& rgb) {
  for (int y = std::max(0, y0); y < std::min(y1, image.height); ++y)
    for (int x = std::max(0, x0); x < std::min(x1, image.width); ++x)
      for (int c = 0; c < 3; ++c)
        image.data[(size_t(y) * image.width + x) * 3 + c] = rgb[c];
}

void paste(Image& sheet, const Image& picture, int x0, int y0) {
  Image rgb = picture.select({"R", "G", "B"});
  for (int y = 0; y < rgb.height; ++y)
    std::copy_n(&rgb.data[size_t(y) * rgb.width * 3], rgb.width * 3,
                &sheet.data[(size_t(y0 + y) * sheet.width + x0) * 3]);
}

/// Below this size thin strokes fade; heavier ones keep small text readable.
double stroke_weight(double size) {
  return size < 19 ? 0.085 : 0.07;
}

void draw_row(Image& sheet, const SheetRow& row, double y, int cell_width, int cell_height,
              const SheetStyle& s) {
  double x = draw_text(sheet, s.margin, y + s.heading_height - 16, s.heading_size, row.heading,
                       s.heading, 0.08);
  draw_text(sheet, x + 16, y + s.heading_height - 16, s.note_size, row.note, s.note,
            stroke_weight(s.note_size));
  int top = static_cast<int>(y + s.heading_height);
  for (size_t i = 0; i < row.cells.size(); ++i) {
    const SheetCell& cell = row.cells[i];
    int left = static_cast<int>(s.margin + double(i) * (cell_width + s.column_gap));
    fill(sheet, left - 1, top - 1, left + cell_width + 1, top + cell_height + 1, s.border);
    paste(sheet, cell.picture, left, top);
    double base = top + cell_height + 8 + s.cell_title_size;
    draw_text(sheet, left + 1, base, s.cell_title_size, cell.title, s.cell_title,
              stroke_weight(s.cell_title_size));
    draw_text(sheet, left + 1, base + s.cell_label_size + 6, s.cell_label_size, cell.label,
              s.cell_label, stroke_weight(s.cell_label_size));
  }
}

} // namespace

SheetStyle::Rgb parse_hex_colour(const std::string& text) {
  bool good = text.size() == 7 && text[0] == '#' &&
              text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
  if (!good)
    throw Error("'" + text + "' is not a colour", {}, "write #rrggbb");
  SheetStyle::Rgb rgb;
  for (int c = 0; c < 3; ++c)
    rgb[c] = static_cast<float>(
        srgb_to_linear(std::stoi(text.substr(1 + 2 * c, 2), nullptr, 16) / 255.0));
  return rgb;
}

Image compose_sheet(const std::string& title, const std::string& subtitle,
                    const std::vector<SheetRow>& rows, const SheetStyle& s) {
  size_t columns = 0;
  int cell_width = 0, cell_height = 0;
  for (const SheetRow& row : rows)
    for (const SheetCell& cell : row.cells) {
      columns = std::max(columns, row.cells.size());
      cell_width = std::max(cell_width, cell.picture.width);
      cell_height = std::max(cell_height, cell.picture.height);
    }
  if (columns == 0)
    throw Error("a contact sheet needs at least one picture");
  double row_height = s.heading_height + cell_height + s.label_height;
  Image sheet;
  sheet.channels = {"R", "G", "B"};
  sheet.width = static_cast<int>(2 * s.margin + double(columns) * cell_width +
                                 double(columns - 1) * s.column_gap);
  sheet.height = static_cast<int>(s.margin + s.title_height + double(rows.size()) * row_height +
                                  double(rows.size() - 1) * s.row_gap + s.margin);
  sheet.data.resize(size_t(sheet.width) * sheet.height * 3);
  fill(sheet, 0, 0, sheet.width, sheet.height, s.background);
  draw_text(sheet, s.margin, s.margin + s.title_size * 0.8, s.title_size, title, s.title, 0.075);
  draw_text(sheet, s.margin, s.margin + s.title_size * 0.8 + s.subtitle_size * 1.9, s.subtitle_size,
            subtitle, s.subtitle, 0.07);
  double y = s.margin + s.title_height;
  for (const SheetRow& row : rows) {
    draw_row(sheet, row, y, cell_width, cell_height, s);
    y += row_height + s.row_gap;
  }
  return sheet;
}

} // namespace faceta
