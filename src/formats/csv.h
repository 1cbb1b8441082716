#pragma once

/// Tables of comma-separated values, row by row through a function: any number of rows in bounded
/// memory, blocks of rows in parallel, results in order.
///
/// The first line names the columns, in any order; the others hold a number for each. Fields may be
/// quoted, spaces around them do not count, lines may end in CR LF, empty lines are left out.

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace faceta {

/// A column that the function needs.
struct CsvInput {
  std::string name;
  /// The value of every row where the table has no such column; nothing: the table must have it.
  std::optional<float> missing;
};

/// A column that the function adds.
struct CsvOutput {
  std::string name;
  /// Empty: numbers, as the shortest decimals that read back the same float. Otherwise the words
  /// that the values 0, 1, ... stand for.
  std::vector<std::string> words;
};

/// A block of rows.
struct CsvRows {
  int count = 0;
  std::vector<std::vector<float>> input;  ///< one array of `count` for each CsvInput; finite
  std::vector<std::vector<float>> output; ///< one array of `count` zeros for each CsvOutput

  /// What is wrong with the value of an input in a row.
  struct Complaint {
    int row, input;
    std::string message, hint;
  };
  /// Set it to refuse the table: the Error names line and column.
  std::optional<Complaint> complaint;
};

/// Reads the table `source`, runs `function` over blocks of its rows (from several threads at once)
/// and writes every line as it is, with the outputs appended, to the table `target`. "-" stands for
/// standard input and output.
///
/// Error with file, line and column: no header, a column missing, named twice or already there
/// under an output's name, too few or too many fields, something that is no finite number, what the
/// function complains of. Then no target file is left behind, or the old one is kept. (What went to
/// the standard output before is not taken back.)
void transform_csv(const std::string& source, const std::string& target,
                   const std::vector<CsvInput>& inputs, const std::vector<CsvOutput>& outputs,
                   const std::function<void(CsvRows&)>& function);

} // namespace faceta
