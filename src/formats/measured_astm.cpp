#include "formats/measured_columns.h"
#include "formats/measured_common.h"
#include "formats/measured_text_formats.h"

#include <fmt/format.h>

namespace faceta {

bool is_astm(std::string_view bytes) {
  return looks_like_text(bytes) &&
         (has_line_with(bytes, "NUM_POINTS") || has_line_with(bytes, "VARS"));
}

MeasuredFile read_astm(const InputText& input, const MeasuredOptions& options) {
  expect_one_material(input, options);
  TextScanner scanner(input);
  MeasuredInfo info;
  int64_t declared = -1;
  while (!scanner.at_end() && scanner.peek() != "VARS") {
    std::string keyword(scanner.word().substr(0, 40));
    if (keyword == "NUM_POINTS") {
      declared = scanner.integer("NUM_POINTS", 1, int64_t(1) << 40);
      if (declared > scanner.bytes_left() / 10)
        throw scanner.error(
            fmt::format("{} points are declared, the file is too short for them", declared));
    } else if (!scanner.at_line_end()) {
      std::string line;
      while (!scanner.at_line_end() && line.size() < 200)
        line += (line.empty() ? "" : " ") + std::string(scanner.word().substr(0, 100));
      info.description += (info.description.empty() ? "" : "; ") + keyword + ": " + line;
      if (info.description.size() > 2000)
        throw scanner.error("no VARS line after 2000 characters of header");
    }
    scanner.next_line();
  }
  if (scanner.at_end())
    throw input.error(scanner.position(), "the line VARS is missing",
                      "VARS theta_i,phi_i,theta_s,phi_s,R,G,B");

  scanner.word();
  const char* header = scanner.last();
  MeasuredTable table;
  std::vector<std::string> names;
  std::vector<int> columns;
  std::vector<const char*> where;
  const std::string_view angles[] = {"theta_i", "phi_i", "theta_s", "phi_s"};
  for (; !scanner.at_line_end(); ++table.columns) {
    std::string name(scanner.word());
    if (table.columns < 4) {
      bool right = name == angles[table.columns] ||
                   (table.columns == 2 && (name == "theta_o" || name == "theta_r")) ||
                   (table.columns == 3 && (name == "phi_o" || name == "phi_r"));
      if (!right)
        throw scanner.error(fmt::format("column {} of VARS is '{}', not {}", table.columns + 1,
                                        word_at(scanner.last(), scanner.position()),
                                        angles[table.columns]));
      table.column[table.columns] = table.columns;
      continue;
    }
    if (table.columns > 2000)
      throw scanner.error("VARS names more than 2000 columns");
    names.push_back(std::move(name));
    columns.push_back(table.columns);
    where.push_back(scanner.last());
  }
  if (names.empty())
    throw input.error(scanner.position(), "VARS names no values",
                      "VARS theta_i,phi_i,theta_s,phi_s,R,G,B");
  name_value_columns(table, names, columns, where, input);
  scanner.next_line();
  return read_table_rows(scanner, table, std::move(info), input, options, header, declared);
}

} // namespace faceta
