#include "cli/arguments.h"

#include "cli/commands.h"
#include "cli/fit_command.h"
#include "cli/measure_command.h"
#include "cli/plot_command.h"
#include "cli/render_command.h"
#include "formats/measured_reader.h"
#include "verify/suite.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <memory>

namespace faceta::cli {

namespace {

/// Splits at the separator; a piece may be empty.
std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (char c : text)
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

/// "640x480", "0,0,64,64": exactly n whole numbers, the last two positive.
template <size_t n>
std::array<int, n> whole_numbers(const std::string& text, char separator, const char* form) {
  std::vector<std::string> parts = split(text, separator);
  std::array<int, n> values{};
  bool good = parts.size() == n;
  for (size_t i = 0; good && i < n; ++i)
    good = CLI::detail::lexical_cast(parts[i], values[i]) && values[i] >= (i + 2 >= n ? 1 : 0);
  if (!good)
    throw CLI::ValidationError("'" + text + "' is not of the form " + form);
  return values;
}

/// Bounds alone let NaN through.
std::string check_finite(const std::string& text) {
  double value = 0;
  if (CLI::detail::lexical_cast(text, value) && std::isfinite(value))
    return {};
  return "'" + text + "' is no finite number";
}

} // namespace

Settings settings_of(const std::vector<std::string>& words) {
  Settings settings;
  for (const std::string& word : words) {
    size_t sign = word.find('=');
    if (sign == std::string::npos || sign == 0)
      throw CLI::ValidationError("'" + word + "' is not of the form name=value");
    settings.emplace_back(word.substr(0, sign), word.substr(sign + 1));
  }
  return settings;
}

namespace {

CLI::Option* add_isa(CLI::App& app, std::optional<Isa>& isa) {
  return app
      .add_option_function<std::string>(
          "--isa", [&isa](const std::string& name) { isa = parse_isa(name); },
          "instruction set: scalar, v3 or v4 (default: the best of this CPU; same results)")
      ->check(CLI::IsMember({"scalar", "v3", "v4"}))
      ->type_name("SET");
}

CLI::Option* add_defines(CLI::App& app, Settings& defines) {
  return app
      .add_option_function<std::vector<std::string>>(
          "-D", [&defines](const std::vector<std::string>& words) { defines = settings_of(words); },
          "value of $NAME in the scene file; may come several times")
      ->allow_extra_args(false)
      ->type_name("NAME=VALUE");
}

void add_materials(CLI::App& app, Action& action) {
  auto options = std::make_shared<MaterialsOptions>();
  CLI::App* sub = app.add_subcommand("materials", "List the materials, or describe one");
  sub->add_option("name", options->name, "the material to describe")->type_name("MATERIAL");
  auto* markdown = sub->add_flag("--markdown", options->markdown, "as Markdown");
  sub->add_flag("--json", options->json, "as JSON")->excludes(markdown);
  sub->callback([=, &action] { action = [=] { return run_materials(*options); }; });
}

void add_table(CLI::App& app, Action& action, bool sample) {
  auto options = std::make_shared<TableOptions>();
  auto settings = std::make_shared<std::vector<std::string>>();
  options->sample = sample;
  CLI::App* sub =
      sample ? app.add_subcommand("sample", "Sample directions of a material, from CSV to CSV")
             : app.add_subcommand("eval", "Evaluate a material for directions, from CSV to CSV");
  sub->footer(
      sample
          ? "In:  wo_x,wo_y,wo_z,u1,u2,uc and optionally u,v (0.5), by the header, in any order.\n"
            "Out: the same and wi_x,wi_y,wi_z,weight_r,weight_g,weight_b,pdf,lobe,delta.\n"
            "lobe is reflection, transmission or null; a failed sample has the lobe none and\n"
            "zeros. The pdf of a delta is its discrete probability."
          : "In:  wo_x,wo_y,wo_z,wi_x,wi_y,wi_z and optionally u,v (0.5), by the header, in any\n"
            "     order; local frame, unit length, wo towards the viewer, wi towards the light.\n"
            "Out: the same and value_r,value_g,value_b,pdf; values include |cos theta_i|.");
  sub->add_option("material", options->material,
                  "a name that `faceta materials` lists, or a measured file")
      ->type_name("MATERIAL");
  sub->add_option("settings", *settings, "its parameters: alpha=0.2 material=Au reflectance=1,0,0")
      ->type_name("NAME=VALUE");
  auto* scene = sub->add_option("--scene", options->scene, "take the material from a scene file")
                    ->type_name("FILE");
  auto* id = sub->add_option("--id", options->id, "id of the material in the scene file")
                 ->needs(scene)
                 ->type_name("ID");
  scene->needs(id);
  add_defines(*sub, options->defines)->needs(scene);
  sub->add_option("-i,--input", options->input, "table of directions; - is standard input")
      ->capture_default_str()
      ->type_name("FILE");
  sub->add_option("-o,--output", options->output, "table of results; - is standard output")
      ->capture_default_str()
      ->type_name("FILE");
  sub->add_option_function<std::string>(
         "--mode",
         [options](const std::string& mode) {
           options->mode =
               mode == "importance" ? TransportMode::importance : TransportMode::radiance;
         },
         "what travels: radiance (default) or importance")
      ->check(CLI::IsMember({"radiance", "importance"}))
      ->type_name("MODE");
  add_isa(*sub, options->isa);
  sub->callback([=, &action] {
    if (options->material.empty() == options->scene.empty())
      throw CLI::ValidationError("give either a material or --scene and --id");
    options->settings = settings_of(*settings);
    action = [=] { return run_table(*options); };
  });
}

void add_diff(CLI::App& app, Action& action) {
  auto options = std::make_shared<DiffOptions>();
  CLI::App* sub = app.add_subcommand("diff", "Compare an image with a reference");
  sub->footer("Exit code 1 if a test fails; without variances there is none.");
  sub->add_option("image", options->image, "the image")->required()->type_name("IMAGE");
  sub->add_option("reference", options->reference, "what it should be")
      ->required()
      ->type_name("REFERENCE");
  auto* variance = sub->add_option("--variance", options->variance,
                                   "variance of one sample (Mitsuba's tests): do the z-test")
                       ->type_name("FILE");
  sub->add_option("--spp", options->spp, "samples per pixel of the image (default: its metadata)")
      ->check(check_finite)
      ->check(CLI::PositiveNumber)
      ->needs(variance)
      ->type_name("N");
  sub->add_option("--reference-spp", options->reference_spp,
                  "those of the reference, for the z of the mean (default: it is exact)")
      ->check(check_finite)
      ->check(CLI::PositiveNumber)
      ->needs(variance)
      ->type_name("N");
  auto* image_variance =
      sub->add_option("--image-variance", options->image_variance,
                      "variance of the image's values: do the two-sample test, by blocks of 8 x 8")
          ->type_name("FILE");
  auto* reference_variance =
      sub->add_option("--reference-variance", options->reference_variance, "and the reference's")
          ->needs(image_variance)
          ->type_name("FILE");
  image_variance->needs(reference_variance);
  sub->add_option(
         "--quantisation", options->quantisation,
         "relative rounding error of the values, beside the variances (default: of halves)")
      ->check(check_finite)
      ->check(CLI::NonNegativeNumber)
      ->needs(image_variance)
      ->type_name("X");
  sub->add_flag("--json", options->json, "as JSON");
  sub->callback([=, &action] { action = [=] { return run_diff(*options); }; });
}

void add_info(CLI::App& app, Action& action) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* sub =
      app.add_subcommand("info", "What is in an image or a scene file, or what this CPU can run");
  sub->footer(
      "Of an image: size, channels, metadata. Of a scene (.xml): shapes, emitters, materials "
      "and textures by type, triangles, integrator, and each sensor's film and samples.");
  sub->add_option("files", options->files, "images and scenes")->type_name("FILE");
  add_defines(*sub, options->defines);
  sub->add_flag("--cpu", options->cpu, "the CPU, its instruction sets, the modules found");
  sub->add_flag("--json", options->json, "as JSON");
  sub->callback([=, &action] {
    if (options->files.empty() && !options->cpu)
      throw CLI::ValidationError("give a file or --cpu");
    action = [=] { return run_info(*options); };
  });
}

void add_sampling_options(CLI::App& sub, RenderOptions& options) {
  sub.add_option("--spp", options.spp, "samples per pixel")
      ->check(CLI::Range(1, 1 << 30))
      ->type_name("N");
  sub.add_option("--seed", options.seed, "number that all random numbers come from")
      ->type_name("N");
  sub.add_option("--sampler", options.sampler, "independent or sobol")
      ->check(CLI::IsMember({"independent", "sobol"}))
      ->type_name("NAME");
  sub.add_option("--threads", options.threads, "how many (default: all; same picture)")
      ->check(CLI::Range(1, 4096))
      ->type_name("N");
  add_isa(sub, options.isa);
}

void add_picture_options(CLI::App& sub, RenderOptions& options) {
  sub.add_option("-o,--output", options.outputs,
                 "picture: .exr, .png, .pfm or .hdr; may come several times")
      ->allow_extra_args(false)
      ->type_name("FILE");
  sub.add_option_function<std::string>(
         "--size",
         [&options](const std::string& text) { options.size = whole_numbers<2>(text, 'x', "WxH"); },
         "width and height in pixels")
      ->type_name("WxH");
  sub.add_option("--exposure", options.exposure, "stops, for PNG")
      ->check(check_finite)
      ->check(CLI::Range(-100.0, 100.0))
      ->type_name("STOPS");
  sub.add_flag("--float", options.full_floats, "EXR with 32 bits a value, not 16");
  auto* quiet =
      sub.add_flag_callback("-q,--quiet", [&options] { options.verbosity = -1; }, "only errors");
  sub.add_flag_callback(
         "-v,--verbose", [&options] { options.verbosity = 1; }, "tell more")
      ->excludes(quiet);
}

void add_render(CLI::App& app, Action& action) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App* sub = app.add_subcommand("render", "Render a Mitsuba 3 scene file");
  sub->footer(
      "Without -o the picture is NAME.exr (or the film's format) beside the scene NAME.xml.");
  sub->add_option("scene", options->scene, "the scene file")->required()->type_name("SCENE");
  add_picture_options(*sub, *options);
  sub->add_option_function<std::string>(
         "--crop",
         [options](const std::string& text) {
           options->crop = whole_numbers<4>(text, ',', "X,Y,W,H");
         },
         "only this part of the picture")
      ->type_name("X,Y,W,H");
  add_sampling_options(*sub, *options);
  sub->add_option("-s,--sensor", options->sensor, "which sensor, from 0")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str()
      ->type_name("SENSOR");
  add_defines(*sub, options->defines);
  sub->add_flag("--permissive", options->permissive,
                "warn of properties that nothing knows instead of ending in an error");
  sub->add_option("--variance", options->variance,
                  "also write the variance of each pixel's mean (EXR, 32 bits)")
      ->type_name("FILE");
  sub->add_option("--tile", options->tile, "pixels a side of the tiles threads work on")
      ->check(CLI::Range(1, 32))
      ->group("");
  sub->callback([=, &action] { action = [=] { return run_render(*options); }; });
}

