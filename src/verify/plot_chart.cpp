#include "verify/plot_chart.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace faceta {

namespace {

constexpr double kTickSize = 13, kLabelSize = 13, kCaptionSize = 12;

} // namespace

PlotPoints circle(const Vec2<double>& centre, double radius) {
  PlotPoints points;
  int n = std::clamp(int(radius), 12, 72);
  for (int i = 0; i < n; ++i)
    points.push_back({centre.x + radius * std::cos(2 * kPi * i / n),
                      centre.y + radius * std::sin(2 * kPi * i / n)});
  return points;
}

void draw_arrow(Drawing& drawing, const Vec2<double>& from, const Vec2<double>& to, Ink ink,
                double width) {
  double length = std::hypot(to.x - from.x, to.y - from.y);
  double head = std::min(3.5 * width + 3, length);
  Vec2<double> d{(to.x - from.x) / length, (to.y - from.y) / length};
  Vec2<double> neck{to.x - head * d.x, to.y - head * d.y};
  drawing.line({from, neck}, ink, width);
  double half = 0.38 * head;
  drawing.area(
      {to, {neck.x - half * d.y, neck.y + half * d.x}, {neck.x + half * d.y, neck.y - half * d.x}},
      ink);
}

std::vector<std::string> wrap_text(const std::string& text, double size, double width) {
  std::vector<std::string> lines;
  std::string line;
  auto flush = [&] {
    if (!line.empty())
      lines.push_back(line);
    line.clear();
  };
  for (size_t begin = 0; begin < text.size();) {
    size_t end = std::min(text.find(' ', begin), text.size());
    std::string word = text.substr(begin, end - begin);
    begin = end + 1;
    if (!line.empty() && plot_text_width(line + " " + word, size) > width)
      flush();
    while (plot_text_width(word, size) > width && word.size() > 1) {
      size_t fit = word.size() - 1;
      // Never inside a character of several bytes.
      while (fit > 1 && ((static_cast<unsigned char>(word[fit]) & 0xc0) == 0x80 ||
                         plot_text_width(word.substr(0, fit), size) > width))
        --fit;
      lines.push_back(word.substr(0, fit));
      word.erase(0, fit);
    }
    line += (line.empty() ? "" : " ") + word;
  }
  flush();
  return lines;
}

void draw_note(Drawing& drawing, const PlotBox& box, const std::string& text) {
  std::vector<std::string> lines = wrap_text(text, kLabelSize, 0.86 * box.width);
  double y = box.y + box.height / 2 - 9.0 * (double(lines.size()) - 1) + 4;
  for (const std::string& line : lines) {
    drawing.label({{box.x + box.width / 2, y},
                   line,
                   kLabelSize,
                   PlotLabel::middle,
                   {Ink::muted},
                   false,
                   true});
    y += 18;
  }
}

// --- Panels ---

PlotPanel::PlotPanel(Drawing& drawing, const PlotBox& outer, const PlotAxis& x, const PlotAxis& y,
                     bool grid)
    : drawing_(drawing), x_(x), y_(y) {
  double left = 0;
  for (double t : y.ticks)
    left = std::max(left, plot_text_width(short_number(t), kTickSize));
  left += 7;
  // The last tick of x stands half beyond the frame.
  double right = std::max(4.0, plot_text_width(short_number(x.ticks.back()), kTickSize) / 2);
  double top = y.label.empty() ? 8 : 24, bottom = x.label.empty() ? 22 : 42;
  box_ = {outer.x + left, outer.y + top, outer.width - left - right, outer.height - top - bottom};
  if (!y.label.empty())
    drawing.label({{outer.x, outer.y + 13}, y.label, kLabelSize});
  if (!x.label.empty())
    drawing.label(
        {{box_.x + box_.width / 2, outer.bottom() - 5}, x.label, kLabelSize, PlotLabel::middle});
  for (double t : x.ticks) {
    double at = place(t, y.low).x;
    if (grid)
      drawing.line({{at, box_.y}, {at, box_.bottom()}}, {Ink::grid});
    drawing.line({{at, box_.bottom()}, {at, box_.bottom() + 4}}, {Ink::muted});
    drawing.label(
        {{at, box_.bottom() + 18}, short_number(t), kTickSize, PlotLabel::middle, {Ink::muted}});
  }
  for (double t : y.ticks) {
    double at = place(x.low, t).y;
    if (grid)
      drawing.line({{box_.x, at}, {box_.right(), at}}, {Ink::grid});
    drawing.line({{box_.x - 4, at}, {box_.x, at}}, {Ink::muted});
    drawing.label(
        {{box_.x - 7, at + 4.5}, short_number(t), kTickSize, PlotLabel::end, {Ink::muted}});
  }
  drawing.line({{box_.x, box_.y}, {box_.x, box_.bottom()}, {box_.right(), box_.bottom()}},
               {Ink::muted});
}

