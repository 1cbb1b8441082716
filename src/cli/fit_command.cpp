#include "cli/fit_command.h"

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/gallery.h"
#include "formats/material_xml.h"
#include "formats/measured_loader.h"
#include "formats/output_file.h"
#include "formats/reflector.h"
#include "image/io.h"
#include "verify/fit_picture.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <memory>

namespace faceta::cli {

namespace {

/// The reflectance of a file, or of a material.
FitTarget fit_target(const FitCommandOptions& options) {
  auto source = std::make_shared<Reflector>(find_reflector(options.file, options.settings));
  FitTarget target;
  target.value = [source](const Vec3<double>& wo, const Vec3<double>& wi) {
    Color<double> c = source->value(wo, wi) * (1 / wi.z);
    return std::array<double, 3>{c[0], c[1], c[2]};
  };
  return target;
}

/// The gallery's object with the source beside the same with the fit.
void write_picture(const FitCommandOptions& options, const FitResult& result) {
  Gallery gallery = read_gallery();
  const std::string scene = gallery.rows.at(0).cells.at(0).scene;
  NamedModel source = model_or_file(options.file, options.settings);
  SheetRow row{std::filesystem::path(options.file).filename().string(), "", {}};
  auto add = [&](const std::string& title, const std::string& label, const xml::NodePtr& bsdf) {
    GalleryCell cell{title, label, "", scene, 2 * gallery.spp};
    row.cells.push_back({title, label, render_cell(gallery, cell, *bsdf, RenderOptions{})});
  };
  add("Source", source.model->name(), parameters_to_xml(parameters_of(source)));
  add("Fit", fmt::format("{}, {} lobes, {} numbers", result.model, result.lobes, result.parameters),
      material_to_xml(*fit_node(result)));
  write_image(options.picture,
              compose_sheet("Fit", "The same object under the same light.", {row}, gallery.style));
}

bool has_ending(const std::string& path, const char* ending) {
  return std::filesystem::path(path).extension() == ending;
}

void write_text(const std::string& path, const std::string& text) {
  OutputFile file(path);
  file.write(text);
  file.commit();
}

void write_maps(const std::filesystem::path& folder, const FitMap& map) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure)
    throw Error("cannot make the folder: " + failure.message(), {folder.string()});
  double range = 0;
  for (double v : map.rms)
    range = std::max(range, std::isfinite(v) ? v : 0);
  range = std::max(range, 1e-6);
  write_image(folder / "mean.png", draw_fit_map(map.mean, range));
  write_image(folder / "rms.png", draw_fit_map(map.rms, range));
  std::string table = "theta_h,theta_d,mean,rms\n";
  for (int i = 0; i < FitMap::kSize; ++i)
    for (int j = 0; j < FitMap::kSize; ++j) {
      size_t k = size_t(i) * FitMap::kSize + size_t(j);
      double h = (2 * i + 0.5) / 90;
      if (std::isfinite(map.rms[k]))
        table += fmt::format("{:.6g},{},{:.6g},{:.6g}\n", h * h * 90, 2 * j + 1, map.mean[k],
                             map.rms[k]);
    }
  write_text((folder / "residuals.csv").string(), table);
}

} // namespace

int run_fit(const FitCommandOptions& options) {
  for (const std::string& path : options.outputs)
    if (!has_ending(path, ".xml") && !has_ending(path, ".json"))
      throw Error("no writer for this ending", {path}, "known: .xml, .json");
  if (!options.picture.empty() && !can_write_image(options.picture))
    throw Error("no writer for this ending", {options.picture}, "known: .exr, .png, .pfm, .hdr");
  FitData data = sample_fit_target(fit_target(options), options.max_theta);
  FitResult result = fit_material(data, options.fit);
  if (!options.quiet)
    std::fputs(fit_text(result).c_str(), stdout);
  for (const std::string& path : options.outputs)
    write_text(path,
               has_ending(path, ".json") ? fit_json(result) : write_material(*fit_node(result)));
  if (!options.maps.empty())
    write_maps(options.maps, fit_map(data, result.fitted));
  if (!options.picture.empty())
    write_picture(options, result);
  return kOk;
}

void add_fit(CLI::App& app, Action& action) {
  auto options = std::make_shared<FitCommandOptions>();
  CLI::App* sub = app.add_subcommand("fit", "Fit a material to measured reflectance");
  sub->footer("Prints the errors in three metrics (over all directions, by channel, by angle of\n"
              "incidence) and the parameters. With c the light's cosine and W solid angles:\n"
              "log  sqrt(sum W (ln(1 + f c) - ln(1 + g c))^2), cbrt the same of cube roots with\n"
              "weight W cos_o, rel the same of f c, over the size of f c. In JSON the material\n"
              "comes with these figures and with what else was tried.");
  auto settings = std::make_shared<std::vector<std::string>>();
  sub->add_option("file", options->file, "a file of measured reflectance, or a material")
      ->required()
      ->type_name("FILE");
  sub->add_option("settings", *settings, "of `measured` or of the material")
      ->type_name("NAME=VALUE");
  std::vector<std::string> models = fit_model_names();
  models.insert(models.begin(), "auto");
  sub->add_option(
         "--model", options->fit.model,
         "what to fit; auto: the best of roughconductor, ggx and hazygloss; ggx: lobes of\n"
         "GGX with free reflectances at both ends of Schlick's curve")
      ->check(CLI::IsMember(models))
      ->capture_default_str()
      ->type_name("MODEL");
  sub->add_option("--lobes", options->fit.lobes,
                  "how many, beside the diffuse base (default: one or two, by BIC)")
      ->check(CLI::Range(1, 3))
      ->type_name("N");
  sub->add_option_function<std::string>(
         "--metric",
         [options](const std::string& name) { options->fit.metric = parse_fit_metric(name); },
         "what to minimise: log (default), cbrt or rel")
      ->check(CLI::IsMember({"log", "cbrt", "rel"}))
      ->type_name("METRIC");
  sub->add_option("--max-theta", options->max_theta,
                  "largest angle of both directions from the normal, in degrees")
      ->check(CLI::Range(1.0, 90.0))
      ->capture_default_str()
      ->type_name("DEGREES");
  sub->add_option("--threads", options->fit.threads, "how many (default: all)")
      ->check(CLI::Range(1, 4096))
      ->type_name("N");
  sub->add_option("-o,--output", options->outputs,
                  "the fitted material: .xml or .json; may come several times")
      ->allow_extra_args(false)
      ->type_name("FILE");
  sub->add_option("--maps", options->maps,
                  "write the residuals over theta_h and theta_d there: mean.png, rms.png and "
                  "residuals.csv")
      ->type_name("FOLDER");
  sub->add_option("--picture", options->picture, "render the source and the fit side by side")
      ->type_name("FILE");
  sub->add_flag("-q,--quiet", options->quiet, "print nothing");
  sub->callback([=, &action] {
    options->settings = settings_of(*settings);
    action = [=] { return run_fit(*options); };
  });
}

} // namespace faceta::cli
