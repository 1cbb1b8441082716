#pragma once

/// What charts are made of: ticks, axes, panels, colour bars, legends and the page around them.

#include "verify/plot_drawing.h"

#include <functional>

namespace faceta {

using PlotPoints = std::vector<Vec2<double>>;

/// A rectangle in a drawing.
struct PlotBox {
  double x = 0, y = 0, width = 0, height = 0;
  double right() const { return x + width; }
  double bottom() const { return y + height; }
};

/// A number with at most three digits that matter: "0.25", "1e-6", "2500".
std::string short_number(double value);

/// A range of values with marks at round numbers.
struct PlotAxis {
  std::string label; ///< with its unit
  double low = 0, high = 1;
  bool logarithmic = false;
  std::vector<double> ticks;

  /// 0 at the low end, 1 at the high end; clamped.
  double position(double value) const;
};

/// Ticks at multiples of 1, 2 or 5 times a power of ten, at most `most` >= 2 steps; the ends are
/// widened to ticks. Not both ends may be equal.
PlotAxis linear_axis(std::string label, double low, double high, int most);
/// Ticks at powers of ten (0 < low < high), every one or every few of them; the ends are widened to
/// powers of ten.
PlotAxis logarithmic_axis(std::string label, double low, double high, int most);
/// 0 to `high` degrees, ticks every 15, 30 or 45.
PlotAxis degree_axis(std::string label, double high, int most);

/// A rectangle with two axes.
class PlotPanel {
public:
  /// Draws frame, grid, ticks and labels so that all of it lies inside `outer`; the label of y
  /// stands above it, level and not turned.
  PlotPanel(Drawing& drawing, const PlotBox& outer, const PlotAxis& x, const PlotAxis& y,
            bool grid = true);

  const PlotBox& box() const { return box_; }
  Vec2<double> place(double x, double y) const;
  void curve(const PlotPoints& points, Ink ink, double width = 1.8, int dash = 0);
  /// The area between two curves over the same x.
  void band(const PlotPoints& low, const PlotPoints& high, Ink ink, double opacity);
  /// Values in [0, 1] over the whole panel by the colour ramp, NaN is left out; row 0 is at the top
  /// of the picture.
  void picture(int width, int height, const std::vector<double>& shares);
  /// A sentence in the middle, instead of data.
  void note(const std::string& text);

private:
  Drawing& drawing_;
  PlotAxis x_, y_;
  PlotBox box_;
};

/// Pixels of values in [0, 1] by the colour ramp; NaN is transparent.
Image ramp_pixels(int width, int height, const std::vector<double>& shares);

/// A level bar of the colour ramp with the ticks of an axis, its label above; kColourBarHeight
/// high.
inline constexpr double kColourBarHeight = 52;
void draw_colour_bar(Drawing& drawing, const PlotBox& box, const PlotAxis& axis);

/// A closed circle.
PlotPoints circle(const Vec2<double>& centre, double radius);
/// A line with a head at its end.
void draw_arrow(Drawing& drawing, const Vec2<double>& from, const Vec2<double>& to, Ink ink,
                double width);
/// A sentence in the middle of a box, instead of data; broken into lines.
void draw_note(Drawing& drawing, const PlotBox& box, const std::string& text);

/// Breaks text at spaces into lines of at most `width`; a word that is wider is broken itself.
std::vector<std::string> wrap_text(const std::string& text, double size, double width);

struct LegendEntry {
  std::string label;
  Ink ink;
  int dash = 0;
};

/// What stands around the panels.
struct PlotPage {
  std::string title, subtitle;
  std::vector<LegendEntry> legend;
  std::vector<std::string> caption; ///< paragraphs
};

/// Begins a drawing: title above, legend and caption below the box that is returned.
/// \param width of the drawing
/// \param height of the drawing; 0: so that the box is `box_height` high.
/// Error if the height leaves less than a third of box_height to the box.
PlotBox begin_page(Drawing& drawing, const PlotPage& page, double width, double height,
                   double box_height);

} // namespace faceta
