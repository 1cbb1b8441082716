#include "formats/measured_text.h"

#include "formats/measured_common.h"
#include "formats/measured_lattice.h"
#include "formats/measured_scattered.h"
#include "spectrum/cie.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace faceta {

namespace {

constexpr double kPi = std::numbers::pi;

bool is_separator(char c) {
  return c == ' ' || c == '\t' || c == ',' || c == '\r' || c == '\f' || c == '\v';
}

/// As parse_float(), for double.
NumberStatus parse_double(std::string_view word, double& value) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-')
    word.remove_prefix(1);
  const char* end = word.data() + word.size();
  auto result = std::from_chars(word.data(), end, value);
  if (result.ec == std::errc::invalid_argument || result.ptr != end)
    return NumberStatus::kMalformed;
  if (result.ec == std::errc::result_out_of_range) {
    size_t exponent = word.find_first_of("eE");
    if (exponent == word.npos || exponent + 1 == word.size() || word[exponent + 1] != '-')
      return NumberStatus::kNotFinite;
    value = 0;
  }
  return std::isfinite(value) ? NumberStatus::kOk : NumberStatus::kNotFinite;
}

} // namespace

void TextScanner::skip(bool over_lines) {
  for (; at_ != end_; ++at_) {
    if (*at_ == comment_ && comment_ != 0) {
      while (at_ != end_ && *at_ != '\n' && *at_ != '\r')
        ++at_;
      if (at_ == end_)
        return;
    }
    bool line_end = *at_ == '\n' || *at_ == '\r';
    if (line_end ? !over_lines : !is_separator(*at_))
      return;
  }
}

bool TextScanner::at_end() {
  skip(true);
  return at_ == end_;
}

bool TextScanner::at_line_end() {
  skip(false);
  return at_ == end_ || *at_ == '\n' || *at_ == '\r';
}

void TextScanner::next_line() {
  while (at_ != end_ && *at_ != '\n' && *at_ != '\r')
    ++at_;
  skip(true);
}

std::string_view TextScanner::peek() {
  skip(true);
  const char* p = at_;
  while (p != end_ && *p != '\n' && !is_separator(*p) && !(comment_ != 0 && *p == comment_))
    ++p;
  return {at_, static_cast<size_t>(p - at_)};
}

std::string_view TextScanner::word() {
  std::string_view found = peek();
  last_ = at_;
  at_ += found.size();
  return found;
}

double TextScanner::number(const char* what) {
  std::string_view found = word();
  if (found.empty())
    throw error(fmt::format("{} expected, but the file ends", what));
  double value = 0;
  NumberStatus status = parse_double(found, value);
  if (status == NumberStatus::kMalformed)
    throw error(fmt::format("{} expected, not '{}'", what, word_at(last_, end_)),
                "a number such as 0.25 or 1e-3");
  if (status == NumberStatus::kNotFinite)
    throw error(fmt::format("{} is not a finite number: '{}'", what, word_at(last_, end_)));
  return value;
}

int64_t TextScanner::integer(const char* what, int64_t least, int64_t most) {
  double value = number(what);
  if (value != std::floor(value) || !(value >= static_cast<double>(least)) ||
      !(value <= static_cast<double>(most)))
    throw error(fmt::format("{} must be an integer from {} to {}, not {}", what, least, most,
                            word_at(last_, end_)));
  return static_cast<int64_t>(value);
}

bool looks_like_text(std::string_view bytes) {
  bytes = bytes.substr(0, 4096);
  return !bytes.empty() && std::all_of(bytes.begin(), bytes.end(), [](char c) {
    return static_cast<unsigned char>(c) >= 32 || (c >= '\t' && c <= '\r');
  });
}

bool has_line_with(std::string_view bytes, std::string_view word) {
  bytes = bytes.substr(0, size_t(1) << 16);
  for (size_t at = bytes.find(word); at != bytes.npos; at = bytes.find(word, at + 1)) {
    size_t before = at;
    while (before > 0 && (bytes[before - 1] == ' ' || bytes[before - 1] == '\t'))
      --before;
    size_t behind = at + word.size();
    if ((before == 0 || bytes[before - 1] == '\n' || bytes[before - 1] == '\r') &&
        (behind == bytes.size() || static_cast<unsigned char>(bytes[behind]) <= ' '))
      return true;
  }
  return false;
}