void add_gallery(CLI::App& app, Action& action) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App* sub = app.add_subcommand("gallery", "Render the contact sheet of all materials");
  sub->footer("Without -o the picture is gallery.png.");
  sub->add_option("--measured", options->measured,
                  "show these files of measured reflectance instead of all materials")
      ->type_name("FILE");
  add_picture_options(*sub, *options);
  add_sampling_options(*sub, *options);
  sub->callback([=, &action] {
    if (options->outputs.empty())
      options->outputs = {"gallery.png"};
    action = [=] { return run_gallery(*options); };
  });
}

/// "diffuse", "phong exponent=20", "scene.xml", one after the other.
std::vector<VerifyTarget> targets_of(const std::vector<std::string>& words) {
  std::vector<VerifyTarget> targets;
  for (const std::string& word : words) {
    bool scene =
        std::filesystem::path(word).extension() == ".xml" && format_of_measured(word).empty();
    if (scene || word.find('=') == std::string::npos) {
      targets.push_back({word, scene, {}});
      continue;
    }
    if (targets.empty() || targets.back().scene)
      throw CLI::ValidationError("'" + word + "' stands behind no material");
    Settings setting = settings_of({word});
    targets.back().settings.push_back(setting[0]);
  }
  return targets;
}

void add_verify(CLI::App& app, Action& action) {
  auto options = std::make_shared<VerifyOptions>();
  auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* sub = app.add_subcommand("verify", "Prove materials right: properties and statistics");
  sub->footer("Without a target: every model with each of its parameter sets, and the models' own\n"
              "descriptions. A name alone: that model so. A name with settings: only those\n"
              "parameters. A scene: each model in it as it is used there.\n"
              "Exit code 1 if a property fails. What a model is known to break is excused, with\n"
              "the reason.");
  sub->add_option("targets", *words,
                  "materials and measured files, each perhaps with NAME=VALUE, and scenes (.xml)")
      ->type_name("TARGET");
  add_defines(*sub, options->defines);
  sub->add_option_function<std::string>(
         "--effort", [options](const std::string& effort) { options->full = effort == "full"; },
         "fast (default) or full: more directions and samples")
      ->check(CLI::IsMember({"fast", "full"}))
      ->type_name("EFFORT");
  sub->add_option("--seed", options->seed, "number that all random numbers come from")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str()
      ->type_name("N");
  sub->add_option("--only", options->only, "only these properties, by the names of --list")
      ->delimiter(',')
      ->check(CLI::IsMember(property_names()))
      ->type_name("PROPERTY");
  sub->add_option("--json", options->json,
                  "write the results to a file; - prints them instead of the table")
      ->type_name("FILE");
  sub->add_option("--html", options->html,
                  "write a report with plots, one page that loads nothing; - prints it instead")
      ->type_name("FILE");
  sub->add_flag("--list", options->list, "list the properties");
  sub->add_flag("-q,--quiet", options->quiet, "no progress");
  sub->callback([=, &action] {
    options->targets = targets_of(*words);
    bool scene = false;
    for (const VerifyTarget& target : options->targets)
      scene = scene || target.scene;
    if (!scene && !options->defines.empty())
      throw CLI::ValidationError("-D needs a scene file");
    if (!options->json.empty() && options->json == options->html)
      throw CLI::ValidationError("--json and --html cannot both write to " + options->json);
    action = [=] { return run_verify(*options); };
  });
}

