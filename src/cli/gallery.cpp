#include "cli/gallery.h"

#include "formats/material_xml.h"
#include "formats/measured_loader.h"
#include "render/render.h"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

namespace faceta::cli {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

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

Gallery read_gallery_json(const json& document, const fs::path& folder) {
  Gallery gallery;
  gallery.title = document.at("title");
  gallery.subtitle = document.at("subtitle");
  gallery.material_id = document.at("material_id");
  for (const auto& [name, view] : document.at("scenes").items())
    gallery.scenes[name] = {folder / view.at("file").get<std::string>(),
                            view.value("exposure", 0.0)};
  const json& defaults = document.at("render");
  gallery.cell_width = defaults.at("cell_width");
  gallery.cell_height = defaults.at("cell_height");
  gallery.spp = defaults.at("spp");
  gallery.style = read_style(document.at("sheet"));
  for (const json& row : document.at("rows")) {
    GalleryRow r{row.at("heading"), row.value("note", ""), {}};
    for (const json& cell : row.at("cells"))
      r.cells.push_back({cell.at("title"), cell.at("label"), cell.at("bsdf"),
                         cell.value("scene", row.at("scene")), row.value("spp", gallery.spp)});
    gallery.rows.push_back(std::move(r));
  }
  return gallery;
}

/// Gives the material of that id the contents of another one.
void dress(xml::Node& root, const std::string& id, const xml::Node& material) {
  for (const xml::NodePtr& node : root.objects("bsdf"))
    if (node->id == id) {
      *node = material;
      node->id = id;
      return;
    }
  throw Error("no material '" + id + "' to replace", {root.where.file});
}

} // namespace

Gallery read_gallery() {
  fs::path folder = scenes_folder(), path = folder / "gallery.json";
  std::ifstream file(path);
  if (!file)
    throw Error("cannot open", {path.string()});
  try {
    return read_gallery_json(json::parse(file), folder);
  } catch (const json::exception& e) {
    throw Error(e.what(), {path.string()});
  }
}

void show_measured(Gallery& gallery, const std::vector<std::string>& files) {
  constexpr size_t kColumns = 7;
  const std::string scene = gallery.rows.at(0).cells.at(0).scene;
  gallery.title = "Measured";
  gallery.rows.clear();
  for (size_t k = 0; k < files.size(); ++k) {
    if (k % kColumns == 0)
      gallery.rows.push_back({"", "", {}});
    MeasuredInfo info = read_measured_or_demo(files[k], {}).info;
    std::string material = write_material(make_parameters("measured", {{"filename", files[k]}}));
    material =
        "<bsdf" + material.substr(material.find(" type=")); // without declaration and version
    gallery.rows.back().cells.push_back(
        {fs::path(files[k]).stem().string(), info.format, material, scene, gallery.spp});
  }
}

xml::NodePtr cell_material(const GalleryCell& cell) {
  xml::NodePtr scene = xml::parse_scene_string("<scene version=\"3.0.0\">" + cell.bsdf + "</scene>",
                                               "gallery.json", {});
  std::vector<xml::NodePtr> materials = scene->objects("bsdf");
  if (materials.empty())
    throw Error("the cell '" + cell.title + "' holds no bsdf", {"gallery.json"});
  return materials[0];
}

Image render_cell(const Gallery& gallery, const GalleryCell& cell, const xml::Node& material,
                  const RenderOptions& options) {
  auto view = gallery.scenes.find(cell.scene);
  if (view == gallery.scenes.end())
    throw Error("there is no scene '" + cell.scene + "'", {"gallery.json"});
  xml::NodePtr root = xml::parse_scene_file(view->second.file.string(), {});
  dress(*root, gallery.material_id, material);
  std::unique_ptr<Scene> scene = build_mitsuba_scene(*root, ReadOptions{});
  SensorDesc sensor = scene->sensors.at(0);
  sensor.film.width = options.size ? (*options.size)[0] : gallery.cell_width;
  sensor.film.height = options.size ? (*options.size)[1] : gallery.cell_height;
  sensor.film.crop_x = sensor.film.crop_y = 0;
  sensor.film.crop_width = sensor.film.width;
  sensor.film.crop_height = sensor.film.height;
  sensor.sampler.type = options.sampler.empty() ? "sobol" : options.sampler;
  sensor.sampler.seed = options.seed.value_or(0);
  faceta::RenderOptions job;
  job.isa = options.isa.value_or(best_isa());
  job.spp = options.spp.value_or(cell.spp);
  job.threads = options.threads;
  job.settings = render_settings(scene->integrator, sensor.sampler);
  scene->build(job.isa);
  scene->use_sensor(sensor.camera, sensor.film);
  Image picture = render(*scene, job).film.image().select({"R", "G", "B"});
  float factor = std::exp2(float(view->second.exposure + options.exposure));
  for (float& v : picture.data)
    v *= factor;
  return picture;
}

} // namespace faceta::cli
