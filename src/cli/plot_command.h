#pragma once

/// `faceta plot`: its options and what they make.

#include "cli/arguments.h"
#include "verify/plot.h"

#include <CLI/App.hpp>

namespace faceta::cli {

struct PlotCommandOptions {
  struct Material {
    std::string name;
    Settings settings;
  };
  std::vector<Material> materials;
  std::string kind = "polar";
  PlotOptions plot;
  PlotTheme theme = PlotTheme::automatic;
  int width = 0; ///< across, in pixels (PNG) or CSS pixels (SVG); 0: twice, or as drawn
  std::vector<std::string> outputs; ///< .svg, .png or - for SVG on the standard output
  bool list = false;
};
int run_plot(const PlotCommandOptions& options);

/// Adds the sub-command.
void add_plot(CLI::App& app, Action& action);

} // namespace faceta::cli
