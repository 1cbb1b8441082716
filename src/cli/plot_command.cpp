#include "cli/plot_command.h"

#include "cli/commands.h"
#include "formats/material_docs.h"
#include "formats/measured_loader.h"
#include "formats/output_file.h"
#include "image/io.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>

namespace faceta::cli {

namespace {

bool is_png(const std::string& path) {
  return std::filesystem::path(path).extension() == ".png";
}

int list_kinds() {
  for (const PlotKindInfo& info : plot_kinds()) {
    std::string options;
    for (const std::string& name : info.options)
      options += " --" + name;
    fmt::print("{:<12} {}\n{:<12}{}\n", info.name, info.summary, "",
               options.empty() ? " no options of its own" : options);
  }
  return kOk;
}

} // namespace

int run_plot(const PlotCommandOptions& options) {
  if (options.list)
    return list_kinds();
  for (const std::string& path : options.outputs)
    if (path != "-" && !is_png(path) && std::filesystem::path(path).extension() != ".svg")
      throw Error("no writer for this ending", {path}, "known: .svg, .png");
  std::vector<PlotMaterial> materials;
  for (const auto& [name, settings] : options.materials) {
    if (find_scene_node(name))
      throw Error("'" + name + "' puts materials of a scene file together and has no plot");
    materials.push_back(plot_material(parameters_of(model_or_file(name, settings))));
  }
  Drawing drawing = draw_plot(plot_kind(options.kind).kind, materials, options.plot);
  for (const std::string& path : options.outputs) {
    if (is_png(path)) {
      int width = options.width > 0 ? options.width : int(std::lround(2 * drawing.width));
      write_image(path, to_image(drawing, width, options.theme));
      continue;
    }
    OutputFile file(path);
    file.write(to_svg(drawing, {}, options.theme, options.width));
    file.commit();
  }
  return kOk;
}

} // namespace faceta::cli
