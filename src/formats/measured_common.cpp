#include "formats/measured_common.h"

#include "spectrum/cie.h"
#include "spectrum/spectrum_curve.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace faceta {

std::vector<double> cell_centres(size_t n, double first, double last) {
  std::vector<double> nodes(n);
  for (size_t i = 0; i < n; ++i)
    nodes[i] = first + (last - first) * (static_cast<double>(i) + 0.5) / static_cast<double>(n);
  return nodes;
}

namespace {

WavelengthWeights one_wavelength(const std::vector<double>& wavelengths, double only,
                                 const SourcePosition& where) {
  if (!(only >= wavelengths.front() && only <= wavelengths.back()))
    throw Error(fmt::format("the wavelength {} nm was not measured", only), where,
                fmt::format("the file has {} to {} nm", wavelengths.front(), wavelengths.back()));
  WavelengthWeights weights(wavelengths.size(), {0, 0, 0});
  auto above = std::lower_bound(wavelengths.begin(), wavelengths.end(), only);
  size_t i = static_cast<size_t>(above - wavelengths.begin());
  double t = i == 0 ? 1 : (only - wavelengths[i - 1]) / (wavelengths[i] - wavelengths[i - 1]);
  weights[i].fill(t);
  if (t < 1)
    weights[i - 1].fill(1 - t);
  return weights;
}

} // namespace

WavelengthWeights wavelength_weights(const std::vector<double>& wavelengths, double only,
                                     const SourcePosition& where) {
  if (only >= 0)
    return one_wavelength(wavelengths, only, where);
  // The colour is linear in the values: the weight of a wavelength is the colour of the hat
  // function on its node. Nodes far outside make the curve constant beyond the ends.
  const size_t n = wavelengths.size();
  SpectrumCurve hat;
  hat.wavelengths.push_back(std::min(wavelengths.front(), kCieMin) - 1);
  hat.wavelengths.insert(hat.wavelengths.end(), wavelengths.begin(), wavelengths.end());
  hat.wavelengths.push_back(std::max(wavelengths.back(), kCieMax) + 1);
  hat.values.assign(n + 2, 0);
  WavelengthWeights weights(n);
  std::array<double, 3> sum{};
  for (size_t i = 0; i < n; ++i) {
    hat.values[i + 1] = 1;
    hat.values.front() = i == 0;
    hat.values.back() = i + 1 == n;
    weights[i] = xyz_to_srgb(spectrum_to_xyz(hat, true));
    hat.values[i + 1] = 0;
    for (size_t c = 0; c < 3; ++c)
      sum[c] += weights[i][c];
  }
  // The sums are 1 up to the four digits of the tables and the matrix.
  for (auto& weight : weights)
    for (size_t c = 0; c < 3; ++c)
      weight[c] /= sum[c];
  return weights;
}

void expect_one_material(const InputText& input, const MeasuredOptions& options) {
  if (options.index != 1)
    throw Error(fmt::format("the file holds one material, there is no number {}", options.index),
                {input.name}, "leave the index out");
}

void expect_one_coloured_material(const InputText& input, const MeasuredOptions& options) {
  expect_one_material(input, options);
  if (options.wavelength >= 0)
    throw Error(
        fmt::format("the file holds colours, it has no wavelength {} nm", options.wavelength),
        {input.name}, "leave the wavelength out");
}

std::string shown_text(std::string_view text) {
  std::string shown(text.substr(0, std::min<size_t>(text.find('\0'), 1000)));
  for (char& c : shown)
    if (static_cast<unsigned char>(c) < 32 || c == 127)
      c = ' ';
  return shown;
}

void CellTally::store(float* rgb, const std::array<double, 3>& value) {
  for (size_t c = 0; c < 3; ++c) {
    rgb[c] = static_cast<float>(value[c]);
    if (!std::isfinite(rgb[c])) {
      std::fill_n(rgb, 3, std::numeric_limits<float>::quiet_NaN());
      ++holes;
      return;
    }
  }
  for (size_t c = 0; c < 3; ++c)
    if (rgb[c] < 0) {
      rgb[c] = 0;
      ++negative;
    }
}

HalfDifferenceReach reach_of(const MeasuredGrid& grid) {
  // cos theta of wi and wo = cos theta_h cos theta_d -+ sin theta_h sin theta_d cos phi_d
  std::vector<double> cos_phi;
  for (double phi : grid.axes[2].nodes)
    cos_phi.push_back(std::abs(std::cos(phi)));
  HalfDifferenceReach reach;
  double least = 1;
  const float* rgb = grid.rgb.data();
  for (double theta_h : grid.axes[0].nodes)
    for (double theta_d : grid.axes[1].nodes) {
      double a = std::cos(theta_h) * std::cos(theta_d), b = std::sin(theta_h) * std::sin(theta_d);
      for (double c : cos_phi) {
        double lower = a - b * c;
        if (!std::isnan(*rgb))
          least = std::min(least, lower);
        else
          reach.holes_above += lower > 0;
        rgb += 3;
      }
    }
  reach.largest_theta = std::acos(std::max(least, 0.0));
  return reach;
}

} // namespace faceta
