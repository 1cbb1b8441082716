#include "cli/commands.h"
#include "cli/plot_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>

namespace faceta::cli {

namespace {

/// "diffuse + phong exponent=20": a name and its settings, a plus between.
std::vector<PlotCommandOptions::Material> materials_of(const std::vector<std::string>& words) {
  std::vector<PlotCommandOptions::Material> materials;
  bool begin = true;
  for (const std::string& word : words) {
    if (word == "+") {
      if (begin)
        throw CLI::ValidationError("a + stands between two materials");
    } else if (begin) {
      if (word.find('=') != std::string::npos)
        throw CLI::ValidationError("'" + word + "' stands where the name of a material should");
      materials.push_back({word, {}});
    } else {
      if (word.find('=') == std::string::npos)
        throw CLI::ValidationError("'" + word +
                                   "' is not of the form name=value; a + stands between materials");
      materials.back().settings.push_back(settings_of({word})[0]);
    }
    begin = word == "+";
  }
  if (begin)
    throw CLI::ValidationError(words.empty() ? "give a material, or --list"
                                             : "a + stands between two materials");
  return materials;
}

std::string finite_number(const std::string& text) {
  double value = 0;
  if (CLI::detail::lexical_cast(text, value) && std::isfinite(value))
    return {};
  return "'" + text + "' is no finite number";
}

/// "480x360".
void set_size(PlotOptions& plot, const std::string& text) {
  size_t x = text.find('x');
  int width = 0, height = 0;
  if (x == std::string::npos || !CLI::detail::lexical_cast(text.substr(0, x), width) ||
      !CLI::detail::lexical_cast(text.substr(x + 1), height) || width < 1 || height < 1)
    throw CLI::ValidationError("'" + text + "' is not of the form WxH");
  plot.width = width, plot.height = height;
}

/// The options that only some kinds look at, by their names in PlotKindInfo.
void add_kind_options(CLI::App& sub, PlotOptions& plot) {
  sub.add_option("--theta", plot.thetas, "angles of the viewer from the normal: 0,30,60,80")
      ->delimiter(',')
      ->check(finite_number)
      ->type_name("DEGREES");
  sub.add_option("--phi", plot.phi, "azimuth of the plane of incidence")
      ->check(finite_number)
      ->type_name("DEGREES");
  auto* logarithmic = sub.add_flag_callback(
      "--log", [&plot] { plot.logarithmic = true; }, "logarithmic radius or colours");
  sub.add_flag_callback(
         "--linear", [&plot] { plot.logarithmic = false; }, "linear ones")
      ->excludes(logarithmic);
  static const std::map<std::string, PlotColour> channels = {{"luminance", PlotColour::luminance},
                                                             {"r", PlotColour::red},
                                                             {"g", PlotColour::green},
                                                             {"b", PlotColour::blue},
                                                             {"all", PlotColour::all}};
  sub.add_option_function<std::string>(
         "--channel", [&plot](const std::string& name) { plot.colour = channels.at(name); },
         "r, g, b, luminance (default) or all")
      ->check(CLI::IsMember({"r", "g", "b", "luminance", "all"}))
      ->type_name("NAME");
  sub.add_flag("--inside", plot.inside, "the viewer is below the surface");
  sub.add_option("--samples", plot.samples, "how many (524288)")
      ->check(CLI::Range(1, 1 << 28))
      ->type_name("N");
}

void check_kind_options(const CLI::App& sub, const PlotKindInfo& kind) {
  for (const char* option : {"theta", "phi", "log", "linear", "channel", "inside", "samples"}) {
    std::string needed = std::string(option) == "linear" ? "log" : option;
    if (!sub.count("--" + std::string(option)) ||
        std::find(kind.options.begin(), kind.options.end(), needed) != kind.options.end())
      continue;
    std::string known;
    for (const std::string& name : kind.options)
      known += (known.empty() ? "--" : ", --") + name;
    throw CLI::ValidationError("--" + std::string(option) + " means nothing to the kind " +
                               kind.name + "; it takes " + (known.empty() ? "none" : known));
  }
}

} // namespace

void add_plot(CLI::App& app, Action& action) {
  auto options = std::make_shared<PlotCommandOptions>();
  auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* sub = app.add_subcommand("plot", "Plot materials: lobes, albedo, sampling");
  sub->footer("faceta plot roughconductor alpha=0.3 + orennayar sigma=0.5 --kind albedo -o a.svg\n"
              "An SVG follows the reader's light or dark colours and embeds into HTML as it is.");
  sub->add_option("materials", *words,
                  "names or measured files, each perhaps with NAME=VALUE, a + between them")
      ->type_name("MATERIAL");
  std::vector<std::string> kinds;
  for (const PlotKindInfo& info : plot_kinds())
    kinds.push_back(info.name);
  sub->add_option("--kind", options->kind, "one of those that --list shows")
      ->check(CLI::IsMember(kinds))
      ->capture_default_str()
      ->type_name("KIND");
  sub->add_option("-o,--output", options->outputs,
                  "picture: .svg or .png, - is SVG on the standard output; may come several times")
      ->allow_extra_args(false)
      ->type_name("FILE");
  add_kind_options(*sub, options->plot);
  sub->add_option_function<std::string>(
         "--size", [options](const std::string& text) { set_size(options->plot, text); },
         "of the drawing, in which text has 13 pixels (default: 480 wide, as high as needed)")
      ->type_name("WxH");
  sub->add_option("--width", options->width,
                  "of the picture in pixels (default: PNG twice the drawing's, SVG the drawing's)")
      ->check(CLI::Range(16, 16384))
      ->type_name("N");
  sub->add_option_function<std::string>(
         "--theme",
         [options](const std::string& name) {
           options->theme = name == "light"  ? PlotTheme::light
                            : name == "dark" ? PlotTheme::dark
                                             : PlotTheme::automatic;
         },
         "auto (default: the reader's, light in PNG), light or dark")
      ->check(CLI::IsMember({"auto", "light", "dark"}))
      ->type_name("NAME");
  sub->add_flag("--list", options->list, "list the kinds");
  sub->callback([=, &action] {
    if (!options->list) {
      options->materials = materials_of(*words);
      if (options->outputs.empty())
        throw CLI::ValidationError("give the name of the picture: -o FILE.svg or .png");
      check_kind_options(*sub, plot_kind(options->kind));
    }
    action = [=] { return run_plot(*options); };
  });
}

} // namespace faceta::cli
