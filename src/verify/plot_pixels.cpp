#include "image/contact_sheet.h"
#include "image/font.h"
#include "verify/plot_drawing.h"

#include <algorithm>
#include <cmath>

namespace faceta {

namespace {

using Points = std::vector<Vec2<double>>;

double distance_to(const Vec2<double>& p, const Vec2<double>& a, const Vec2<double>& b) {
  double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
  double t = square > 0 ? ((p.x - a.x) * dx + (p.y - a.y) * dy) / square : 0;
  t = std::clamp(t, 0.0, 1.0);
  return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

/// The strokes of a dashed line.
std::vector<Points> cut(const Points& line, const std::vector<double>& pattern, double scale) {
  if (pattern.empty())
    return {line};
  std::vector<Points> strokes = {{line.front()}};
  size_t step = 0;
  double left = pattern[0] * scale;
  for (size_t i = 1; i < line.size(); ++i) {
    Vec2<double> at = line[i - 1];
    double length = std::hypot(line[i].x - at.x, line[i].y - at.y);
    while (length > left) {
      double t = left / length;
      at = {at.x + t * (line[i].x - at.x), at.y + t * (line[i].y - at.y)};
      length -= left;
      if (step % 2 == 0)
        strokes.back().push_back(at);
      else
        strokes.push_back({at});
      step = (step + 1) % pattern.size();
      left = pattern[step] * scale;
    }
    left -= length;
    if (step % 2 == 0)
      strokes.back().push_back(line[i]);
  }
  return strokes;
}

/// Draws into an image of linear R, G, B, everything by the share of a pixel it covers.
class PixelWriter {
public:
  PixelWriter(Image& image, double scale, bool dark)
      : image_(image), scale_(scale), dark_(dark), cover_(image.pixel_count()) {}

  void write(const PlotLine& line) {
    Points points = line.points;
    for (Vec2<double>& p : points)
      p = {p.x * scale_, p.y * scale_};
    if (points.empty())
      return;
    if (line.fill.role != Ink::none) {
      fill(points);
      blend(line.fill, line.opacity);
    }
    if (line.stroke.role == Ink::none)
      return;
    if (line.closed)
      points.push_back(points.front());
    for (const Points& stroke : cut(points, dash_pattern(line.dash), scale_))
      for (size_t i = 1; i < stroke.size(); ++i)
        stroke_segment(stroke[i - 1], stroke[i], line.width * scale_ / 2);
    blend(line.stroke, 1);
  }

  void write(const PlotLabel& label) {
    double size = label.size * scale_, width = text_width(label.text, size);
    double x = label.at.x * scale_ - (label.anchor == PlotLabel::middle ? width / 2
                                      : label.anchor == PlotLabel::end  ? width
                                                                        : 0);
    double weight = label.bold ? 0.105 : 0.075;
    if (label.halo)
      draw_text(image_, x, label.at.y * scale_, size, label.text, colour({Ink::background}),
                weight + 3.5 / label.size);
    draw_text(image_, x, label.at.y * scale_, size, label.text, colour(label.ink), weight);
  }

  void write(const PlotPicture& picture) {
    const Image& source = picture.pixels;
    double x0 = picture.corner.x * scale_, y0 = picture.corner.y * scale_;
    double w = picture.size.x * scale_, h = picture.size.y * scale_;
    for (int y = std::max(0, int(y0)); y < std::min(double(image_.height), y0 + h); ++y)
      for (int x = std::max(0, int(x0)); x < std::min(double(image_.width), x0 + w); ++x) {
        // The share of the pixel inside, and the source's value at its centre.
        double inside = overlap(x, x0, x0 + w) * overlap(y, y0, y0 + h);
        std::array<double, 4> c = interpolate(source, (x + 0.5 - x0) / w * source.width - 0.5,
                                              (y + 0.5 - y0) / h * source.height - 0.5);
        float* pixel = &image_.data[image_.offset(x, y)];
        for (int k = 0; k < 3; ++k)
          pixel[k] = float(pixel[k] + inside * (c[k] - c[3] * pixel[k]));
      }
  }

private:
  static double overlap(int cell, double low, double high) {
    return std::clamp(std::min(cell + 1.0, high) - std::max(double(cell), low), 0.0, 1.0);
  }

  /// Bilinear, premultiplied by alpha.
  static std::array<double, 4> interpolate(const Image& source, double x, double y) {
    std::array<double, 4> sum{};
    int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    for (int dy = 0; dy < 2; ++dy)
      for (int dx = 0; dx < 2; ++dx) {
        double weight = (dx ? x - x0 : 1 - (x - x0)) * (dy ? y - y0 : 1 - (y - y0));
        size_t at = source.offset(std::clamp(x0 + dx, 0, source.width - 1),
                                  std::clamp(y0 + dy, 0, source.height - 1));
        double alpha = weight * source.data[at + 3];
        for (int k = 0; k < 3; ++k)
          sum[k] += alpha * source.data[at + k];
        sum[3] += alpha;
      }
    return sum;
  }

  std::array<float, 3> colour(Ink ink) const { return parse_hex_colour(ink_colour(ink, dark_)); }

  void touch(int x0, int y0, int x1, int y1) {
    left_ = std::min(left_, x0), right_ = std::max(right_, x1);
    top_ = std::min(top_, y0), bottom_ = std::max(bottom_, y1);
  }

  void stroke_segment(const Vec2<double>& a, const Vec2<double>& b, double radius) {
    double reach = radius + 1;
    int x0 = std::max(0, int(std::floor(std::min(a.x, b.x) - reach)));
    int y0 = std::max(0, int(std::floor(std::min(a.y, b.y) - reach)));
    int x1 = std::min(image_.width, int(std::ceil(std::max(a.x, b.x) + reach)));
    int y1 = std::min(image_.height, int(std::ceil(std::max(a.y, b.y) + reach)));
    touch(x0, y0, x1, y1);
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        double c = std::clamp(radius + 0.5 - distance_to({x + 0.5, y + 0.5}, a, b), 0.0, 1.0);
        // Strokes thinner than a pixel are paler instead.
        float& cover = cover_[size_t(y) * image_.width + x];
        cover = std::max(cover, float(std::min(c, 2 * radius)));
      }
  }

  /// Even-odd, with exact coverage along x on four lines a pixel.
  void fill(const Points& points) {
    constexpr int kLines = 4;
    double top = image_.height, bottom = 0;
    for (const Vec2<double>& p : points)
      top = std::min(top, p.y), bottom = std::max(bottom, p.y);
    int y0 = std::max(0, int(std::floor(top))), y1 = std::min(image_.height, int(bottom) + 1);
    touch(0, y0, image_.width, y1);
    std::vector<double> crossings;
    for (int line = y0 * kLines; line < y1 * kLines; ++line) {
      double y = (line + 0.5) / kLines;
      crossings.clear();
      for (size_t i = 0; i < points.size(); ++i) {
        const Vec2<double>&a = points[i], &b = points[(i + 1) % points.size()];
        if ((a.y <= y) != (b.y <= y))
          crossings.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
      }
      std::sort(crossings.begin(), crossings.end());
      float* row = &cover_[size_t(line / kLines) * image_.width];
      for (size_t i = 0; i + 1 < crossings.size(); i += 2)
        for (int x = std::max(0, int(crossings[i]));
             x < std::min(double(image_.width), crossings[i + 1]); ++x)
          row[x] += float(overlap(x, crossings[i], crossings[i + 1]) / kLines);
    }
  }

  /// Mixes the ink in by what was covered, and clears that.
  void blend(Ink ink, double opacity) {
    std::array<float, 3> rgb = colour(ink);
    for (int y = top_; y < bottom_; ++y)
      for (int x = left_; x < right_; ++x) {
        float& cover = cover_[size_t(y) * image_.width + x];
        float* pixel = &image_.data[image_.offset(x, y)];
        float share = float(std::min(1.0f, cover) * opacity);
        for (int k = 0; k < 3; ++k)
          pixel[k] += share * (rgb[k] - pixel[k]);
        cover = 0;
      }
    left_ = top_ = kMaxDimension, right_ = bottom_ = 0;
  }

  Image& image_;
  double scale_;
  bool dark_;
  std::vector<float> cover_;
  int left_ = kMaxDimension, top_ = kMaxDimension, right_ = 0, bottom_ = 0;
};

} // namespace

Image to_image(const Drawing& drawing, int width, PlotTheme theme) {
  double scale = width / drawing.width;
  bool dark = theme == PlotTheme::dark;
  Image image(width, std::max(1, int(std::lround(drawing.height * scale))));
  std::array<float, 3> ground = parse_hex_colour(ink_colour({Ink::background}, dark));
  for (size_t i = 0; i < image.data.size(); ++i)
    image.data[i] = ground[i % 3];
  PixelWriter writer(image, scale, dark);
  for (const auto& item : drawing.items)
    std::visit([&](const auto& i) { writer.write(i); }, item);
  return image;
}

} // namespace faceta
