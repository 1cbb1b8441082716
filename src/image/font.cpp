#include "image/font.h"

#include "base/error.h"
#include "image/font_glyphs.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>

namespace faceta {
namespace {

struct Point {
  double x = 0, y = 0;
};

/// A straight piece of the pen's way; `thickness` multiplies the pen's radius.
struct Segment {
  Point a, b;
  double thickness = 1;
};

constexpr double kUnits = 100;
/// Dots of the pen's own width look too small beside its strokes.
constexpr double kDotThickness = 1.35;

/// Turns a glyph's path into straight segments.
class PathReader {
public:
  PathReader(std::vector<Segment>& out, double scale, Point origin)
      : out_(out), scale_(scale), origin_(origin) {}

  void read(const char* path) {
    for (at_ = path; *at_ != 0;) {
      const char op = *at_++;
      switch (op) {
      case ' ':
        break;
      case 'M':
        begin(point());
        break;
      case 'L':
        line(point());
        break;
      case 'C':
        cubic();
        break;
      case 'A':
        arc();
        break;
      case 'D':
        dot(point());
        break;
      case 'G':
        glyph();
        break;
      default:
        std::abort(); // a mistake in our own table
      }
    }
  }

private:
  double number() {
    char* end = nullptr;
    const double value = std::strtod(at_, &end);
    at_ = end;
    return value;
  }
  Point point() {
    const double x = number();
    return {x, number()};
  }
  Point placed(Point p) const { return {origin_.x + scale_ * p.x, origin_.y + scale_ * p.y}; }
  void begin(Point p) { pen_ = p, drawing_ = true; }
  void line(Point p) {
    out_.push_back({placed(pen_), placed(p)});
    pen_ = p;
  }
  void dot(Point p) {
    out_.push_back({placed(p), placed(p), kDotThickness});
    drawing_ = false;
  }
  void cubic() {
    const Point p0 = pen_, p1 = point(), p2 = point(), p3 = point();
    constexpr int kSteps = 20;
    for (int i = 1; i <= kSteps; ++i) {
      const double t = double(i) / kSteps, s = 1 - t;
      const double b0 = s * s * s, b1 = 3 * s * s * t, b2 = 3 * s * t * t, b3 = t * t * t;
      line({b0 * p0.x + b1 * p1.x + b2 * p2.x + b3 * p3.x,
            b0 * p0.y + b1 * p1.y + b2 * p2.y + b3 * p3.y});
    }
  }
  void arc() {
    const Point centre = point(), radius = point();
    const double from = number(), to = number();
    const int steps = std::max(1, int(std::ceil(std::abs(to - from) / 5)));
    for (int i = 0; i <= steps; ++i) {
      const double angle = (from + (to - from) * i / steps) * std::numbers::pi / 180;
      const Point p{centre.x + radius.x * std::cos(angle), centre.y + radius.y * std::sin(angle)};
      i == 0 && !drawing_ ? begin(p) : line(p);
    }
    drawing_ = false;
    // A line may go on from the arc's end; another arc begins afresh.
  }
  void glyph();

  std::vector<Segment>& out_;
  double scale_;
  Point origin_;
  const char* at_ = nullptr;
  Point pen_;
  bool drawing_ = false;
};

const font::Glyph& find_glyph(char32_t code) {
  const auto all = font::glyphs();
  const auto it = std::lower_bound(all.begin(), all.end(), code,
                                   [](const font::Glyph& g, char32_t c) { return g.code < c; });
  return it != all.end() && it->code == code ? *it : font::missing_glyph();
}

void PathReader::glyph() {
  const auto code = static_cast<char32_t>(number());
  const double scale = number();
  const Point origin = placed(point());
  PathReader(out_, scale_ * scale, origin).read(find_glyph(code).path);
  drawing_ = false;
}

/// Decodes one UTF-8 character; a malformed byte counts as one unknown character.
char32_t next_character(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  const std::size_t length = first < 0x80 ? 1 : first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  char32_t code = length == 1 ? first : first & (0x7fu >> length);
  bool valid = first < 0x80 || (first >= 0xc2 && first < 0xf5);
  for (std::size_t i = 1; valid && i < length; ++i) {
    valid = i < text.size() && (byte(i) & 0xc0) == 0x80;
    if (valid)
      code = code << 6 | (byte(i) & 0x3fu);
  }
  text.remove_prefix(valid ? length : 1);
  return valid ? code : 0xfffd;
}

double advance(const font::Glyph& glyph) {
  return double(glyph.left) + double(glyph.width) + double(glyph.right);
}

double distance(Point p, const Segment& s) {
  const double dx = s.b.x - s.a.x, dy = s.b.y - s.a.y, length2 = dx * dx + dy * dy;
  const double along =
      length2 > 0 ? std::clamp(((p.x - s.a.x) * dx + (p.y - s.a.y) * dy) / length2, 0.0, 1.0) : 0;
  return std::hypot(p.x - s.a.x - along * dx, p.y - s.a.y - along * dy);
}

/// Share of a pixel at this distance from the centre line that a stroke of this radius covers: the
/// overlap of two intervals, exact for straight edges along the grid.
double coverage(double distance, double radius) {
  return std::max(0.0, std::min(radius, distance + 0.5) - std::max(-radius, distance - 0.5));
}

struct Target {
  Image& image;
  std::array<std::size_t, 3> rgb;
  std::optional<int> alpha;
  std::array<float, 3> colour;

