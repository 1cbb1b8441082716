#include "formats/measured_curet.h"

#include "formats/measured_text.h"
#include "formats/measured_text_formats.h"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <numbers>

namespace faceta {

namespace {

constexpr int kMeasurements = 205;
constexpr double kPi = std::numbers::pi;

// theta_o, phi_o, theta_i, phi_i of the first camera (the table that goes with Dana et al. 1999)
constexpr CuretDirections kFirstCamera[55] = {
    {1.389566, -1.970402, 1.374447, -1.570796},
    {0.981748, 0, 1.374447, 0},
    {1.463021, -2.763231, 1.370707, -2.376765},
    {1.308097, -1.163336, 1.370707, -0.764828},
    {0.987375, -0.134267, 1.370707, -0.041141},
    {1.215585, -0.811489, 1.360401, -0.430767},
    {1.007874, -0.282959, 1.360401, -0.094629},
    {1.141555, -0.627520, 1.357866, -0.281035},
    {1.050598, -0.417031, 1.357866, -0.153484},
    {1.209430, -1.992270, 1.178098, -1.570796},
    {0.785399, 0, 1.178098, 0},
    {1.272499, -2.496589, 1.154239, -2.096192},
    {1.099841, -1.476736, 1.154239, -1.045400},
    {0.774850, -0.219877, 1.154239, -0.094629},
    {1.348016, -2.815465, 1.150262, -2.456873},
    {1.008179, -1.101321, 1.150262, -0.684719},
    {0.809816, -0.439945, 1.150262, -0.201358},
    {1.421060, -3.015733, 1.130287, -2.738536},
    {0.877978, -0.762419, 1.130287, -0.403056},
    {1.374447, 3.141593, 0.981748, 3.141593},
    {1.031794, -2.032979, 0.981748, -1.570796},
    {0.589049, 0, 0.981748, 0},
    {1.337086, -3.090099, 0.955317, -2.988109},
    {1.101194, -2.432726, 0.955317, -2.005315},
    {0.909333, -1.623802, 0.955317, -1.136277},
    {0.582273, -0.334581, 0.955317, -0.153484},
    {1.128806, -2.736898, 0.876815, -2.376909},
    {0.716526, -1.270836, 0.876815, -0.764684},
    {1.217332, -2.966775, 0.876815, -2.738536},
    {0.581425, -0.799895, 0.876815, -0.403056},
    {1.178097, 3.141593, 0.785398, 3.141593},
    {0.858886, -2.100699, 0.785398, -1.570796},
    {0.392699, 0, 0.785398, 0},
    {1.038285, -3.013835, 0.662145, -2.860557},
    {0.866142, -2.496546, 0.662145, -2.005315},
    {0.627477, -1.794991, 0.662145, -1.136277},
    {0.318893, -0.713993, 0.662145, -0.281035},
    {0.929649, -2.801295, 0.615479, -2.456873},
    {0.426124, -1.398445, 0.615479, -0.684719},
    {0.981747, 3.141593, 0.589048, 3.141593},
    {0.694806, -2.211453, 0.589048, -1.570796},
    {0.196349, 0, 0.589048, 0},
    {0.839669, -2.948852, 0.472749, -2.710826},
    {0.733813, -2.628785, 0.472749, -2.096192},
    {0.445325, -1.955310, 0.472749, -1.045400},
    {0.213063, -1.410017, 0.472749, -0.430767},
    {0.785398, 3.141593, 0.392699, 3.141593},
    {0.548028, -2.395741, 0.392699, -1.570796},
    {0.000001, 3.141593, 0.392699, 0},
    {0.625671, -2.857075, 0.284924, -2.376765},
    {0.274014, -2.335623, 0.284924, -0.764828},
    {0.589048, 3.141593, 0.196349, 3.141593},
    {0.436759, -2.701422, 0.196349, -1.570796},
    {0.196350, 3.141593, 0.196349, 0},
    {0.392699, 3.141593, 0, 0},
};

std::array<double, 3> direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

std::array<CuretDirections, kMeasurements> make_directions() {
  constexpr double kStep = kPi / 8, kLargest = 84 * kPi / 180;
  std::array<CuretDirections, kMeasurements> out{};
  size_t count = 0;
  for (int camera = 1; camera <= 7; ++camera)
    for (const CuretDirections& first : kFirstCamera) {
      auto light = direction(first.theta_i, first.phi_i);
      auto view = direction(first.theta_o, first.phi_o);
      // the camera turned on, in the plane of the light and the first camera
      double turned[3];
      for (int k = 0; k < 3; ++k) {
        double across = (view[k] - std::cos(kStep) * light[k]) / std::sin(kStep);
        turned[k] = std::cos(camera * kStep) * light[k] + std::sin(camera * kStep) * across;
      }
      double theta = std::atan2(std::hypot(turned[0], turned[1]), turned[2]);
      if (theta < kLargest && count < out.size())
        out[count++] = {theta, std::atan2(turned[1], turned[0]), first.theta_i, first.phi_i};
    }
  return out;
}

/// How many words the first line has.
int words_in_first_line(std::string_view bytes) {
  InputText input{bytes.substr(0, size_t(1) << 16), {}};
  TextScanner scanner(input);
  int count = 0;
  if (!scanner.at_end())
    for (; !scanner.at_line_end(); ++count)
      scanner.word();
  return count;
}

/// The measurements of material `index`.
std::vector<double> read_material(const InputText& input, int index) {
  TextScanner scanner(input);
  int64_t materials = 0;
  std::vector<double> values(kMeasurements);
  while (!scanner.at_end()) {
    int64_t id = scanner.integer("the number of a material", 1, 1'000'000);
    for (int k = 0; k < kMeasurements; ++k) {
      if (scanner.at_line_end())
        throw input.error(scanner.position(), fmt::format("material {} has {} measurements, not {}",
                                                          id, k, kMeasurements));
      values[k] = scanner.number("a measurement");
    }
    if (!scanner.at_line_end())
      throw input.error(scanner.position(), fmt::format("material {} has more than {} measurements",
                                                        id, kMeasurements));
    if (id == index)
      return values;
    ++materials;
  }
  throw input.error(scanner.position(), fmt::format("there is no material {}", index),
                    fmt::format("the file has {} materials", materials));
}

/// The values of the three channels if the file is one of rbrdf.dat, gbrdf.dat, bbrdf.dat and the
/// other two lie beside it; else only its own.
std::vector<std::vector<double>> read_channels(const InputText& input, int index,
                                               MeasuredInfo& info) {
  std::vector<double> own = read_material(input, index);
  std::filesystem::path path(input.name);
  std::string name = path.filename().string();
  const std::string_view letters = "rgb";
  if (name.size() < 2 || name.substr(1) != "brdf.dat" || letters.find(name[0]) == letters.npos)
    return {own};
  std::vector<std::vector<double>> channels;
  for (char letter : letters) {
    std::filesystem::path other = path.parent_path() / (std::string(1, letter) + "brdf.dat");
    std::error_code code;
    if (letter == name[0]) {
      channels.push_back(own);
    } else if (std::filesystem::is_regular_file(other, code)) {
      std::string bytes = read_whole_file(other.string());
      channels.push_back(read_material({bytes, other.string()}, index));
    } else {
      info.notes.push_back(fmt::format("one colour as grey: there is no {} beside the file",
                                       other.filename().string()));
      return {own};
    }
  }
  info.notes.push_back("the colours of rbrdf.dat, gbrdf.dat and bbrdf.dat");
  return channels;
}

} // namespace

const std::array<CuretDirections, 205>& curet_directions() {
  static const std::array<CuretDirections, kMeasurements> directions = make_directions();
  return directions;
}

bool is_curet(std::string_view bytes) {
  if (!looks_like_text(bytes))
    return false;
  InputText input{bytes.substr(0, 4096), {}};
  TextScanner scanner(input);
  if (scanner.word() != "1")
    return false;
  int words = words_in_first_line(bytes);
  return words == 4 || words == 6 || words == 56 || words > 100;
}

MeasuredFile read_curet(const InputText& input, const MeasuredOptions& options) {
  int words = words_in_first_line(input.text);
  if (words < 100)
    throw input.error(input.text.data(),
                      fmt::format("a CUReT table of model parameters ({} a material: {}) is not "
                                  "supported",
                                  words - 1,
                                  words == 4 ? "Oren-Nayar rho, sigma, kd" : "Koenderink"),
                      "its measurements are: abrdf.dat, or rbrdf.dat, gbrdf.dat and bbrdf.dat");
  MeasuredInfo info;
  info.description = fmt::format("material {}", options.index);
  auto channels = read_channels(input, options.index, info);
  MeasuredColors colors({channels.size() == 3 ? MeasuredColumns::kRgb : MeasuredColumns::kGrey},
                        options, input, input.text.data());
  std::vector<MeasuredSample> samples;
  for (size_t i = 0; i < kMeasurements; ++i) {
    const CuretDirections& d = curet_directions()[i];
    double values[3] = {};
    for (size_t c = 0; c < channels.size(); ++c)
      values[c] = channels[c][i];
    samples.push_back({d.theta_i, d.phi_i, d.theta_o, d.phi_o, colors.rgb(values, info.negative)});
  }
  info.notes.push_back("taken as isotropic");
  return file_from_samples(std::move(info), std::move(samples), true, input);
}

} // namespace faceta
