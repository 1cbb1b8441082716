#include "formats/byte_cursor.h"
#include "formats/measured_common.h"
#include "formats/measured_readers.h"
#include "formats/measured_tensor.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace faceta {

namespace {

// The angles of one axis, in radians.
MeasuredAxis read_axis(const TensorFile& file, const char* name) {
  const TensorField& field = file.require(name, TensorType::f32, {1, 0});
  std::vector<float> values = file.finite_floats(field);
  for (size_t i = 1; i < values.size(); ++i)
    if (!(values[i] > values[i - 1]))
      throw file.error(&field, fmt::format("'{}' must increase strictly, value {} does not follow",
                                           name, i + 1));
  return {{values.begin(), values.end()}};
}

MeasuredAxis read_theta(const TensorFile& file, const char* name) {
  MeasuredAxis axis = read_axis(file, name);
  if (axis.nodes.front() < 0 || axis.nodes.back() > 90.001 * kDegree)
    throw file.error(file.find(name), fmt::format("'{}' must lie between 0 and pi/2", name));
  return axis;
}

// phi_d goes once around. Files that hold both ends, which are one direction, lose the last one.
MeasuredAxis read_phi(const TensorFile& file) {
  MeasuredAxis axis = read_axis(file, "phi_d");
  constexpr double kTurn = 2 * std::numbers::pi, kTolerance = 1e-4;
  const double span = axis.nodes.back() - axis.nodes.front();
  const double step = span / std::max(1.0, static_cast<double>(axis.nodes.size()) - 1);
  if (span > kTurn + kTolerance || span + step < kTurn - kTolerance)
    throw file.error(file.find("phi_d"),
                     fmt::format("'phi_d' must go once around, it spans {:.4} radians", span));
  axis.period = kTurn;
  if (span > kTurn - kTolerance)
    axis.nodes.pop_back();
  return axis;
}

std::vector<double> read_wavelengths(const TensorFile& file) {
  const TensorField& field = file.require("wvls", TensorType::u16, {0});
  std::vector<double> wavelengths;
  for (size_t i = 0; i < field.bytes.size(); i += 2)
    wavelengths.push_back(load<uint16_t>(field.bytes.data() + i));
  for (size_t i = 0; i < wavelengths.size(); ++i)
    if (!(wavelengths[i] > (i == 0 ? 0 : wavelengths[i - 1])))
      throw file.error(&field, "the wavelengths in 'wvls' must be positive and increase strictly");
  return wavelengths;
}

struct Mueller {
  const TensorField& field; ///< [phi_d][theta_d][theta_h][wavelength][4][4]
  const WavelengthWeights& weights;

  // The reflectance of unpolarised light as a colour; not finite if a wavelength that counts is.
  std::array<double, 3> at(size_t cell, int64_t& negative) const {
    const char* entry = field.bytes.data() + cell * weights.size() * 16 * sizeof(float);
    std::array<double, 3> colour{};
    for (const auto& weight : weights) {
      float value = load<float>(entry);
      entry += 16 * sizeof(float);
      negative += value < 0;
      // Like the renderer of the paper's authors: what is negative is 0, wavelength by wavelength.
      double reflectance = std::isfinite(value) ? std::max(value, 0.0f) : NAN;
      for (size_t c = 0; c < 3; ++c)
        if (weight[c] != 0)
          colour[c] += weight[c] * reflectance;
    }
    return colour;
  }
};

// Turns the order of the file's axes around.
void fill(MeasuredGrid& grid, const Mueller& mueller, MeasuredInfo& info) {
  const size_t phis = grid.axes[2].nodes.size();
  const size_t halves = grid.axes[0].nodes.size(), differences = grid.axes[1].nodes.size();
  grid.rgb.resize(3 * phis * differences * halves);
  CellTally tally;
  size_t cell = 0;
  for (size_t phi = 0; phi < phis; ++phi)
    for (size_t d = 0; d < differences; ++d)
      for (size_t h = 0; h < halves; ++h, ++cell)
        tally.store(&grid.rgb[3 * ((h * differences + d) * phis + phi)],
                    mueller.at(cell, info.negative));
  info.holes = tally.holes;
  if (tally.negative > 0)
    info.notes.push_back(
        fmt::format("{} negative components of colours out of gamut: 0", tally.negative));
}

} // namespace

bool is_pbsdf(std::string_view bytes) {
  return is_tensor_file(bytes) && declares_tensor(bytes, "M");
}

MeasuredFile read_pbsdf(const InputText& input, const MeasuredOptions& options) {
  expect_one_material(input, options);
  TensorFile file(input);
  MeasuredInfo info;
  MeasuredGrid grid;
  grid.axes = {read_theta(file, "theta_h"), read_theta(file, "theta_d"), read_phi(file)};
  info.wavelengths = read_wavelengths(file);
  auto size = [&](const char* name) { return file.find(name)->shape.back(); };
  const TensorField& field = file.require(
      "M", TensorType::f32,
      {size("phi_d"), size("theta_d"), size("theta_h"), info.wavelengths.size(), 4, 4});
  WavelengthWeights weights =
      wavelength_weights(info.wavelengths, options.wavelength, {input.name});
  fill(grid, {field, weights}, info);

  info.cells = static_cast<int64_t>(grid.rgb.size() / 3);
  info.resolution = fmt::format("{} x {} x {} (theta_h, theta_d, phi_d)", size("theta_h"),
                                size("theta_d"), size("phi_d"));
  info.interpolation = "linear in theta_h, theta_d and phi_d; holes are left out";
  info.symmetries = {"isotropic"};
  info.notes.push_back("unpolarised light only: entry (0, 0) of the Mueller matrices");
  if (options.wavelength >= 0)
    info.notes.push_back(fmt::format("only {} nm, as grey", options.wavelength));
  else
    info.notes.push_back("wavelengths became linear sRGB under D65, constant beyond the ends");
  info.largest_theta = reach_of(grid).largest_theta;
  return {std::move(info), std::move(grid)};
}

} // namespace faceta
