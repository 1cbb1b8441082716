#include "formats/byte_cursor.h"
#include "formats/measured_common.h"
#include "formats/measured_readers.h"

#include <cstring>
#include <fmt/format.h>

namespace faceta {

namespace {

constexpr std::string_view kMagic = "NVIDIA ARC MBSDF V1\n";
constexpr std::string_view kTransmission = "MBSDF_DATA_TRANSMISSION=";
constexpr size_t kMaxLine = 1 << 16;

std::string_view take_line(const InputText& input, ByteCursor& cursor, const std::string& what) {
  std::string_view rest(cursor.at(), cursor.left());
  size_t length = rest.substr(0, kMaxLine).find('\n');
  if (length == rest.npos)
    throw input.error_at_byte(cursor.at(), "there is no end of the line in " + what);
  return cursor.take_bytes(length + 1, what).substr(0, length);
}

// Metadata and the name of the first block, behind which the cursor then stands.
std::string_view take_header(const InputText& input, ByteCursor& cursor, std::string& metadata) {
  if (!input.text.starts_with(kMagic))
    throw input.error_at_byte(cursor.at(), "the first line is not 'NVIDIA ARC MBSDF V1'");
  cursor.take_bytes(kMagic.size(), "the first line");
  while (true) {
    if (cursor.left() == 0)
      throw input.error_at_byte(cursor.at(), "the file ends before a block of data "
                                             "(MBSDF_DATA=, MBSDF_DATA_REFLECTION=)");
    std::string_view line = take_line(input, cursor, "the text before the data");
    if (line == "MBSDF_DATA=" || line == "MBSDF_DATA_REFLECTION=" || line == kTransmission)
      return line;
    if (metadata.size() < kMaxLine)
      metadata += std::string(metadata.empty() ? "" : "; ") + std::string(line);
  }
}

// f32[theta_in][theta_out][dphi][channels]
struct Block {
  size_t thetas, phis, channels;
  const char* values;

  float at(size_t in, size_t out, size_t phi, size_t channel) const {
    size_t cell = (in * thetas + out) * phis + phi;
    return load<float>(values + sizeof(float) * (cell * channels + channel % channels));
  }
};

Block take_block(const InputText& input, ByteCursor& cursor) {
  const char* start = cursor.at();
  auto type = cursor.take<uint32_t>("the header of a block");
  if (type > 1)
    throw input.error_at_byte(start, fmt::format("the kind of values {} is not 0 (scalar) or 1 "
                                                 "(rgb)",
                                                 type));
  auto thetas = cursor.take<uint32_t>("the header of a block");
  auto phis = cursor.take<uint32_t>("the header of a block");
  if (thetas == 0 || phis == 0)
    throw input.error_at_byte(start + 4, "a block of data without angles");
  const uint64_t channels = type == 0 ? 1 : 3;
  uint64_t bytes =
      bounded_product({thetas, thetas, phis, channels, sizeof(float)}, uint64_t(1) << 40);
  const char* values = cursor.at();
  cursor.take_bytes(bytes, "a block of values");
  return {thetas, phis, channels, values};
}

// The mean of both directions of light, as the SDK takes it.
void fill(MeasuredGrid& grid, const Block& block, MeasuredInfo& info) {
  const size_t n = block.thetas;
  grid.rgb.resize(3 * n * n * block.phis);
  CellTally tally;
  float* cell = grid.rgb.data();
  for (size_t in = 0; in < n; ++in)
    for (size_t out = 0; out < n; ++out)
      for (size_t phi = 0; phi < block.phis; ++phi, cell += 3) {
        std::array<double, 3> value;
        for (size_t c = 0; c < 3; ++c) {
          double raw = block.at(in, out, phi, c);
          info.negative += raw < 0 && c < block.channels;
          value[c] = 0.5 * (raw + block.at(out, in, phi, c));
        }
        tally.store(cell, value);
      }
  info.holes = tally.holes;
}

// The row of the last inclination of the light that was measured: files repeat it up to the
// horizon.
size_t last_measured(const Block& block) {
  const size_t row = block.thetas * block.phis * block.channels * sizeof(float);
  size_t last = block.thetas - 1;
  while (last > 0 &&
         std::memcmp(block.values + last * row, block.values + (last - 1) * row, row) == 0)
    --last;
  return last > 0 ? last : block.thetas - 1; // all alike: nothing was repeated
}

} // namespace

bool is_mbsdf(std::string_view bytes) {
  return bytes.starts_with("NVIDIA ARC MBSDF");
}

MeasuredFile read_mbsdf(const InputText& input, const MeasuredOptions& options) {
  expect_one_coloured_material(input, options);
  ByteCursor cursor(input);
  std::string metadata;
  if (take_header(input, cursor, metadata) == kTransmission)
    throw input.error_at_byte(cursor.at(),
                              "the file holds transmission only, of which nothing is supported");
  const Block block = take_block(input, cursor);
  MeasuredInfo info;
  info.description = shown_text(metadata);
  if (cursor.left() > 0) {
    const char* at = cursor.at();
    if (take_line(input, cursor, "the name of the second block") != kTransmission)
      throw input.error_at_byte(at, "something else than MBSDF_DATA_TRANSMISSION= follows the "
                                    "reflection");
    take_block(input, cursor);
    if (cursor.left() > 0)
      throw input.error_at_byte(cursor.at(), "something follows the transmission");
    info.notes.push_back("the file holds transmission too, which is NOT used");
  }

  MeasuredGrid grid;
  grid.coordinates = MeasuredCoordinates::relative;
  const MeasuredAxis theta{cell_centres(block.thetas, 0, 90 * kDegree)};
  grid.axes = {theta, theta, {cell_centres(block.phis, 0, 180 * kDegree)}};
  fill(grid, block, info);
  info.resolution = fmt::format("{} x {} x {} (theta_i, theta_o, phi_o - phi_i), {}", block.thetas,
                                block.thetas, block.phis, block.channels == 1 ? "scalar" : "rgb");
  info.interpolation = "linear in the three angles between the centres of cells";
  info.symmetries = {"isotropic", "reciprocal: f(i, o) and f(o, i) are averaged",
                     "the same for phi_o - phi_i and its negative"};
  info.cells = static_cast<int64_t>(grid.rgb.size() / 3);
  const size_t last = last_measured(block);
  info.largest_theta = theta.nodes[last];
  if (last + 1 < block.thetas)
    info.notes.push_back(fmt::format("rows of light beyond {:.1f} degrees repeat the last one",
                                     info.largest_theta / kDegree));
  return {std::move(info), std::move(grid)};
}

} // namespace faceta
