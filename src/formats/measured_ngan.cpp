#include "formats/byte_cursor.h"
#include "formats/measured_common.h"
#include "formats/measured_readers.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace faceta {

namespace {

constexpr size_t kHeader = 16 * sizeof(int32_t);
constexpr int32_t kMaxSize = 10000;

struct Header {
  std::array<int32_t, 4> sizes; ///< theta_i, theta_o, phi_o - phi_i, phi_i
  int32_t reserved[2];
  int32_t parameters; ///< 1: the four angles above
  int32_t binning;    ///< 0: cells of equal size
  int32_t reserved2;
  int32_t half; ///< 1: phi_o - phi_i covers [0, pi] only
  int32_t channels;
  int32_t reserved3[5];
};
static_assert(sizeof(Header) == kHeader);

bool is_flag(int32_t value) {
  return value == 0 || value == 1;
}

// The sizes as they are used here, after checks of what the header declares.
std::array<size_t, 4> checked_sizes(const InputText& input, const Header& header) {
  auto fail = [&](size_t index, const std::string& message) {
    return input.error_at_byte(input.text.data() + index * sizeof(int32_t), message);
  };
  std::array<size_t, 4> sizes;
  for (size_t i = 0; i < 4; ++i) {
    if (header.sizes[i] < 1 || header.sizes[i] > kMaxSize)
      throw fail(i, fmt::format("the header declares {} cells of an angle", header.sizes[i]));
    sizes[i] = static_cast<size_t>(header.sizes[i]);
  }
  if (header.parameters != 1)
    throw fail(6, fmt::format("parametrisation {} is not known, only 1 is", header.parameters));
  if (header.binning != 0)
    throw fail(7, fmt::format("cells of kind {} are not known, only 0 is", header.binning));
  if (!is_flag(header.half))
    throw fail(9, fmt::format("half_data is {}, not 0 or 1", header.half));
  if (header.channels != 3)
    throw fail(10, fmt::format("the file has {} channels, not 3", header.channels));
  const uint64_t limit = uint64_t(1) << 40;
  uint64_t bytes = bounded_product({12, sizes[0], sizes[1], sizes[2], sizes[3]}, limit);
  if (bytes != input.text.size() - kHeader)
    throw fail(16,
               fmt::format("{} x {} x {} x {} cells take {}{} bytes with the header, the file "
                           "has {}",
                           sizes[0], sizes[1], sizes[2], sizes[3],
                           bytes > limit ? "more than " : "", kHeader + bytes, input.text.size()));
  return sizes;
}

std::vector<MeasuredAxis> axes_of(const std::array<size_t, 4>& sizes, bool half) {
  constexpr double kPi = std::numbers::pi;
  const double period = 2 * kPi;
  // Azimuths of the directions of propagation, from 0: ours, from -pi.
  MeasuredAxis phi_i{cell_centres(sizes[3], -kPi, kPi), period};
  MeasuredAxis dphi{cell_centres(sizes[2], 0, half ? kPi : period), half ? 0 : period};
  return {{cell_centres(sizes[0], 0, kPi / 2)}, phi_i, {cell_centres(sizes[1], 0, kPi / 2)}, dphi};
}

// Turns the order of the file's axes around: theirs has phi_i last.
int64_t fill(std::vector<float>& rgb, const char* values, const std::array<size_t, 4>& sizes) {
  const auto [thetas_i, thetas_o, dphis, phis] = sizes;
  const size_t cells = thetas_i * thetas_o * dphis * phis;
  rgb.resize(3 * cells);
  CellTally tally;
  size_t cell = 0;
  for (size_t ti = 0; ti < thetas_i; ++ti)
    for (size_t to = 0; to < thetas_o; ++to)
      for (size_t dphi = 0; dphi < dphis; ++dphi)
        for (size_t phi = 0; phi < phis; ++phi, ++cell) {
          std::array<double, 3> value;
          for (size_t c = 0; c < 3; ++c) {
            value[c] = load<float>(values + sizeof(float) * (c * cells + cell));
            if (value[c] < 0)
              value[0] = NAN;
          }
          tally.store(&rgb[3 * (((ti * phis + phi) * thetas_o + to) * dphis + dphi)], value);
        }
  return tally.holes;
}

} // namespace

bool is_ngan(std::string_view bytes) {
  if (bytes.size() < kHeader)
    return false;
  Header header = load<Header>(bytes.data());
  bool plausible = std::all_of(header.sizes.begin(), header.sizes.end(),
                               [](int32_t size) { return size > 0 && size <= kMaxSize; });
  return plausible && is_flag(header.parameters) && is_flag(header.binning) &&
         is_flag(header.half) && header.channels == 3;
}

MeasuredFile read_ngan(const InputText& input, const MeasuredOptions& options) {
  expect_one_coloured_material(input, options);
  ByteCursor cursor(input);
  Header header = cursor.take<Header>("the header");
  std::array<size_t, 4> sizes = checked_sizes(input, header);
  const bool half = header.half == 1;
  MeasuredGrid grid{MeasuredCoordinates::relative_rotated, axes_of(sizes, half), {}};
  MeasuredInfo info;
  info.holes = fill(grid.rgb, cursor.at(), sizes);
  info.cells = static_cast<int64_t>(grid.rgb.size() / 3);
  info.resolution = fmt::format("{} x {} x {} x {} (theta_i, phi_i, theta_o, phi_o - phi_i)",
                                sizes[0], sizes[3], sizes[1], sizes[2]);
  info.interpolation = "linear in the four angles between the centres of cells; holes are left out";
  info.symmetries = {"anisotropic"};
  if (half)
    info.symmetries.push_back("the same for phi_o - phi_i and its negative");
  info.notes = {"azimuths turned by half a turn: the file counts directions of propagation"};
  info.largest_theta = std::max(grid.axes[0].nodes.back(), grid.axes[2].nodes.back());
  return {std::move(info), std::move(grid)};
}

} // namespace faceta
