#include "cli/commands.h"
#include "cli/progress.h"
#include "cli/render_command.h"
#include "formats/mitsuba_scene.h"
#include "image/contact_sheet.h"
#include "image/io.h"
#include "render/render.h"

#include <dlfcn.h>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace faceta::cli {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The folder of our own scenes: $FACETA_SCENES, share/faceta/scenes beside an installed library,
/// or the source tree of a build.
fs::path scenes_folder() {
  if (const char* path = std::getenv("FACETA_SCENES"))
    return path;
  fs::path modules = module_directory();
  for (const char* relative : {"../../share/faceta/scenes", "../../../../scenes"}) {
    fs::path folder = modules / relative;
    if (fs::exists(folder / "gallery.json"))
      return fs::weakly_canonical(folder);
  }
  throw Error("the gallery's scenes were not found", {},
              "set FACETA_SCENES to the folder that holds gallery.json");
}

json read_json(const fs::path& path) {
  std::ifstream file(path);
  if (!file)
    throw Error("cannot open", {path.string()});
  try {
    return json::parse(file);
  } catch (const json::exception& e) {
    throw Error(e.what(), {path.string()});
  }
}

SheetStyle read_style(const json& sheet) {
  SheetStyle s;
  s.margin = sheet.at("margin");
  s.column_gap = sheet.at("column_gap");
  s.row_gap = sheet.at("row_gap");
  s.title_height = sheet.at("title_height");
  s.heading_height = sheet.at("heading_height");
  s.label_height = sheet.at("label_height");
  s.background = parse_hex_colour(sheet.at("background"));
  s.border = parse_hex_colour(sheet.at("cell_border"));
  const json& c = sheet.at("colours");
  s.title = parse_hex_colour(c.at("title"));
  s.subtitle = parse_hex_colour(c.at("subtitle"));
  s.heading = parse_hex_colour(c.at("heading"));
  s.note = parse_hex_colour(c.at("note"));
  s.cell_title = parse_hex_colour(c.at("cell_title"));
  s.cell_label = parse_hex_colour(c.at("cell_label"));
  const json& f = sheet.at("font_sizes");
  s.title_size = f.at("title");
  s.subtitle_size = f.at("subtitle");
  s.heading_size = f.at("heading");
  s.note_size = f.at("note");
  s.cell_title_size = f.at("cell_title");
  s.cell_label_size = f.at("cell_label");
  return s;
}

/// Renders the cells of a gallery file.
class Gallery {
public:
  Gallery(const RenderOptions& options, fs::path folder)
      : options_(options), folder_(std::move(folder)),
        document_(read_json(folder_ / "gallery.json")) {}

  Image sheet() {
    std::vector<SheetRow> rows;
    size_t total = 0, done = 0;
    for (const json& row : document_.at("rows"))
      total += row.at("cells").size();
    for (const json& row : document_.at("rows")) {
      SheetRow r{row.at("heading"), row.value("note", ""), {}};
      for (const json& cell : row.at("cells")) {
        r.cells.push_back({cell.at("title"), cell.at("label"), render_cell(row, cell)});
        if (options_.verbosity >= 0)
          std::fprintf(stderr, "%2zu/%zu  %s, %s\n", ++done, total, r.cells.back().title.c_str(),
                       r.cells.back().label.c_str());
      }
      rows.push_back(std::move(r));
    }
    SheetStyle style = read_style(document_.at("sheet"));
    return compose_sheet(document_.at("title"), document_.at("subtitle"), rows, style);
  }

private:
  Image render_cell(const json& row, const json& cell) {
    std::string scene_name = cell.value("scene", row.at("scene"));
    const json& variant = document_.at("scenes").at(scene_name);
    const json& defaults = document_.at("render");
    fs::path file = folder_ / variant.at("file").get<std::string>();
    xml::ParseOptions parse;
    xml::NodePtr root = xml::parse_scene_file(file.string(), parse);
    dress(*root, document_.at("material_id"), cell.at("bsdf"));
    std::unique_ptr<Scene> scene = build_mitsuba_scene(*root, ReadOptions{});
    SensorDesc sensor = scene->sensors.at(0);
    sensor.film.width = options_.size ? (*options_.size)[0] : int(defaults.at("cell_width"));
    sensor.film.height = options_.size ? (*options_.size)[1] : int(defaults.at("cell_height"));
    sensor.film.crop_x = sensor.film.crop_y = 0;
    sensor.film.crop_width = sensor.film.width;
    sensor.film.crop_height = sensor.film.height;
    sensor.sampler.type = options_.sampler.empty() ? "sobol" : options_.sampler;
    sensor.sampler.seed = options_.seed.value_or(0);
    faceta::RenderOptions job;
    job.isa = options_.isa.value_or(best_isa());
    job.spp = options_.spp.value_or(row.value("spp", int(defaults.at("spp"))));
    job.threads = options_.threads;
    job.settings = render_settings(scene->integrator, sensor.sampler);
    scene->build(job.isa);
    scene->use_sensor(sensor.camera, sensor.film);
    Image picture = render(*scene, job).film.image().select({"R", "G", "B"});
    float factor = std::exp2(float(variant.value("exposure", 0.0) + options_.exposure));
    for (float& v : picture.data)
      v *= factor;
    return picture;
  }

  /// Gives the material of that id the contents of another one.
  void dress(xml::Node& root, const std::string& id, const std::string& bsdf) {
    xml::NodePtr material = xml::parse_scene_string("<scene version=\"3.0.0\">" + bsdf + "</scene>",
                                                    "gallery.json", {});
    const std::vector<xml::NodePtr> replacement = material->objects("bsdf");
    for (const xml::NodePtr& node : root.objects("bsdf"))
      if (node->id == id && !replacement.empty()) {
        std::string keep = node->id;
        *node = *replacement[0];
        node->id = keep;
        return;
      }
    throw Error("no material '" + id + "' to replace", {root.where.file});
  }

  const RenderOptions& options_;
  fs::path folder_;
  json document_;
};

} // namespace

int run_gallery(const RenderOptions& options) {
  for (const std::string& output : options.outputs)
    if (!can_write_image(output))
      throw Error("no writer for this ending", {output}, "known: .exr, .png, .pfm, .hdr");
  fs::path folder = scenes_folder();
  try {
    Image sheet = Gallery(options, folder).sheet();
    for (const std::string& output : options.outputs) {
      if (fs::path(output).has_parent_path())
        fs::create_directories(fs::path(output).parent_path());
      write_image(output, sheet);
      std::printf("%s\n", fs::absolute(output).lexically_normal().c_str());
    }
  } catch (const json::exception& e) {
    throw Error(e.what(), {(folder / "gallery.json").string()});
  }
  return kOk;
}

} // namespace faceta::cli
