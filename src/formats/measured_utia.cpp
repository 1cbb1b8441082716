#include "formats/byte_cursor.h"
#include "formats/measured_common.h"
#include "formats/measured_readers.h"
#include "image/io.h"
#include "image/tonemap.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace faceta {

namespace {

constexpr size_t kThetas = 6, kPhis = 48; // every 15 and 7.5 degrees
constexpr size_t kDirections = kThetas * kPhis;
constexpr size_t kCells = kDirections * kDirections;
constexpr size_t kSize = 3 * kCells * sizeof(double);
// The "dense" set of the same authors: 44 x 180 directions.
constexpr size_t kDenseSize = 3 * (size_t(44) * 180) * (size_t(44) * 180) * sizeof(double);

bool is_exr(std::string_view bytes) {
  return bytes.starts_with("\x76\x2f\x31\x01");
}

// Text and packed data, taken as float64, are huge or tiny.
bool starts_with_plausible_numbers(std::string_view bytes) {
  for (size_t i = 0; i < 64; ++i) {
    double v = std::abs(load<double>(bytes.data() + i * sizeof(double)));
    if (v > 1e9 || (v > 0 && v < 1e-30))
      return false;
  }
  return true;
}

// Linear reflectance of a number in the file.
class Decoder {
public:
  explicit Decoder(const MeasuredOptions& options)
      : curved_(options.utia_color != "linear"), scaled_(options.utia_color == "scaled_srgb") {}

  // Negative values stay so, for the tally.
  double operator()(double v) const {
    if (!curved_ || v <= 0)
      return v;
    return scaled_ ? 100 * srgb_to_linear(v / 140) : srgb_to_linear(v);
  }
  std::string text() const {
    return scaled_   ? "colours read as 100 eotf(v / 140), the sRGB curve"
           : curved_ ? "colours read as sRGB"
                     : "colours read as linear";
  }

private:
  bool curved_, scaled_;
};

// The numbers of a cell, from either kind of file.
class Numbers {
public:
  explicit Numbers(const InputText& input) {
    if (!is_exr(input.text)) {
      planes_ = input.text.data();
      return;
    }
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(input.text.data());
    image_ = decode_image({bytes, input.text.size()}, input.name).rgb(RgbFallback::none);
    if (image_.width != kDirections || image_.height != kDirections)
      throw Error(
          fmt::format("an image of {} x {} pixels is no UTIA file", image_.width, image_.height),
          {input.name}, fmt::format("those have {} x {}", kDirections, kDirections));
  }

  std::array<double, 3> at(size_t cell) const {
    std::array<double, 3> value;
    for (size_t c = 0; c < 3; ++c)
      value[c] = planes_ ? load<double>(planes_ + sizeof(double) * (c * kCells + cell))
                         : image_.data[3 * cell + c];
    return value;
  }

private:
  const char* planes_ = nullptr;
  Image image_;
};

std::vector<MeasuredAxis> axes() {
  MeasuredAxis theta, phi;
  for (size_t i = 0; i < kThetas; ++i)
    theta.nodes.push_back(15 * static_cast<double>(i) * kDegree);
  for (size_t i = 0; i < kPhis; ++i)
    phi.nodes.push_back(7.5 * static_cast<double>(i) * kDegree);
  phi.period = 2 * std::numbers::pi;
  return {theta, phi, theta, phi};
}

} // namespace

bool is_utia(std::string_view bytes) {
  return is_exr(bytes) || ((bytes.size() == kSize || bytes.size() == kDenseSize) &&
                           starts_with_plausible_numbers(bytes));
}

MeasuredFile read_utia(const InputText& input, const MeasuredOptions& options) {
  expect_one_coloured_material(input, options);
  if (!is_exr(input.text) && input.text.size() == kDenseSize)
    throw Error("this looks like a file of UTIA's dense set, which is not supported", {input.name},
                "its angles are not documented; the database's other files are read");
  if (!is_exr(input.text) && input.text.size() != kSize)
    throw Error(fmt::format("the file has {} bytes, a UTIA file has {}", input.text.size(), kSize),
                {input.name});
  const Decoder decode(options);
  const Numbers numbers(input);
  MeasuredGrid grid{MeasuredCoordinates::absolute, axes(), std::vector<float>(3 * kCells)};
  CellTally tally;
  for (size_t cell = 0; cell < kCells; ++cell) {
    std::array<double, 3> value = numbers.at(cell);
    std::transform(value.begin(), value.end(), value.begin(), decode);
    tally.store(&grid.rgb[3 * cell], value);
  }
  MeasuredInfo info;
  info.resolution = "6 x 48 x 6 x 48 (theta_i, phi_i, theta_o, phi_o)";
  info.interpolation = "linear in the four angles; beyond 75 degrees the values at 75";
  info.symmetries = {"anisotropic"};
  info.notes = {decode.text()};
  info.cells = kCells;
  info.holes = tally.holes;
  info.negative = tally.negative;
  info.largest_theta = 75 * kDegree;
  return {std::move(info), std::move(grid)};
}

} // namespace faceta
