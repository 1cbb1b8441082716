#pragma once

/// Drawings, apart from how they are shown: a list of lines, areas, texts and small pictures that
/// becomes SVG text or pixels. Coordinates are CSS pixels, y downwards.

#include "base/vec.h"
#include "image/image.h"

#include <string>
#include <variant>
#include <vector>

namespace faceta {

/// What something is drawn for; the theme gives it its colour.
struct Ink {
  enum Role { none, background, text, muted, grid, series } role = none;
  int index = 0; ///< of a series, from 0; colours repeat after kSeriesColours
};
inline constexpr int kSeriesColours = 7;
inline Ink series_ink(int index) {
  return {Ink::series, index};
}

/// A polyline, or a filled area with a border.
struct PlotLine {
  std::vector<Vec2<double>> points;
  Ink stroke;
  double width = 1;
  int dash = 0; ///< 0: solid; others: patterns, which repeat after kDashes
  Ink fill{};
  double opacity = 1; ///< of the fill
  bool closed = false;
};
inline constexpr int kDashes = 5;
/// Lengths of strokes and gaps; empty for a solid line.
const std::vector<double>& dash_pattern(int dash);

struct PlotLabel {
  enum Anchor { start, middle, end };
  Vec2<double> at; ///< on the base line
  std::string text;
  double size = 13;
  Anchor anchor = start;
  Ink ink{Ink::text};
  bool bold = false;
  bool halo = false; ///< a rim of background around it, to stand on top of lines
};

/// Pixels stretched over a rectangle, interpolated between their centres.
struct PlotPicture {
  Vec2<double> corner, size; ///< upper left; width and height
  Image pixels;              ///< linear R, G, B, A
};

struct Drawing {
  double width = 0, height = 0;
  std::string title, description; ///< for those who do not see it
  std::vector<std::variant<PlotLine, PlotLabel, PlotPicture>> items;

  void line(std::vector<Vec2<double>> points, Ink stroke, double width = 1, int dash = 0) {
    items.emplace_back(PlotLine{std::move(points), stroke, width, dash});
  }
  void area(std::vector<Vec2<double>> points, Ink fill, double opacity = 1) {
    items.emplace_back(PlotLine{std::move(points), {}, 0, 0, fill, opacity, true});
  }
  void label(PlotLabel label) { items.emplace_back(std::move(label)); }
};

/// The rules that drawings with PlotTheme::page need in their page's style sheet: what stands
/// inside of an element of the class "plot" follows the reader's light or dark colours.
std::string page_plot_style();

/// Width of a text in most sans-serif fonts, rather too wide than too narrow.
double plot_text_width(const std::string& text, double size, bool bold = false);

/// Whose colours: by the reader's system (SVG; light in print and in pixels), or always the same.
/// page: of a page that holds many drawings and page_plot_style() once; the elements are shorter,
/// and curves are rounded to a tenth of a pixel.
enum class PlotTheme { automatic, light, dark, page };

/// "#rrggbb" of an ink; empty for none.
std::string ink_colour(Ink ink, bool dark);

/// A complete <svg> element, to be written to a file or embedded in HTML as it is: it is as wide as
/// the drawing but shrinks to the width of what it stands in.
/// \param id prefix of every id inside; must be unlike any other in the page. Empty: made from the
/// content, so that different drawings have different ones.
/// \param display_width its width in CSS pixels; 0: the drawing's own
std::string to_svg(const Drawing& drawing, const std::string& id = {},
                   PlotTheme theme = PlotTheme::automatic, double display_width = 0);

/// The drawing in linear R, G, B.
/// \param width in pixels; the height follows
Image to_image(const Drawing& drawing, int width, PlotTheme theme = PlotTheme::light);

/// A colour ramp whose lightness grows evenly from night blue to pale yellow, so that it can be
/// told apart by everyone and in grey print: equal steps in OKLab (Ottosson 2020, "A perceptual
/// color space for image processing").
/// \param x in [0, 1]; clamped
/// \return linear R, G, B
std::array<float, 3> ramp_colour(double x);

} // namespace faceta
