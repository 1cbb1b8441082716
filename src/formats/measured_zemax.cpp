#include "formats/measured_common.h"
#include "formats/measured_lattice.h"
#include "formats/measured_text.h"
#include "formats/measured_text_formats.h"

#include <fmt/format.h>
#include <numbers>

namespace faceta {

namespace {

constexpr int64_t kMostAngles = 4096;

struct Header {
  std::string symmetry, content, scatter;
  std::vector<double> rotation{0.0}, incidence, azimuth, radial; ///< radians
  std::string source;
};

/// "AngleOfIncidence n" and n angles in degrees, increasing.
std::vector<double> read_angles(TextScanner& scanner, const char* name, double least, double most) {
  int64_t count = scanner.integer(name, 1, kMostAngles);
  std::vector<double> angles;
  for (int64_t i = 0; i < count; ++i) {
    double a = scanner.number(name);
    if (a < least || a > most)
      throw scanner.error(fmt::format("{} is {} degrees", name, a),
                          fmt::format("{} to {}", least, most));
    if (!angles.empty() && a * kDegree <= angles.back())
      throw scanner.error(fmt::format("{} must increase", name));
    angles.push_back(a * kDegree);
  }
  return angles;
}

std::string read_choice(TextScanner& scanner, std::string_view key,
                        const std::vector<std::string>& choices) {
  std::string word(scanner.word().substr(0, 60));
  for (const std::string& choice : choices)
    if (word == choice)
      return word;
  throw scanner.error(fmt::format("unknown {} '{}'", key, word), suggestion(word, choices));
}

Header read_header(TextScanner& scanner) {
  Header header;
  while (true) {
    std::string_view next = scanner.peek();
    if (next == "Monochrome" || next.starts_with("Tristimulus"))
      break;
    std::string key(scanner.word().substr(0, 60));
    if (key.empty())
      throw scanner.error("the file ends before its data",
                          "a line Monochrome or TristimulusX begins them");
    if (key == "Source")
      header.source = scanner.word().substr(0, 60);
    else if (key == "Symmetry")
      header.symmetry = read_choice(
          scanner, key,
          {"PlaneSymmetrical", "Asymmetrical", "ASymmetrical", "ASymmetrical4D", "Asymmetrical4D"});
    else if (key == "SpectralContent")
      header.content = read_choice(scanner, key, {"Monochrome", "XYZ"});
    else if (key == "ScatterType") {
      header.scatter = read_choice(scanner, key, {"BRDF", "BTDF"});
      if (header.scatter == "BTDF")
        throw scanner.error("transmission (BTDF) is not supported in this format",
                            "use the file of the BRDF, or Window XML for both");
    } else if (key == "SampleRotation")
      header.rotation = read_angles(scanner, "SampleRotation", -360, 360);
    else if (key == "AngleOfIncidence")
      header.incidence = read_angles(scanner, "AngleOfIncidence", 0, 90);
    else if (key == "ScatterAzimuth")
      header.azimuth = read_angles(scanner, "ScatterAzimuth", 0, 360);
    else if (key == "ScatterRadial")
      header.radial = read_angles(scanner, "ScatterRadial", 0, 180);
    else
      throw scanner.error(fmt::format("unknown keyword '{}'", key),
                          suggestion(key, {"Source", "Symmetry", "SpectralContent", "ScatterType",
                                           "SampleRotation", "AngleOfIncidence", "ScatterAzimuth",
                                           "ScatterRadial", "Monochrome", "TristimulusX"}));
  }
  auto need = [&](bool there, const char* key) {
    if (!there)
      throw scanner.error(fmt::format("{} is missing in the header", key));
  };
  need(!header.symmetry.empty(), "Symmetry");
  need(!header.incidence.empty(), "AngleOfIncidence");
  need(!header.azimuth.empty(), "ScatterAzimuth");
  need(!header.radial.empty(), "ScatterRadial");
  return header;
}

/// [rotation][incidence][azimuth][radial] of one channel.
std::vector<double> read_channel(TextScanner& scanner, const Header& header) {
  size_t block = header.azimuth.size() * header.radial.size();
  size_t blocks = header.rotation.size() * header.incidence.size();
  if (blocks > static_cast<size_t>(scanner.bytes_left()) / (2 * block) + 1)
    throw scanner.error(
        fmt::format("{} x {} values are declared, the file is too short for them", blocks, block));
  std::vector<double> values;
  values.reserve(blocks * block);
  if (scanner.peek() == "DataBegin")
    scanner.word();
  for (size_t b = 0; b < blocks; ++b) {
    if (scanner.word() != "TIS")
      throw scanner.error(
          fmt::format("'TIS' expected (angle of incidence {} of {})", b + 1, blocks),
          "TIS and its value stand before each block");
    scanner.number("the TIS");
    for (size_t i = 0; i < block; ++i)
      values.push_back(scanner.number("a value of the BSDF"));
  }
  if (scanner.peek() == "DataEnd")
    scanner.word();
  return values;
}

} // namespace

bool is_zemax(std::string_view bytes) {
  return looks_like_text(bytes) && has_line_with(bytes, "ScatterAzimuth") &&
         has_line_with(bytes, "AngleOfIncidence");
}

MeasuredFile read_zemax(const InputText& input, const MeasuredOptions& options) {
  expect_one_material(input, options);
  TextScanner scanner(input);
  Header header = read_header(scanner);
  bool is_color = header.content == "XYZ";
  MeasuredColors colors({is_color ? MeasuredColumns::kXyz : MeasuredColumns::kGrey}, options, input,
                        scanner.position());
  std::vector<std::vector<double>> channels;
  for (const char* name : {"TristimulusX", "TristimulusY", "TristimulusZ"}) {
    const char* wanted = is_color ? name : "Monochrome";
    if (scanner.word() != wanted)
      throw scanner.error(fmt::format("'{}' expected", wanted),
                          is_color ? "XYZ has three channels" : "");
    channels.push_back(read_channel(scanner, header));
    if (!is_color)
      break;
  }
  if (!scanner.at_end()) {
    scanner.word();
    throw scanner.error("more values than the header declares");
  }

  bool rotated = header.symmetry.ends_with("4D") && header.rotation.size() > 1;
  if (!rotated && header.rotation.size() > 1)
    throw input.error(input.text.data(),
                      "several sample rotations need the Symmetry ASymmetrical4D");
  MeasuredInfo info;
  info.description = header.source;
  std::vector<LatticeRow> rows;
  rows.reserve(channels[0].size());
  size_t n = 0;
  for (double rotation : header.rotation)
    for (double incidence : header.incidence)
      for (double azimuth : header.azimuth)
        for (double radial : header.radial) {
          double values[3] = {channels[0][n], is_color ? channels[1][n] : 0,
                              is_color ? channels[2][n] : 0};
          ++n;
          // ours counts from the direction away from the normal, the file's from that towards it
          double ours = azimuth - std::numbers::pi;
          std::array<double, 3> rgb = colors.rgb(values, info.negative);
          rows.push_back(
              rotated ? LatticeRow{{incidence, rotation + std::numbers::pi / 2, radial, ours}, rgb}
                      : LatticeRow{{incidence, radial, ours, 0}, rgb});
        }
  auto lattice = lattice_from_rows(rotated ? MeasuredCoordinates::specular_rotated
                                           : MeasuredCoordinates::specular,
                                   std::move(rows), true);
  if (!lattice)
    throw input.error(input.text.data(), "the angles of the header make no grid");
  info.resolution = describe_lattice(lattice->grid);
  info.cells = static_cast<int64_t>(channels[0].size());
  info.largest_theta = std::numbers::pi / 2;
  info.interpolation = "linear about the mirror direction, exact at the angles of the file";
  info.symmetries.push_back(rotated ? "anisotropic" : "isotropic");
  if (header.symmetry == "PlaneSymmetrical")
    info.symmetries.push_back("symmetric about the plane of incidence");
  if (info.negative > 0)
    info.notes.push_back(
        fmt::format("{} of {} colours had components below zero: 0", info.negative, info.cells));
  return {std::move(info), std::move(lattice->grid)};
}

} // namespace faceta
