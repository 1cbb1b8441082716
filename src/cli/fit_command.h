#pragma once

/// `faceta fit`: its options and what they make.

#include "bsdf/describe.h"
#include "cli/arguments.h"
#include "verify/fit.h"

#include <CLI/App.hpp>

namespace faceta::cli {

struct FitCommandOptions {
  std::string file;
  Settings settings;   ///< of the file or material
  std::string picture; ///< side by side; empty: none
  FitOptions fit;
  double max_theta = 80;
  std::vector<std::string> outputs; ///< .xml: the material; .json: material, errors, candidates
  std::string maps;                 ///< folder for residual maps; empty: none
  bool quiet = false;
};
int run_fit(const FitCommandOptions& options);

/// Adds the sub-command.
void add_fit(CLI::App& app, Action& action);

} // namespace faceta::cli
