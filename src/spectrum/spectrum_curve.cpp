#include "spectrum/spectrum_curve.h"

#include "spectrum/cie.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

namespace faceta {
namespace {

constexpr std::string_view kBlank = " \t\r\n\v\f";
constexpr std::uintmax_t kMaxFileSize = 64u << 20;

/// A piece of the input made fit for a message: short, without control characters.
std::string quoted(std::string_view text) {
  std::string result = "'";
  for (char c : text.substr(0, 40))
    result += static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
  return result + (text.size() > 40 ? "...'" : "'");
}

/// Colours are floats in the end: what a float cannot hold counts as infinite.
bool is_finite(double value) {
  return std::abs(value) <= std::numeric_limits<float>::max();
}

/// All of `text` as one finite number.
std::optional<double> to_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-"))
    text.remove_prefix(1);
  double value = 0;
  auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !is_finite(value))
    return std::nullopt;
  return value;
}

/// Cuts the next token off the front of `text`; empty at the end.
std::string_view next_token(std::string_view& text, std::string_view separators) {
  size_t begin = std::min(text.find_first_not_of(separators), text.size());
  size_t end = std::min(text.find_first_of(separators, begin), text.size());
  std::string_view token = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return token;
}

std::vector<std::string_view> tokens_of(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> tokens;
  for (auto t = next_token(text, separators); !t.empty(); t = next_token(text, separators))
    tokens.push_back(t);
  return tokens;
}

/// Appends a pair; complains if the wavelength does not follow the last one.
void append(SpectrumCurve& curve, double wavelength, double value, std::string_view token,
            const SourcePosition& where) {
  if (!curve.wavelengths.empty() && !(wavelength > curve.wavelengths.back()))
    throw Error("the wavelengths of a spectrum must increase strictly, " + quoted(token) +
                    " does not follow",
                where, "list each wavelength once, shortest first");
  curve.wavelengths.push_back(wavelength);
  curve.values.push_back(value);
}

void check_length(const SpectrumCurve& curve, const SourcePosition& where) {
  if (curve.wavelengths.size() < 2)
    throw Error("a spectrum needs at least two wavelengths, this one has " +
                    std::to_string(curve.wavelengths.size()),
                where);
}

} // namespace

void check_spectrum(const SpectrumCurve& curve, const SourcePosition& where) {
  if (curve.wavelengths.size() != curve.values.size())
    throw Error("a spectrum has " + std::to_string(curve.wavelengths.size()) + " wavelengths but " +
                    std::to_string(curve.values.size()) + " values",
                where, "give one value per wavelength");
  check_length(curve, where);
  for (size_t i = 0; i < curve.values.size(); ++i) {
    double wavelength = curve.wavelengths[i];
    if (!is_finite(wavelength) || !is_finite(curve.values[i]))
      throw Error("entry " + std::to_string(i + 1) + " of a spectrum is not a finite number",
                  where);
    if (i > 0 && !(wavelength > curve.wavelengths[i - 1]))
      throw Error("the wavelengths of a spectrum must increase strictly, " +
                      std::to_string(wavelength) + " nm does not follow",
                  where, "list each wavelength once, shortest first");
  }
}

double spectrum_at(const SpectrumCurve& curve, double wavelength) {
  const std::vector<double>& w = curve.wavelengths;
  if (!(wavelength >= w.front() && wavelength <= w.back()))
    return 0;
  size_t right = static_cast<size_t>(std::upper_bound(w.begin(), w.end(), wavelength) - w.begin());
  right = std::min(right, w.size() - 1);
  double t = (wavelength - w[right - 1]) / (w[right] - w[right - 1]);
  return (1 - t) * curve.values[right - 1] + t * curve.values[right];
}

SpectrumValue parse_spectrum(std::string_view text, const SourcePosition& where) {
  static const std::string kHint =
      "expected one number, or wavelength:value pairs such as \"400:0.1, 700:0.2\"";
  std::vector<std::string_view> tokens = tokens_of(text, ", \t\r\n\v\f");
  if (tokens.empty())
    throw Error("the spectrum is empty", where, kHint);
  if (tokens.size() == 1 && tokens[0].find(':') == std::string_view::npos) {
    if (auto value = to_number(tokens[0]))
      return *value;
    throw Error(quoted(tokens[0]) + " is not a finite number", where, kHint);
  }
  SpectrumCurve curve;
  for (std::string_view token : tokens) {
    size_t colon = token.find(':');
    if (colon == std::string_view::npos)
      throw Error(quoted(token) + " is not a wavelength:value pair", where, kHint);
    auto wavelength = to_number(token.substr(0, colon));
    auto value = to_number(token.substr(colon + 1));
    if (!wavelength || !value)
      throw Error(quoted(token) + " is not a wavelength:value pair of finite numbers", where,
                  kHint);
    append(curve, *wavelength, *value, token, where);
  }
  check_length(curve, where);
  return curve;
}

