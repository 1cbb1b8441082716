#include "formats/measured_common.h"
#include "formats/measured_text.h"
#include "formats/measured_text_formats.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace faceta {

namespace {

constexpr int64_t kMostWavelengths = 2000;

/// The comment lines before the first number, without '#': what the file says of itself.
std::string leading_comments(std::string_view text) {
  std::string out;
  while (text.starts_with('#') && out.size() < 1000) {
    std::string_view line = text.substr(1, text.find('\n') - 1);
    while (!line.empty() && static_cast<unsigned char>(line.front()) <= ' ')
      line.remove_prefix(1);
    while (!line.empty() && static_cast<unsigned char>(line.back()) <= ' ')
      line.remove_suffix(1);
    out += (out.empty() || line.empty() ? "" : "; ") + std::string(line.substr(0, 200));
    size_t end = text.find('\n');
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
  }
  return out;
}

} // namespace

bool is_cornell(std::string_view bytes) {
  if (!looks_like_text(bytes))
    return false;
  InputText input{bytes.substr(0, size_t(1) << 16), {}};
  TextScanner scanner(input);
  int count = 0;
  double wavelength = 0;
  auto parse = [](std::string_view word, auto& value) {
    auto result = std::from_chars(word.data(), word.data() + word.size(), value);
    return result.ec == std::errc() && result.ptr == word.data() + word.size();
  };
  return parse(scanner.word(), count) && count > 0 && parse(scanner.word(), wavelength) &&
         wavelength >= 100 && wavelength <= 20000;
}

MeasuredFile read_cornell(const InputText& input, const MeasuredOptions& options) {
  expect_one_material(input, options);
  TextScanner scanner(input);
  int64_t count = scanner.integer("the number of wavelengths", 1, kMostWavelengths);
  const char* where = scanner.last();
  MeasuredColumns columns{MeasuredColumns::kSpectral};
  for (int64_t i = 0; i < count; ++i)
    columns.wavelengths.push_back(scanner.number("a wavelength (nm)"));
  MeasuredColors colors(columns, options, input, where);

  MeasuredInfo info;
  info.description = shown_text(leading_comments(input.text));
  info.wavelengths = columns.wavelengths;
  std::vector<MeasuredSample> samples;
  std::vector<double> values(static_cast<size_t>(count));
  bool isotropic = true;
  while (!scanner.at_end()) {
    MeasuredSample s{};
    s.theta_i = scanner.number("theta_i");
    const char* row = scanner.last();
    s.phi_i = scanner.number("phi_i");
    s.theta_o = scanner.number("theta_o");
    s.phi_o = scanner.number("phi_o");
    for (double& v : values)
      v = scanner.number("a spectral value");
    fold_polar_angle(s.theta_i, s.phi_i, input, row, "theta_i");
    fold_polar_angle(s.theta_o, s.phi_o, input, row, "theta_o");
    s.rgb = colors.rgb(values.data(), info.negative);
    isotropic &= samples.empty() || std::abs(s.phi_i - samples.front().phi_i) < 1e-5;
    samples.push_back(s);
  }
  return file_from_samples(std::move(info), std::move(samples), isotropic, input);
}

} // namespace faceta
