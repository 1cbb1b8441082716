#pragma once

/// `faceta measure`: files of measured reflectance.

#include "cli/arguments.h"
#include "formats/measured_convert.h"
#include "formats/measured_repair.h"

namespace CLI {
class App;
}

namespace faceta::cli {

struct MeasureInfoOptions {
  /// A file, and how it is read.
  struct File {
    std::string name;
    Settings settings;
  };
  std::vector<File> files;
  bool json = false;
  std::string repair; ///< what to write the one file to, mended; empty: nowhere
  RepairOptions how;
  ConvertOptions output; ///< of `repair`
};
int run_measure_info(const MeasureInfoOptions& options);

struct MeasureConvertOptions {
  std::string source; ///< file or material
  Settings settings;
  std::string target;
  ConvertOptions output;
  bool json = false;
};
int run_measure_convert(const MeasureConvertOptions& options);

/// Registers the command.
void add_measure(CLI::App& app, Action& action);

} // namespace faceta::cli
