#include "image/io.h"
#include "verify/plot_drawing.h"

#include <cmath>
#include <fmt/format.h>

namespace faceta {

namespace {

/// At most two decimals, without zeros at the end.
std::string number(double v) {
  std::string text = fmt::format("{:.2f}", v);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.')
    text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string escape(const std::string& text) {
  std::string result;
  for (char c : text)
    switch (c) {
    case '&':
      result += "&amp;";
      break;
    case '<':
      result += "&lt;";
      break;
    case '>':
      result += "&gt;";
      break;
    case '"':
      result += "&quot;";
      break;
    default:
      // Control characters are not allowed in XML, not even escaped.
      result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  return result;
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t triple = 0;
    for (size_t k = 0; k < 3; ++k)
      triple = triple << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
    for (size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? kDigits[triple >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string class_of(Ink ink) {
  switch (ink.role) {
  case Ink::none:
    return "n";
  case Ink::background:
    return "b";
  case Ink::text:
    return "t";
  case Ink::muted:
    return "m";
  case Ink::grid:
    return "g";
  case Ink::series:
    return std::to_string(ink.index % kSeriesColours);
  }
  return {};
}

std::vector<Ink> all_inks() {
  std::vector<Ink> inks = {{Ink::background}, {Ink::text}, {Ink::muted}, {Ink::grid}};
  for (int i = 0; i < kSeriesColours; ++i)
    inks.push_back(series_ink(i));
  return inks;
}

/// Rules that give the classes their colours inside of what the selector picks.
std::string colour_rules(const std::string& selector, bool dark) {
  std::string rules;
  for (const Ink& ink : all_inks())
    rules += fmt::format("{0} .s{1}{{stroke:{2}}}{0} .f{1}{{fill:{2}}}", selector, class_of(ink),
                         ink_colour(ink, dark));
  return rules;
}

/// "m10 20.5l3-.2 1 1": the points in tenths, each relative to the one before.
std::string short_path(const std::vector<Vec2<double>>& points, bool closed) {
  auto tenths = [](long v, bool first) {
    std::string text = v < 0 ? "-" : first ? "" : " ";
    v = std::abs(v);
    if (v >= 10 || v == 0)
      text += std::to_string(v / 10);
    return v % 10 ? text + "." + std::to_string(v % 10) : text;
  };
  std::string text;
  long x = 0, y = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    long dx = std::lround(points[i].x * 10) - x, dy = std::lround(points[i].y * 10) - y;
    if (i > 0 && dx == 0 && dy == 0)
      continue;
    text += (i == 0 ? "m" : i == 1 ? "l" : "") + tenths(dx, i < 2) + tenths(dy, false);
    x += dx, y += dy;
  }
  return closed ? text + "z" : text;
}

/// Writes one drawing. Colours are attributes of the elements, which every program understands;
/// where the theme follows the system, classes let a style sheet of the same element change them.
class SvgWriter {
public:
  SvgWriter(const Drawing& drawing, PlotTheme theme) : drawing_(drawing), theme_(theme) {}

  std::string body() {
    PlotLine ground{
        {{0, 0}, {drawing_.width, 0}, {drawing_.width, drawing_.height}, {0, drawing_.height}},
        {},
        0,
        0,
        {Ink::background},
        1,
        true};
    write(ground);
    for (const auto& item : drawing_.items)
      std::visit([this](const auto& i) { write(i); }, item);
    return std::move(text_);
  }

  std::string style(const std::string& id) const {
    if (theme_ != PlotTheme::automatic)
      return {};
    return "<style>@media screen and (prefers-color-scheme:dark){" + colour_rules("#" + id, true) +
           "}</style>\n";
  }

private:
  /// ` fill="#fff" stroke="#000" class="fb st"`.
  std::string paint(Ink fill, Ink stroke) const {
    std::string result;
    if (fill.role == Ink::none)
      result = " fill=\"none\"";
    else if (theme_ != PlotTheme::page)
      result = fmt::format(" fill=\"{}\"", ink_colour(fill, theme_ == PlotTheme::dark));
    std::string classes = fill.role == Ink::none ? "" : "f" + class_of(fill);
    if (stroke.role != Ink::none) {
      if (theme_ != PlotTheme::page)
        result += fmt::format(" stroke=\"{}\"", ink_colour(stroke, theme_ == PlotTheme::dark));
      classes += (classes.empty() ? "s" : " s") + class_of(stroke);
    }
    if ((theme_ == PlotTheme::automatic || theme_ == PlotTheme::page) && !classes.empty())
      result += fmt::format(" class=\"{}\"", classes);
    return result;
  }

  void write(const PlotLine& line) {
    if (theme_ == PlotTheme::page) {
      text_ += "<path d=\"" + short_path(line.points, line.closed);
    } else {
      text_ += line.closed ? "<polygon points=\"" : "<polyline points=\"";
      for (size_t i = 0; i < line.points.size(); ++i)
        text_ += (i ? " " : "") + number(line.points[i].x) + "," + number(line.points[i].y);
    }
    text_ += "\"" + paint(line.fill, line.stroke);
    if (line.fill.role != Ink::none && line.opacity < 1)
      text_ += fmt::format(" fill-opacity=\"{}\"", number(line.opacity));
    if (line.stroke.role != Ink::none)
      text_ += fmt::format(" stroke-width=\"{}\"", number(line.width));
    if (line.stroke.role != Ink::none && theme_ != PlotTheme::page) // whose style sheet says so
      text_ += " stroke-linejoin=\"round\"";
    std::string dashes;
    for (double length : dash_pattern(line.dash))
      dashes += (dashes.empty() ? "" : " ") + number(length);
    if (!dashes.empty() && line.stroke.role != Ink::none)
      text_ += fmt::format(" stroke-dasharray=\"{}\"", dashes);
    text_ += "/>\n";
  }

  void write(const PlotLabel& label) {
    static constexpr const char* kAnchors[] = {"start", "middle", "end"};
    std::string place = fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\"", number(label.at.x),
                                    number(label.at.y), number(label.size));
    if (label.anchor != PlotLabel::start)
      place += fmt::format(" text-anchor=\"{}\"", kAnchors[label.anchor]);
    if (label.bold)
      place += " font-weight=\"600\"";
    std::string content = ">" + escape(label.text) + "</text>\n";
    if (label.halo)
      text_ += place + paint({Ink::background}, {Ink::background}) +
               " stroke-width=\"3.5\" stroke-linejoin=\"round\"" + content;
    text_ += place + paint(label.ink, {}) + content;
  }

  void write(const PlotPicture& picture) {
    text_ += fmt::format("<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" "
                         "preserveAspectRatio=\"none\" href=\"data:image/png;base64,{}\"/>\n",
                         number(picture.corner.x), number(picture.corner.y), number(picture.size.x),
                         number(picture.size.y), base64(encode_png(picture.pixels)));
  }

  const Drawing& drawing_;
  PlotTheme theme_;
  std::string text_;
};

/// FNV-1a.
uint64_t hash(const std::string& text) {
  uint64_t h = 0xcbf29ce484222325ull;
  for (char c : text)
    h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return h;
}

} // namespace

std::string page_plot_style() {
  return ".plot path{stroke-linejoin:round}" + colour_rules(".plot", false) +
         "\n@media screen and (prefers-color-scheme:dark){" + colour_rules(".plot", true) + "}\n";
}

std::string to_svg(const Drawing& drawing, const std::string& id, PlotTheme theme,
                   double display_width) {
  SvgWriter writer(drawing, theme);
  std::string body = writer.body();
  std::string name = id.empty() ? fmt::format("plot-{:016x}", hash(drawing.title + body)) : id;
  double width = display_width > 0 ? display_width : drawing.width;
  return fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" id=\"{0}\" viewBox=\"0 0 {1} {2}\" "
                     "width=\"{3}\" height=\"{4}\" style=\"max-width:100%;height:auto\" "
                     "role=\"img\" aria-labelledby=\"{0}-title {0}-text\" "
                     "font-family=\"system-ui,sans-serif\">\n"
                     "<title id=\"{0}-title\">{5}</title>\n<desc id=\"{0}-text\">{6}</desc>\n{7}",
                     name, number(drawing.width), number(drawing.height), number(width),
                     number(drawing.height * width / drawing.width), escape(drawing.title),
                     escape(drawing.description), writer.style(name)) +
         body + "</svg>\n";
}

} // namespace faceta