Vec2<double> PlotPanel::place(double x, double y) const {
  return {box_.x + box_.width * x_.position(x), box_.bottom() - box_.height * y_.position(y)};
}

void PlotPanel::curve(const PlotPoints& points, Ink ink, double width, int dash) {
  PlotPoints line;
  auto flush = [&] {
    if (line.size() > 1)
      drawing_.line(line, ink, width, dash);
    line.clear();
  };
  for (const Vec2<double>& p : points)
    if (std::isfinite(p.y))
      line.push_back(place(p.x, p.y));
    else
      flush();
  flush();
}

void PlotPanel::band(const PlotPoints& low, const PlotPoints& high, Ink ink, double opacity) {
  PlotPoints outline;
  for (const Vec2<double>& p : low)
    outline.push_back(place(p.x, p.y));
  for (size_t i = high.size(); i-- > 0;)
    outline.push_back(place(high[i].x, high[i].y));
  drawing_.area(std::move(outline), ink, opacity);
}

void PlotPanel::picture(int width, int height, const std::vector<double>& shares) {
  drawing_.items.emplace_back(
      PlotPicture{{box_.x, box_.y}, {box_.width, box_.height}, ramp_pixels(width, height, shares)});
}

void PlotPanel::note(const std::string& text) {
  draw_note(drawing_, box_, text);
}

Image ramp_pixels(int width, int height, const std::vector<double>& shares) {
  Image image(width, height, {"R", "G", "B", "A"});
  for (size_t i = 0; i < shares.size(); ++i) {
    std::array<float, 3> rgb = ramp_colour(shares[i]);
    std::copy(rgb.begin(), rgb.end(), &image.data[4 * i]);
    image.data[4 * i + 3] = std::isnan(shares[i]) ? 0.0f : 1.0f;
  }
  return image;
}

void draw_colour_bar(Drawing& drawing, const PlotBox& box, const PlotAxis& axis) {
  constexpr int kSteps = 64;
  std::vector<double> shares(kSteps);
  for (int i = 0; i < kSteps; ++i)
    shares[i] = (i + 0.5) / kSteps;
  double margin = 0;
  for (double t : {axis.ticks.front(), axis.ticks.back()})
    margin = std::max(margin, plot_text_width(short_number(t), kTickSize) / 2);
  double x = box.x + margin, width = box.width - 2 * margin, y = box.y + 19;
  drawing.label({{box.x + box.width / 2, box.y + 12}, axis.label, kLabelSize, PlotLabel::middle});
  drawing.items.emplace_back(PlotPicture{{x, y}, {width, 11}, ramp_pixels(kSteps, 1, shares)});
  for (double t : axis.ticks) {
    double at = x + width * axis.position(t);
    drawing.line({{at, y + 11}, {at, y + 15}}, {Ink::muted});
    drawing.label({{at, y + 28}, short_number(t), kTickSize, PlotLabel::middle, {Ink::muted}});
  }
}