MeasuredColors::MeasuredColors(const MeasuredColumns& columns, const MeasuredOptions& options,
                               const InputText& input, const char* where) {
  const std::vector<double>& nm = columns.wavelengths;
  if (options.wavelength >= 0 && columns.kind != MeasuredColumns::kSpectral)
    throw input.error(where, fmt::format("the file has no value at {} nm: it holds colours, not "
                                         "wavelengths",
                                         options.wavelength));
  if (columns.kind == MeasuredColumns::kGrey)
    weights_ = {{1, 1, 1}};
  if (columns.kind == MeasuredColumns::kRgb)
    weights_ = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  if (columns.kind == MeasuredColumns::kXyz)
    weights_ = {xyz_to_srgb({1, 0, 0}), xyz_to_srgb({0, 1, 0}), xyz_to_srgb({0, 0, 1})};
  if (columns.kind != MeasuredColumns::kSpectral)
    return;

  for (size_t i = 0; i < nm.size(); ++i)
    if (!(nm[i] > (i == 0 ? 0 : nm[i - 1])) || !(nm[i] < 1e6))
      throw input.error(where, fmt::format("wavelengths must increase, but {} nm follows {} nm",
                                           nm[i], i == 0 ? 0 : nm[i - 1]));
  weights_ = wavelength_weights(nm, options.wavelength, input.error(where, "").where());
}

std::array<double, 3> MeasuredColors::rgb(const double* values, int64_t& negative) const {
  std::array<double, 3> color = {0, 0, 0};
  bool below = false;
  for (size_t i = 0; i < weights_.size(); ++i) {
    below |= values[i] < 0;
    for (int c = 0; c < 3; ++c)
      color[c] += weights_[i][c] * values[i];
  }
  for (double& c : color) {
    below |= c < 0;
    c = std::clamp(c, 0.0, 1e30);
  }
  negative += below;
  return color;
}

void fold_polar_angle(double& theta, double& phi, const InputText& input, const char* where,
                      const char* name) {
  // rounded degrees and radians of 90 degrees, as files write them
  constexpr double kSlack = 2e-4;
  if (!(std::abs(theta) <= kPi / 2 + kSlack))
    throw input.error(
        where, fmt::format("{} is {:.6g} degrees: below the surface", name, theta * 180 / kPi),
        "reflection only, -90 to 90 degrees; is the unit of angles right?");
  if (theta < 0) {
    theta = -theta;
    phi += kPi;
  }
  theta = std::min(theta, kPi / 2);
}

MeasuredFile file_from_samples(MeasuredInfo info, std::vector<MeasuredSample> samples,
                               bool isotropic, const InputText& input) {
  if (samples.empty())
    throw input.error(input.text.data() + input.text.size(), "the file holds no measurement");
  info.cells = static_cast<int64_t>(samples.size());
  for (const MeasuredSample& s : samples)
    info.largest_theta = std::max({info.largest_theta, s.theta_i, s.theta_o});
  if (info.negative > 0)
    info.notes.push_back(
        fmt::format("{} of {} colours had components below zero: 0", info.negative, info.cells));
  info.symmetries.push_back(isotropic ? "isotropic" : "anisotropic");

  if (std::optional<MeasuredLattice> lattice = lattice_from_samples(samples, isotropic)) {
    info.resolution = describe_lattice(lattice->grid);
    info.holes = lattice->holes;
    if (lattice->repeated > 0)
      info.notes.push_back(
          fmt::format("{} directions were measured more than once: mean", lattice->repeated));
    if (lattice->holes > 0)
      info.notes.push_back(
          fmt::format("{} combinations of angles were not measured: holes", lattice->holes));
    info.interpolation = "linear between the measured angles, exact at them";
    return {std::move(info), std::move(lattice->grid)};
  }
  MeasuredGrid grid = grid_from_samples(samples, isotropic);
  info.resolution = fmt::format("{} directions without order, resampled to {}", info.cells,
                                describe_lattice(grid));
  info.interpolation = "log-linear local fits to the nearest measurements (" +
                       std::string(kScatteredSymmetries) + "), then linear in the grid";
  info.symmetries.push_back("reciprocal by construction");
  return {std::move(info), std::move(grid)};
}

} // namespace faceta
