#include "verify/plot_drawing.h"

#include "image/font.h"

#include <algorithm>
#include <cmath>

namespace faceta {

namespace {

struct Theme {
  const char *background, *text, *muted, *grid;
  const char* series[kSeriesColours];
};

// Series after Okabe and Ito 2002, "Color Universal Design"; lighter ones on a dark ground.
constexpr Theme kLight = {
    "#ffffff",
    "#1f2328",
    "#57606a",
    "#d5dbe1",
    {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#5f6368"}};
constexpr Theme kDark = {
    "#14181d",
    "#e6edf3",
    "#a3adb8",
    "#38404a",
    {"#4fa8de", "#f28a3c", "#2fc79a", "#e79ac6", "#f2c14b", "#a6d8f7", "#b4bac1"}};

} // namespace

const std::vector<double>& dash_pattern(int dash) {
  static const std::vector<double> patterns[kDashes] = {
      {}, {7, 4}, {2, 3.5}, {9, 3.5, 2, 3.5}, {4, 3}};
  return patterns[dash % kDashes];
}

double plot_text_width(const std::string& text, double size, bool bold) {
  return text_width(text, size) * (bold ? 1.2 : 1.1);
}

std::string ink_colour(Ink ink, bool dark) {
  const Theme& theme = dark ? kDark : kLight;
  switch (ink.role) {
  case Ink::none:
    return {};
  case Ink::background:
    return theme.background;
  case Ink::text:
    return theme.text;
  case Ink::muted:
    return theme.muted;
  case Ink::grid:
    return theme.grid;
  case Ink::series:
    return theme.series[ink.index % kSeriesColours];
  }
  return {};
}

std::array<float, 3> ramp_colour(double x) {
  x = std::isfinite(x) ? std::clamp(x, 0.0, 1.0) : 0;
  // Lightness is linear, the hue runs from violet over blue and green to yellow.
  double lightness = 0.18 + 0.78 * x, hue = (305 - 200 * x) * kPi / 180;
  // What sRGB can show at each step.
  constexpr double kChroma[] = {0.070, 0.105, 0.115, 0.100, 0.090, 0.094,
                                0.112, 0.145, 0.168, 0.165, 0.125};
  int step = std::min(int(10 * x), 9);
  double chroma = kChroma[step] + (10 * x - step) * (kChroma[step + 1] - kChroma[step]);
  double a = chroma * std::cos(hue), b = chroma * std::sin(hue);
  double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  double rgb[3] = {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                   -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                   -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
  std::array<float, 3> result{};
  for (int k = 0; k < 3; ++k)
    result[k] = float(std::clamp(rgb[k], 0.0, 1.0));
  return result;
}

} // namespace faceta