SpectrumCurve parse_spectrum_text(std::string_view text, const std::string& name) {
  static const std::string kHint = "expected a wavelength in nm and a value, \"550 0.3\"";
  SpectrumCurve curve;
  if (text.starts_with("\xef\xbb\xbf"))
    text.remove_prefix(3);
  for (int number = 1; !text.empty(); ++number) {
    size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    std::string_view rest = line.substr(0, line.find('#'));
    std::string_view tokens[3];
    for (std::string_view& token : tokens)
      token = next_token(rest, kBlank);
    if (tokens[0].empty())
      continue;

    auto position = [&](std::string_view token) {
      return SourcePosition{name, number, static_cast<int>(token.data() - line.data()) + 1};
    };
    if (tokens[1].empty())
      throw Error("there is no value after the wavelength " + quoted(tokens[0]),
                  position(tokens[0]), kHint);
    if (!tokens[2].empty())
      throw Error("a third column, " + quoted(tokens[2]) + ", in a spectrum", position(tokens[2]),
                  kHint);
    std::optional<double> numbers[2];
    for (int i = 0; i < 2; ++i)
      if (!(numbers[i] = to_number(tokens[i])))
        throw Error(quoted(tokens[i]) + " is not a finite number", position(tokens[i]), kHint);
    append(curve, *numbers[0], *numbers[1], tokens[0], position(tokens[0]));
  }
  check_length(curve, {name, 0, 0});
  return curve;
}

SpectrumCurve read_spectrum_file(const std::filesystem::path& path) {
  SourcePosition where{path.string(), 0, 0};
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed))
    throw Error(std::filesystem::exists(path, failed) ? "the spectrum is not a regular file"
                                                      : "the spectrum file does not exist",
                where);
  std::uintmax_t size = std::filesystem::file_size(path, failed);
  if (failed)
    throw Error("the spectrum file cannot be read: " + failed.message(), where);
  if (size > kMaxFileSize)
    throw Error("the spectrum file is longer than 64 MiB", where);
  std::ifstream stream(path, std::ios::binary);
  std::string text(static_cast<size_t>(size), '\0');
  if (!stream.read(text.data(), static_cast<std::streamsize>(size)))
    throw Error("the spectrum file cannot be read", where);
  return parse_spectrum_text(text, path.string());
}

std::array<double, 3> spectrum_to_xyz(const SpectrumCurve& curve, bool lit_by_d65) {
  constexpr int kSteps = 1000;
  constexpr double kWidth = kCieMax - kCieMin;
  std::array<double, 3> sum{};
  for (int i = 0; i < kSteps; ++i) {
    double wavelength = kCieMin + kWidth * i / (kSteps - 1);
    double value = spectrum_at(curve, wavelength);
    if (lit_by_d65)
      value *= cie_d65(wavelength);
    std::array<double, 3> xyz = cie1931_xyz(wavelength);
    for (size_t c = 0; c < 3; ++c)
      sum[c] += xyz[c] * value;
  }
  for (double& s : sum)
    s *= kWidth / kSteps * kCieYNormalization;
  return sum;
}

std::array<double, 3> spectrum_to_rgb(const SpectrumValue& spectrum, SpectrumUse use) {
  if (const double* value = std::get_if<double>(&spectrum)) {
    if (use != SpectrumUse::emission)
      return {*value, *value, *value};
    return xyz_to_srgb({*value, *value, *value});
  }
  bool lit = use == SpectrumUse::reflectance || use == SpectrumUse::unbounded;
  auto rgb = xyz_to_srgb(spectrum_to_xyz(std::get<SpectrumCurve>(spectrum), lit));
  for (double& c : rgb) {
    c = std::max(c, 0.0);
    if (use == SpectrumUse::reflectance)
      c = std::min(c, 1.0);
  }
  return rgb;
}

} // namespace faceta
