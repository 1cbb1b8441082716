#include "verify/plot_chart.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace faceta {

std::string short_number(double value) {
  if (value == 0)
    return "0";
  double size = std::abs(value);
  if (size >= 1e-3 && size < 1e5) {
    std::string text = fmt::format("{:.3g}", value);
    if (text.find('e') == std::string::npos)
      return text;
    return fmt::format("{:.0f}", value);
  }
  std::string text = fmt::format("{:.2e}", value); // "2.50e-06" to "2.5e-6"
  size_t e = text.find('e');
  std::string mantissa = text.substr(0, e);
  mantissa.erase(mantissa.find_last_not_of('0') + 1);
  if (mantissa.back() == '.')
    mantissa.pop_back();
  return fmt::format("{}e{}", mantissa, std::stoi(text.substr(e + 1)));
}

double PlotAxis::position(double value) const {
  double share = logarithmic ? (value > 0 ? std::log(value / low) / std::log(high / low) : 0)
                             : (value - low) / (high - low);
  return std::clamp(share, 0.0, 1.0);
}

PlotAxis linear_axis(std::string label, double low, double high, int most) {
  double decade = std::pow(10.0, std::floor(std::log10((high - low) / most)));
  PlotAxis axis{std::move(label), low, high, false, {}};
  for (double step : {decade, 2 * decade, 5 * decade, 10 * decade, 20 * decade, 50 * decade}) {
    double first = std::floor(low / step + 1e-9), last = std::ceil(high / step - 1e-9);
    if (last - first > most)
      continue;
    for (double k = first; k <= last; ++k)
      axis.ticks.push_back(k * step);
    break;
  }
  axis.low = axis.ticks.front();
  axis.high = axis.ticks.back();
  return axis;
}

PlotAxis logarithmic_axis(std::string label, double low, double high, int most) {
  int first = int(std::floor(std::log10(low) + 1e-9));
  int last = std::max(int(std::ceil(std::log10(high) - 1e-9)), first + 1);
  int step = std::max(1, (last - first + most - 1) / most);
  first = last - (last - first + step - 1) / step * step;
  PlotAxis axis{std::move(label), std::pow(10.0, first), std::pow(10.0, last), true, {}};
  for (int k = first; k <= last; k += step)
    axis.ticks.push_back(std::pow(10.0, k));
  return axis;
}

PlotAxis degree_axis(std::string label, double high, int most) {
  PlotAxis axis{std::move(label), 0, high, false, {}};
  double step = high / 15 <= most ? 15 : high / 30 <= most ? 30 : 45;
  for (double v = 0; v <= high + 1e-9; v += step)
    axis.ticks.push_back(v);
  return axis;
}

} // namespace faceta
