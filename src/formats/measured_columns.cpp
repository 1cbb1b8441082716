#include "formats/measured_columns.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace faceta {

namespace {

/// 550 of "550nm" or "550 nm" (which the caller has joined); nothing for other names.
bool parse_wavelength(std::string_view name, double& nm) {
  if (!name.ends_with("nm"))
    return false;
  name.remove_suffix(2);
  auto result = std::from_chars(name.data(), name.data() + name.size(), nm);
  return result.ec == std::errc() && result.ptr == name.data() + name.size() && std::isfinite(nm);
}

} // namespace

void name_value_columns(MeasuredTable& table, const std::vector<std::string>& names,
                        const std::vector<int>& columns, const std::vector<const char*>& where,
                        const InputText& input) {
  auto find = [&](std::string_view a, std::string_view b, std::string_view c) {
    std::vector<int> found;
    for (std::string_view wanted : {a, b, c})
      for (size_t i = 0; i < names.size(); ++i)
        if (names[i] == wanted)
          found.push_back(columns[i]);
    return found.size() == 3 && names.size() == 3 ? found : std::vector<int>();
  };
  table.values = find("r", "g", "b");
  table.colors.kind = MeasuredColumns::kRgb;
  if (table.values.empty())
    table.values = find("R", "G", "B");
  if (table.values.empty()) {
    table.values = find("X", "Y", "Z");
    table.colors.kind = MeasuredColumns::kXyz;
  }
  if (!table.values.empty())
    return;

  double nm = 0;
  if (names.size() == 1 && !parse_wavelength(names[0], nm)) {
    table.colors.kind = MeasuredColumns::kGrey;
    table.values = columns;
    return;
  }
  std::vector<std::pair<double, int>> bands;
  for (size_t i = 0; i < names.size(); ++i) {
    if (!parse_wavelength(names[i], nm))
      throw input.error(where[i], fmt::format("unknown column '{}'", names[i].substr(0, 40)),
                        "known: the angles theta_i, phi_i, theta_o, phi_o, dphi, and value, or "
                        "r, g, b, or X, Y, Z, or wavelengths such as 550nm");
    bands.push_back({nm, columns[i]});
  }
  std::sort(bands.begin(), bands.end());
  table.colors.kind = MeasuredColumns::kSpectral;
  for (const auto& [wavelength, column] : bands) {
    table.colors.wavelengths.push_back(wavelength);
    table.values.push_back(column);
  }
}

MeasuredFile read_table_rows(TextScanner& scanner, const MeasuredTable& table, MeasuredInfo info,
                             const InputText& input, const MeasuredOptions& options,
                             const char* header, int64_t declared_rows) {
  MeasuredColors colors(table.colors, options, input, header);
  info.wavelengths = table.colors.wavelengths;
  std::vector<MeasuredSample> samples;
  std::vector<double> row(static_cast<size_t>(table.columns)), values(table.values.size());
  bool isotropic = true;
  while (!scanner.at_end()) {
    const char* where = scanner.position();
    for (int k = 0; k < table.columns; ++k) {
      if (scanner.at_line_end())
        throw input.error(scanner.position(),
                          fmt::format("the row has {} numbers, not {}", k, table.columns));
      row[k] = scanner.number("a number");
    }
    if (!scanner.at_line_end())
      throw input.error(scanner.position(),
                        fmt::format("the row has more than {} numbers", table.columns));
    auto angle = [&](MeasuredTable::Angle a) {
      return table.column[a] < 0 ? 0.0 : row[table.column[a]] * table.unit[a];
    };
    MeasuredSample s{angle(MeasuredTable::kThetaI),
                     angle(MeasuredTable::kPhiI),
                     angle(MeasuredTable::kThetaO),
                     0,
                     {}};
    s.phi_o = table.column[MeasuredTable::kDphi] >= 0 ? s.phi_i + angle(MeasuredTable::kDphi)
                                                      : angle(MeasuredTable::kPhiO);
    fold_polar_angle(s.theta_i, s.phi_i, input, where, "theta_i");
    fold_polar_angle(s.theta_o, s.phi_o, input, where, "theta_o");
    for (size_t k = 0; k < values.size(); ++k)
      values[k] = row[table.values[k]];
    s.rgb = colors.rgb(values.data(), info.negative);
    isotropic &= samples.empty() || std::abs(std::remainder(s.phi_i - samples.front().phi_i,
                                                            2 * 3.14159265358979)) < 1e-5;
    samples.push_back(s);
  }
  if (declared_rows >= 0 && declared_rows != static_cast<int64_t>(samples.size()))
    throw input.error(header, fmt::format("{} rows are declared, the file has {}", declared_rows,
                                          samples.size()));
  return file_from_samples(std::move(info), std::move(samples), isotropic, input);
}

} // namespace faceta
