#include "formats/measured_common.h"
#include "formats/measured_text.h"
#include "formats/measured_text_formats.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace faceta {

namespace {

/// The angles of a vector of any length but zero.
void read_direction(TextScanner& scanner, const char* letter, const char* what, double& theta,
                    double& phi) {
  if (scanner.word() != letter)
    throw scanner.error(fmt::format("'{}' expected ({})", letter, what),
                        "triples of lines: F b g r, L x y z, V x y z");
  double v[3];
  for (double& x : v)
    x = scanner.number(what);
  double across = std::hypot(v[0], v[1]);
  if (!(std::hypot(across, v[2]) > 1e-6))
    throw scanner.error(fmt::format("{} is zero", what));
  theta = std::atan2(across, v[2]);
  phi = std::atan2(v[1], v[0]);
}

} // namespace

bool is_tvbrdf(std::string_view bytes) {
  return looks_like_text(bytes) && has_line_with(bytes, "F") && has_line_with(bytes, "L") &&
         has_line_with(bytes, "V");
}

MeasuredFile read_tvbrdf(const InputText& input, const MeasuredOptions& options) {
  expect_one_material(input, options);
  TextScanner scanner(input);
  MeasuredInfo info;
  MeasuredColors colors({MeasuredColumns::kRgb}, options, input, input.text.data());
  if (!scanner.at_end() && scanner.peek() == "Exposure")
    scanner.next_line();
  std::vector<MeasuredSample> samples;
  int64_t grazing = 0;
  while (!scanner.at_end()) {
    if (scanner.word() != "F")
      throw scanner.error("'F' expected (the radiance, blue green red)",
                          "triples of lines: F b g r, L x y z, V x y z");
    double rgb[3];
    for (int c = 2; c >= 0; --c)
      rgb[c] = scanner.number("a radiance");
    MeasuredSample s{};
    read_direction(scanner, "L", "the direction to the light", s.theta_i, s.phi_i);
    read_direction(scanner, "V", "the direction to the viewer", s.theta_o, s.phi_o);
    // the division by the cosine makes noise of what arrives along the surface
    double cosine = std::cos(s.theta_i);
    if (cosine < 0.02 || std::cos(s.theta_o) < 0.02) {
      ++grazing;
      continue;
    }
    for (double& x : rgb)
      x /= cosine;
    s.rgb = colors.rgb(rgb, info.negative);
    samples.push_back(s);
  }
  info.notes.push_back("radiance divided by the cosine of the light; its scale is not in the file");
  info.notes.push_back("taken as isotropic");
  if (grazing > 0)
    info.notes.push_back(
        fmt::format("{} measurements below 1 degree of elevation left out", grazing));
  return file_from_samples(std::move(info), std::move(samples), true, input);
}

} // namespace faceta
