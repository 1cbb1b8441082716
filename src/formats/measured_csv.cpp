#include "formats/measured_columns.h"
#include "formats/measured_common.h"
#include "formats/measured_text_formats.h"

#include <algorithm>
#include <fmt/format.h>
#include <numbers>

namespace faceta {

namespace {

constexpr const char* kHint = "theta_i,phi_i,theta_o,phi_o,value";

/// Takes "theta_i_rad" apart; false if the name is no angle's.
bool read_angle_name(std::string name, MeasuredTable::Angle& angle, double& unit) {
  unit = std::numbers::pi / 180;
  if (name.ends_with("_rad"))
    unit = 1;
  if (name.ends_with("_rad") || name.ends_with("_deg"))
    name.resize(name.size() - 4);
  const char* names[] = {"theta_i", "phi_i", "theta_o", "phi_o", "dphi"};
  auto found = std::find(std::begin(names), std::end(names), name);
  if (found == std::end(names))
    return false;
  angle = static_cast<MeasuredTable::Angle>(found - std::begin(names));
  return true;
}

} // namespace

bool is_brdf_csv(std::string_view bytes) {
  if (!looks_like_text(bytes))
    return false;
  InputText input{bytes.substr(0, size_t(1) << 16), {}};
  TextScanner scanner(input);
  bool has_i = false, has_o = false;
  // at_line_end() stays on the first line that is no comment
  if (scanner.at_end())
    return false;
  while (!scanner.at_line_end()) {
    std::string_view word = scanner.word();
    has_i |= word.starts_with("theta_i");
    has_o |= word.starts_with("theta_o");
  }
  return has_i || has_o;
}

MeasuredFile read_brdf_csv(const InputText& input, const MeasuredOptions& options) {
  expect_one_material(input, options);
  TextScanner scanner(input);
  scanner.at_end();
  const char* header = scanner.position();
  MeasuredTable table;
  std::vector<std::string> names;
  std::vector<int> columns;
  std::vector<const char*> where;
  for (; !scanner.at_line_end(); ++table.columns) {
    std::string name(scanner.word());
    MeasuredTable::Angle angle;
    double unit = 1;
    if (table.columns > 2000)
      throw scanner.error("the header names more than 2000 columns");
    if (!read_angle_name(name, angle, unit)) {
      names.push_back(std::move(name));
      columns.push_back(table.columns);
      where.push_back(scanner.last());
    } else if (table.column[angle] >= 0) {
      throw scanner.error(fmt::format("column '{}' occurs twice", name));
    } else {
      table.column[angle] = table.columns;
      table.unit[angle] = unit;
    }
  }
  bool has_azimuth = table.column[MeasuredTable::kPhiO] >= 0;
  bool has_dphi = table.column[MeasuredTable::kDphi] >= 0;
  if (table.column[MeasuredTable::kThetaI] < 0 || table.column[MeasuredTable::kThetaO] < 0)
    throw input.error(header, "the columns theta_i and theta_o must be there", kHint);
  if (has_azimuth == has_dphi)
    throw input.error(header, "exactly one of the columns phi_o and dphi must be there", kHint);
  if (names.empty())
    throw input.error(header, "no column of values", kHint);
  name_value_columns(table, names, columns, where, input);
  scanner.next_line();
  MeasuredInfo info;
  return read_table_rows(scanner, table, std::move(info), input, options, header);
}

} // namespace faceta
