#include "formats/measured_common.h"
#include "formats/measured_lattice.h"
#include "formats/measured_text.h"
#include "formats/measured_text_formats.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numbers>

namespace faceta {

namespace {

constexpr int64_t kMostAngles = 4096;

struct Header {
  bool is_xyz = false, plane_symmetric = false;
  std::vector<double> azimuth, radial; ///< degrees
};

/// The head of a block of values: what is said before its TIS.
struct BlockHead {
  double aoi = 0, poi = 0, wavelength = 0;
  bool front = true, reflection = true;
  int channel = 0;
  const char* where = nullptr;
};

std::vector<double> read_angles(TextScanner& scanner, const char* name) {
  int64_t count = scanner.integer(name, 1, kMostAngles);
  std::vector<double> angles;
  for (int64_t i = 0; i < count; ++i)
    angles.push_back(scanner.number(name));
  return angles;
}

int read_choice(TextScanner& scanner, std::string_view key,
                const std::vector<std::string>& choices) {
  std::string word(scanner.word().substr(0, 60));
  for (size_t i = 0; i < choices.size(); ++i)
    if (word == choices[i])
      return static_cast<int>(i);
  throw scanner.error(fmt::format("unknown {} '{}'", key, word), suggestion(word, choices));
}

Header read_header(TextScanner& scanner) {
  Header header;
  while (true) {
    std::string key(scanner.word().substr(0, 60));
    if (key.empty())
      throw scanner.error("the line DataBegin is missing");
    if (key == "DataBegin")
      break;
    if (key == "Symmetry")
      header.plane_symmetric =
          read_choice(scanner, key, {"PlaneSymmetrical", "Asymmetric", "Asymmetrical"}) == 0;
    else if (key == "SpectralContent")
      header.is_xyz = read_choice(scanner, key, {"Monochrome", "XYZ"}) == 1;
    else if (key == "ScatterAzimuth")
      header.azimuth = read_angles(scanner, "ScatterAzimuth");
    else if (key == "ScatterRadial")
      header.radial = read_angles(scanner, "ScatterRadial");
    else
      scanner.next_line(); // what else a header says does not touch the values
  }
  if (header.azimuth.empty() || header.radial.empty())
    throw scanner.error("ScatterAzimuth and ScatterRadial must stand before DataBegin");
  for (double r : header.radial)
    if (r < 0 || r > 90)
      throw scanner.error(fmt::format("ScatterRadial {} is outside 0 to 90 degrees", r));
  return header;
}

/// Reads up to and with the TIS of a block; false at DataEnd.
bool read_block_head(TextScanner& scanner, BlockHead& head) {
  while (true) {
    std::string key(scanner.word().substr(0, 60));
    if (head.where == nullptr)
      head.where = scanner.last();
    if (key == "DataEnd")
      return false;
    if (key.empty())
      throw scanner.error("the file ends without DataEnd");
    if (key == "AOI")
      head.aoi = scanner.number("AOI");
    else if (key == "POI")
      head.poi = scanner.number("POI");
    else if (key == "Wavelength")
      head.wavelength = scanner.number("Wavelength");
    else if (key == "Side")
      head.front = read_choice(scanner, key, {"Front", "Back"}) == 0;
    else if (key == "ScatterType")
      head.reflection = read_choice(scanner, key, {"BRDF", "BTDF"}) == 0;
    else if (key == "TristimulusValue")
      head.channel = read_choice(scanner, key, {"TrisX", "TrisY", "TrisZ"});
    else if (key == "TIS") {
      scanner.number("TIS");
      return true;
    } else
      throw scanner.error(fmt::format("unknown keyword '{}'", key),
                          suggestion(key, {"AOI", "POI", "Side", "Wavelength", "ScatterType",
                                           "TristimulusValue", "TIS", "DataEnd"}));
  }
}

/// The blocks of an angle of incidence, by channel or wavelength.
using Blocks = std::map<double, std::map<double, std::vector<double>>>;

Blocks read_blocks(TextScanner& scanner, const Header& header, const InputText& input,
                   MeasuredInfo& info) {
  Blocks blocks;
  size_t size = header.azimuth.size() * header.radial.size(), left_out = 0;
  bool any = false;
  double poi = 0;
  while (true) {
    BlockHead head;
    if (!read_block_head(scanner, head))
      break;
    if (size > static_cast<size_t>(scanner.bytes_left()) / 2 + 1)
      throw scanner.error(fmt::format("a block has {} values, the file is too short", size));
    std::vector<double> values(size);
    for (double& v : values)
      v = scanner.number("a value of the BSDF");
    if (!head.front || !head.reflection) {
      ++left_out;
      continue;
    }
    if (head.aoi < 0 || head.aoi > 90)
      throw input.error(head.where, fmt::format("AOI {} is outside 0 to 90 degrees", head.aoi));
    if (any && head.poi != poi)
      throw input.error(head.where, "several planes of incidence (POI) are not supported",
                        "one POI: an isotropic surface");
    any = true;
    poi = head.poi;
    double key = header.is_xyz ? head.channel : head.wavelength;
    if (!blocks[head.aoi].emplace(key, std::move(values)).second)
      throw input.error(head.where, fmt::format("a second block for AOI {}", head.aoi));
  }
  if (left_out > 0)
    info.notes.push_back(
        fmt::format("{} blocks of the back or of transmission left out", left_out));
  return blocks;
}

} // namespace

bool is_lighttools(std::string_view bytes) {
  return looks_like_text(bytes) && has_line_with(bytes, "ScatterAzimuth") &&
         !has_line_with(bytes, "AngleOfIncidence");
}

MeasuredFile read_lighttools(const InputText& input, const MeasuredOptions& options) {
  expect_one_material(input, options);
  TextScanner scanner(input);
  Header header = read_header(scanner);
  const char* data = scanner.last();
  MeasuredInfo info;
  Blocks blocks = read_blocks(scanner, header, input, info);
  if (blocks.empty())
    throw input.error(data, "no block of the front's BRDF");

  MeasuredColumns columns{header.is_xyz ? MeasuredColumns::kXyz : MeasuredColumns::kGrey};
  const auto& first = blocks.begin()->second;
  if (!header.is_xyz && (first.size() > 1 || options.wavelength >= 0)) {
    columns.kind = MeasuredColumns::kSpectral;
    for (const auto& [wavelength, values] : first)
      columns.wavelengths.push_back(wavelength);
  }
  MeasuredColors colors(columns, options, input, data);
  info.wavelengths = columns.wavelengths;
  std::vector<LatticeRow> rows;
  for (const auto& [aoi, channels] : blocks) {
    bool same = channels.size() == static_cast<size_t>(colors.count()) &&
                std::equal(channels.begin(), channels.end(), first.begin(), first.end(),
                           [](const auto& a, const auto& b) { return a.first == b.first; });
    if (!same)
      throw input.error(data,
                        fmt::format("AOI {} lacks a wavelength or colour that others have", aoi));
    size_t n = 0;
    for (double azimuth : header.azimuth)
      for (double radial : header.radial) {
        std::vector<double> values;
        for (const auto& [key, block] : channels)
          values.push_back(block[n]);
        ++n;
        double dphi = std::remainder(azimuth - 90, 360);
        if (header.plane_symmetric)
          dphi = std::abs(dphi);
        rows.push_back({{aoi * kDegree, radial * kDegree, dphi * kDegree, 0},
                        colors.rgb(values.data(), info.negative)});
      }
  }
  info.cells = static_cast<int64_t>(rows.size());
  auto lattice = lattice_from_rows(MeasuredCoordinates::relative, std::move(rows), true);
  if (!lattice)
    throw input.error(data, "the angles of the header make no grid");
  info.resolution = describe_lattice(lattice->grid);
  info.largest_theta = lattice->grid.axes[1].nodes.back();
  info.interpolation = "linear between the angles of the file, exact at them";
  info.symmetries.push_back("isotropic");
  if (info.negative > 0)
    info.notes.push_back(
        fmt::format("{} of {} colours had components below zero: 0", info.negative, info.cells));
  return {std::move(info), std::move(lattice->grid)};
}

} // namespace faceta
