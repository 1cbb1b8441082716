#include "cli/commands.h"
#include "cli/measure_command.h"

#include <CLI/CLI.hpp>
#include <memory>

namespace faceta::cli {

namespace {

const std::map<std::string, MeasuredTarget> kTargets = {
    {"rgl", MeasuredTarget::rgl}, {"merl", MeasuredTarget::merl}, {"csv", MeasuredTarget::csv}};

/// How a file is written, and whether that was said.
struct TargetArguments {
  std::string name;
  std::optional<double> resolution;
};

void add_target(CLI::App& app, TargetArguments& arguments) {
  app.add_option("--to", arguments.name,
                 "rgl, merl or csv (default: by the ending .bsdf, .binary or .csv)")
      ->check(CLI::IsMember({"rgl", "merl", "csv"}))
      ->type_name("FORMAT");
  app.add_option("--resolution", arguments.resolution,
                 "rgl: texels a side (default: what the material needs); csv: degrees between "
                 "angles (5, or 10 if not isotropic)")
      ->check(CLI::PositiveNumber)
      ->type_name("N");
}

void set_target(ConvertOptions& options, const TargetArguments& arguments,
                const std::string& path) {
  options.resolution = arguments.resolution;
  if (!arguments.name.empty())
    options.target = kTargets.at(arguments.name);
  else if (auto target = measured_target(path))
    options.target = *target;
  else
    throw CLI::ValidationError("the ending of '" + path +
                               "' names no format that can be written; give --to rgl, merl or csv");
}

void add_measure_info(CLI::App& app, Action& action) {
  auto options = std::make_shared<MeasureInfoOptions>();
  auto words = std::make_shared<std::vector<std::string>>();
  auto target = std::make_shared<TargetArguments>();
  CLI::App* sub = app.add_subcommand("info", "What is in files, and how sound it is");
  sub->footer("Behind a file may stand how it is read: format, merl_nodes, utia_color, index or\n"
              "wavelength, as `faceta materials measured` has them.");
  sub->add_option("files", *words, "files of any format, each perhaps with NAME=VALUE")
      ->required()
      ->type_name("FILE");
  sub->add_flag("--json", options->json, "as JSON");
  auto* repair = sub->add_option("--repair", options->repair,
                                 "also write the file without its faults: holes filled, negative "
                                 "values 0, reciprocal, no albedo above 1")
                     ->type_name("OUT");
  sub->add_flag("!--no-symmetrise", options->how.symmetrise,
                "leave f(a, b) and f(b, a) as different as they are")
      ->needs(repair);
  sub->add_option("--max-theta", options->how.max_theta,
                  "degrees from the normal beyond which values are drawn from those before")
      ->check(CLI::Range(10.0, 89.9))
      ->needs(repair)
      ->type_name("DEGREES");
  add_target(*sub, *target);
  for (const char* name : {"--to", "--resolution"})
    sub->get_option(name)->needs(repair);
  sub->callback([=, &action] {
    for (const std::string& word : *words)
      if (word.find('=') == std::string::npos)
        options->files.push_back({word, {}});
      else if (options->files.empty())
        throw CLI::ValidationError("'" + word + "' stands behind no file");
      else
        options->files.back().settings.push_back(settings_of({word})[0]);
    if (!options->repair.empty()) {
      if (options->files.size() != 1)
        throw CLI::ValidationError("--repair takes one file at a time");
      set_target(options->output, *target, options->repair);
    }
    action = [=] { return run_measure_info(*options); };
  });
}

void add_measure_convert(CLI::App& app, Action& action) {
  auto options = std::make_shared<MeasureConvertOptions>();
  auto words = std::make_shared<std::vector<std::string>>();
  auto target = std::make_shared<TargetArguments>();
  CLI::App* sub = app.add_subcommand("convert", "Write a measured file, or a material, as another");
  sub->footer("faceta measure convert gold.binary gold.bsdf\n"
              "faceta measure convert roughconductor material=Au alpha=0.2 gold.bsdf");
  sub->add_option("words", *words,
                  "a file or a material, its parameters as NAME=VALUE, and what to write")
      ->required()
      ->type_name("IN [NAME=VALUE...] OUT");
  add_target(*sub, *target);
  sub->add_flag("--json", options->json, "as JSON");
  sub->callback([=, &action] {
    if (words->size() < 2 || words->front().find('=') != std::string::npos ||
        words->back().find('=') != std::string::npos)
      throw CLI::ValidationError("give a file or a material first and what to write last");
    options->source = words->front();
    options->target = words->back();
    options->settings = settings_of({words->begin() + 1, words->end() - 1});
    set_target(options->output, *target, options->target);
    action = [=] { return run_measure_convert(*options); };
  });
}

} // namespace

void add_measure(CLI::App& app, Action& action) {
  CLI::App* sub = app.add_subcommand("measure", "Files of measured reflectance");
  sub->require_subcommand(1);
  add_measure_info(*sub, action);
  add_measure_convert(*sub, action);
}

} // namespace faceta::cli