void add_efficiency(CLI::App& app, Action& action) {
  auto options = std::make_shared<EfficiencyOptions>();
  auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* sub = app.add_subcommand("efficiency", "How evenly the samples of materials weigh");
  sub->footer("Without a target: every model with each of its parameter sets. A name alone: that\n"
              "model so. A name with settings: only those parameters.");
  sub->add_option("targets", *words, "materials, each perhaps with NAME=VALUE")
      ->type_name("TARGET");
  sub->add_option("--samples", options->samples, "for each viewer")
      ->check(CLI::Range(2, 1 << 26))
      ->capture_default_str()
      ->type_name("N");
  sub->add_option("--seed", options->seed, "number that all random numbers come from")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str()
      ->type_name("N");
  sub->add_option("--json", options->json,
                  "write the results to a file; - prints them instead of the table")
      ->type_name("FILE");
  sub->callback([=, &action] {
    options->targets = targets_of(*words);
    action = [=] { return run_efficiency(*options); };
  });
}

void add_docs(CLI::App& app, Action& action) {
  auto options = std::make_shared<DocsOptions>();
  CLI::App* sub =
      app.add_subcommand("docs", "Write the documentation: a page a material, and the report card");
  sub->footer("Renders pictures and verifies every material: minutes. The same materials give the\n"
              "same pages. --check takes seconds; exit code 1 if a page is missing or stale.");
  sub->add_option("folder", options->folder, "what to write to")->required()->type_name("FOLDER");
  sub->add_flag("--check", options->check,
                "write nothing; compare all but pictures, plots and verdicts");
  sub->add_flag("-q,--quiet", options->quiet, "no progress");
  sub->callback([=, &action] { action = [=] { return run_docs(*options); }; });
}

} // namespace

Action parse_arguments(int argc, char** argv) {
  Action action;
  CLI::App app(
      "Faceta: surface scattering models, a path tracer that renders Mitsuba 3 scenes with "
      "them, and the tests that hold both to mathematics.",
      "faceta");
  app.set_version_flag("--version", "faceta " FACETA_VERSION);
  app.footer("Exit codes: 0 good, 1 a check says no, 2 wrong arguments, 3 bad input or I/O.\n"
             "faceta COMMAND --help tells more.");
  app.require_subcommand(1);
  add_render(app, action);
  add_gallery(app, action);
  add_materials(app, action);
  add_table(app, action, false);
  add_table(app, action, true);
  add_plot(app, action);
  add_diff(app, action);
  add_info(app, action);
  add_measure(app, action);
  add_verify(app, action);
  add_efficiency(app, action);
  add_fit(app, action);
  add_docs(app, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    int code = app.exit(error) == 0 ? kOk : kUsage;
    return [code] { return code; };
  }
  return action;
}

} // namespace faceta::cli
