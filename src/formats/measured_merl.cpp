#include "formats/measured_merl.h"

#include "formats/byte_cursor.h"
#include "formats/measured_common.h"
#include "formats/output_file.h"

#include <cmath>
#include <fmt/format.h>

namespace faceta {

namespace {

constexpr size_t kHeader = 12;
constexpr std::array<int32_t, 3> kSizes = {90, 90, 180};
constexpr int32_t kMaxSize = 100000;
constexpr std::array<double, 3> kScale = {1 / 1500.0, 1.15 / 1500, 1.66 / 1500};

using Sizes = std::array<int32_t, 3>;

uint64_t cells_of(const Sizes& sizes, uint64_t limit) {
  for (int32_t size : sizes)
    if (size < 1 || size > kMaxSize)
      return limit + 1;
  return bounded_product({static_cast<uint64_t>(sizes[0]), static_cast<uint64_t>(sizes[1]),
                          static_cast<uint64_t>(sizes[2])},
                         limit);
}

// True if the file is as long as the sizes say.
bool fits(std::string_view bytes, const Sizes& sizes) {
  return bytes.size() >= kHeader &&
         bytes.size() - kHeader == 3 * sizeof(double) * cells_of(sizes, bytes.size());
}

std::vector<MeasuredAxis> axes_of(const Sizes& sizes, bool centres) {
  auto axis = [&](int32_t size, double range) {
    MeasuredAxis a;
    for (int32_t i = 0; i < size; ++i)
      a.nodes.push_back((i + (centres ? 0.5 : 0)) / size * range);
    return a;
  };
  std::vector<MeasuredAxis> axes = {axis(sizes[0], 1), axis(sizes[1], 90 * kDegree),
                                    axis(sizes[2], 180 * kDegree)};
  for (double& theta_h : axes[0].nodes)
    theta_h = theta_h * theta_h * 90 * kDegree;
  axes[0].square_root = true;
  axes[2].period = std::numbers::pi;
  return axes;
}

void describe(MeasuredInfo& info, const MeasuredGrid& grid, const Sizes& sizes, bool centres) {
  info.cells = static_cast<int64_t>(grid.rgb.size() / 3);
  info.resolution =
      fmt::format("{} x {} x {} (theta_h, theta_d, phi_d)", sizes[0], sizes[1], sizes[2]);
  info.interpolation = fmt::format("linear in sqrt(theta_h), theta_d and phi_d between the {} of "
                                   "cells; holes are left out",
                                   centres ? "centres" : "lower edges");
  info.symmetries = {"isotropic", "reciprocal by construction"};
  HalfDifferenceReach reach = reach_of(grid);
  info.largest_theta = reach.largest_theta;
  info.notes.push_back(fmt::format("{} of the holes lie above the horizon", reach.holes_above));
}

} // namespace

bool is_merl(std::string_view bytes) {
  if (bytes.size() < kHeader)
    return false;
  Sizes sizes = load<Sizes>(bytes.data());
  return sizes == kSizes || fits(bytes, sizes);
}

MeasuredFile read_merl(const InputText& input, const MeasuredOptions& options) {
  expect_one_coloured_material(input, options);
  ByteCursor cursor(input);
  Sizes sizes = cursor.take<Sizes>("the header");
  if (!fits(input.text, sizes)) {
    std::string declared = fmt::format("{} x {} x {} cells", sizes[0], sizes[1], sizes[2]);
    uint64_t cells = cells_of(sizes, uint64_t(1) << 40);
    throw input.error_at_byte(cursor.at(),
                              cells > uint64_t(1) << 40
                                  ? "the header declares " + declared
                                  : fmt::format("{} take {} bytes with the header, the file has {}",
                                                declared, kHeader + 3 * sizeof(double) * cells,
                                                input.text.size()));
  }
  const bool centres = options.merl_nodes == "centers";
  MeasuredGrid grid;
  grid.axes = axes_of(sizes, centres);
  const size_t cells = cells_of(sizes, input.text.size());
  grid.rgb.resize(3 * cells);
  CellTally tally;
  for (size_t cell = 0; cell < cells; ++cell) {
    std::array<double, 3> value;
    for (size_t c = 0; c < 3; ++c) {
      value[c] = load<double>(cursor.at() + sizeof(double) * (c * cells + cell)) * kScale[c];
      // Published readers look at red only; some files hold holes in the other channels alone.
      if (value[c] < 0)
        value[0] = NAN;
    }
    tally.store(&grid.rgb[3 * cell], value);
  }
  MeasuredInfo info;
  info.holes = tally.holes;
  describe(info, grid, sizes, centres);
  return {std::move(info), std::move(grid)};
}

void write_merl(const std::string& path, const MeasuredGrid& grid) {
  const size_t cells = grid.rgb.size() / 3;
  bool fits = grid.coordinates == MeasuredCoordinates::half_difference && grid.axes.size() == 3 &&
              grid.rgb.size() == 3 * cells_of(kSizes, grid.rgb.size());
  for (size_t axis = 0; fits && axis < 3; ++axis)
    fits = grid.axes[axis].nodes.size() == static_cast<size_t>(kSizes[axis]);
  if (!fits)
    throw Error("cannot write: a MERL file holds 90 x 90 x 180 half-difference cells", {path});
  OutputFile file(path);
  file.write({reinterpret_cast<const char*>(kSizes.data()), kHeader});
  std::vector<double> plane(cells);
  for (size_t c = 0; c < 3; ++c) {
    for (size_t cell = 0; cell < cells; ++cell)
      plane[cell] = std::isnan(grid.rgb[3 * cell]) ? -1 : grid.rgb[3 * cell + c] / kScale[c];
    file.write({reinterpret_cast<const char*>(plane.data()), cells * sizeof(double)});
  }
  file.commit();
}

} // namespace faceta