// --- The page ---

namespace {

constexpr double kMargin = 14, kSample = 24, kLineHeight = 18, kCaptionLine = 16;

/// Where each entry of a legend stands, wrapped like words.
struct LegendLayout {
  std::vector<Vec2<double>> places;
  std::vector<std::vector<std::string>> lines;
  double height = 0;
};

LegendLayout lay_out(const std::vector<LegendEntry>& legend, double width) {
  LegendLayout layout;
  double x = 0, y = 0, row = 0;
  for (const LegendEntry& entry : legend) {
    auto lines = wrap_text(entry.label, kLabelSize, width - kSample - 8);
    double longest = 0;
    for (const std::string& line : lines)
      longest = std::max(longest, plot_text_width(line, kLabelSize));
    double needed = kSample + 6 + longest;
    if (x > 0 && x + needed > width)
      x = 0, y += row, row = 0;
    layout.places.push_back({x, y});
    x += needed + 16;
    row = std::max(row, kLineHeight * double(lines.size()));
    layout.lines.push_back(std::move(lines));
  }
  layout.height = legend.empty() ? 0 : y + row + 6;
  return layout;
}

} // namespace

PlotBox begin_page(Drawing& drawing, const PlotPage& page, double width, double height,
                   double box_height) {
  double inner = width - 2 * kMargin;
  auto title = wrap_text(page.title, 16 * 1.1, inner);
  auto subtitle = wrap_text(page.subtitle, kLabelSize, inner);
  LegendLayout legend = lay_out(page.legend, inner);
  std::vector<std::string> caption;
  for (const std::string& paragraph : page.caption)
    for (const std::string& line : wrap_text(paragraph, kCaptionSize, inner))
      caption.push_back(line);
  double above = 10 + 21 * double(title.size()) + kLineHeight * double(subtitle.size()) + 8;
  double below = 8 + legend.height + kCaptionLine * double(caption.size()) + 10;
  if (height > 0 && height - above - below < box_height / 3)
    throw Error(fmt::format("a height of {:.0f} leaves too little for the chart", height), {},
                fmt::format("at this width at least {:.0f}, better {:.0f}",
                            std::ceil(above + below + box_height / 3),
                            std::ceil(above + below + box_height)));
  drawing.width = width;
  drawing.height = std::ceil(height > 0 ? height : above + box_height + below);
  drawing.title = page.subtitle.empty() ? page.title : page.title + ": " + page.subtitle;
  for (const std::string& paragraph : page.caption)
    drawing.description += (drawing.description.empty() ? "" : " ") + paragraph;

  double y = 10;
  for (const std::string& line : title)
    drawing.label({{kMargin, (y += 21) - 5}, line, 16, PlotLabel::start, {Ink::text}, true});
  for (const std::string& line : subtitle)
    drawing.label(
        {{kMargin, (y += kLineHeight) - 4}, line, kLabelSize, PlotLabel::start, {Ink::muted}});
  PlotBox box{kMargin, above, inner, drawing.height - above - below};
  y = box.bottom() + 8;
  for (size_t i = 0; i < page.legend.size(); ++i) {
    Vec2<double> at{kMargin + legend.places[i].x, y + legend.places[i].y};
    drawing.line({{at.x, at.y + 9}, {at.x + kSample, at.y + 9}}, page.legend[i].ink, 2.4,
                 page.legend[i].dash);
    for (size_t k = 0; k < legend.lines[i].size(); ++k)
      drawing.label({{at.x + kSample + 6, at.y + 13.5 + kLineHeight * double(k)},
                     legend.lines[i][k],
                     kLabelSize});
  }
  y += legend.height;
  for (const std::string& line : caption)
    drawing.label(
        {{kMargin, (y += kCaptionLine) - 4}, line, kCaptionSize, PlotLabel::start, {Ink::muted}});
  return box;
}

} // namespace faceta