  void mix(int x, int y, double share) {
    const auto blend = [share](float& value, float to) {
      value = static_cast<float>(value + (to - value) * share);
    };
    float* pixel = image.data.data() + image.offset(x, y);
    for (std::size_t c = 0; c < 3; ++c)
      blend(pixel[rgb[c]], colour[c]);
    if (alpha)
      blend(pixel[*alpha], 1);
  }
};

void draw_segments(Target& target, const std::vector<Segment>& segments, double radius) {
  if (segments.empty())
    return;
  constexpr double kFar = std::numeric_limits<double>::max();
  double left = kFar, right = -kFar, top = kFar, bottom = -kFar;
  for (const Segment& s : segments)
    for (const Point& p : {s.a, s.b}) {
      left = std::min(left, p.x), right = std::max(right, p.x);
      top = std::min(top, p.y), bottom = std::max(bottom, p.y);
    }
  const double reach = kDotThickness * radius + 1;
  const auto cell = [](double v, int end) {
    return static_cast<int>(std::clamp(std::floor(v), -1.0, double(end)));
  };
  const int w = target.image.width, h = target.image.height;
  for (int y = std::max(0, cell(top - reach, h)); y <= std::min(h - 1, cell(bottom + reach, h));
       ++y)
    for (int x = std::max(0, cell(left - reach, w)); x <= std::min(w - 1, cell(right + reach, w));
         ++x) {
      double share = 0;
      for (const Segment& s : segments)
        share = std::max(share, coverage(distance({x + 0.5, y + 0.5}, s), radius * s.thickness));
      if (share > 0)
        target.mix(x, y, std::min(share, 1.0));
    }
}

Target make_target(Image& image, const std::array<float, 3>& colour) {
  Target target{image, {}, image.find_channel("A"), colour};
  const char* const names[] = {"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto found = image.find_channel(names[c]);
    if (!found)
      throw Error("text can only be drawn into an image with channels R, G, B");
    target.rgb[c] = static_cast<std::size_t>(*found);
  }
  return target;
}

} // namespace

double text_width(std::string_view text, double height) {
  double width = 0;
  while (!text.empty())
    width += advance(find_glyph(next_character(text)));
  return width * height / kUnits;
}

double draw_text(Image& image, double x, double y, double height, std::string_view text,
                 const std::array<float, 3>& rgb, double weight) {
  Target target = make_target(image, rgb);
  const double unit = height / kUnits, start = x;
  std::vector<Segment> segments;
  while (!text.empty()) {
    const char32_t code = next_character(text);
    if (code == U'\n') {
      x = start, y += height * kFontLineHeight;
      continue;
    }
    const font::Glyph& glyph = find_glyph(code);
    segments.clear();
    PathReader(segments, 1, {}).read(glyph.path);
    for (Segment& s : segments)
      for (Point* p : {&s.a, &s.b})
        *p = {x + (p->x + double(glyph.left)) * unit, y - p->y * unit};
    draw_segments(target, segments, weight * height / 2);
    x += advance(glyph) * unit;
  }
  return x;
}

} // namespace faceta
