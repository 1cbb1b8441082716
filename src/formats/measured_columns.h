#pragma once

/// Tables whose first line, or a line of their header, names the columns: CSV and ASTM.

#include "formats/measured_text.h"

namespace faceta {

/// Where the angles and values of a row stand.
struct MeasuredTable {
  enum Angle { kThetaI, kPhiI, kThetaO, kPhiO, kDphi, kAngles };
  int column[kAngles] = {-1, -1, -1, -1, -1};
  double unit[kAngles] = {1, 1, 1, 1, 1}; ///< in radians
  std::vector<int> values;                ///< columns in the order of `colors`
  MeasuredColumns colors;
  int columns = 0;
};

/// The value columns of a table by their names: one of any name, r, g, b, X, Y, Z, or wavelengths
/// with "nm" in any order. `names` are those of the columns that are no angles, `where` their
/// places, for errors.
void name_value_columns(MeasuredTable& table, const std::vector<std::string>& names,
                        const std::vector<int>& columns, const std::vector<const char*>& where,
                        const InputText& input);

/// Reads rows, one a line, from the scanner to the end of the file.
MeasuredFile read_table_rows(TextScanner& scanner, const MeasuredTable& table, MeasuredInfo info,
                             const InputText& input, const MeasuredOptions& options,
                             const char* header, int64_t declared_rows = -1);

} // namespace faceta
