#include "cli/scene_info.h"

#include "formats/mitsuba_scene.h"

#include <fmt/core.h>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace faceta::cli {

namespace {

using Json = nlohmann::ordered_json;

/// Tag -> plugin -> how many; a node that several places refer to counts once.
using Census = std::map<std::string, std::map<std::string, int>>;

void count(const xml::Node& node, Census& census, std::set<const xml::Node*>& seen) {
  if (!seen.insert(&node).second)
    return;
  ++census[node.tag][node.type];
  for (const xml::Property& property : node.properties)
    if (xml::NodePtr child = property.object())
      count(*child, census, seen);
}

const char* filter_name(FilterType type) {
  return type == FilterType::box ? "box" : type == FilterType::tent ? "tent" : "gaussian";
}

Json sensor_json(const SensorDesc& sensor) {
  const FilmDesc& film = sensor.film;
  Json json = {{"id", sensor.id},
               {"width", film.width},
               {"height", film.height},
               {"x_fov", sensor.camera.x_fov},
               {"filter", filter_name(film.filter.type)},
               {"sampler", sensor.sampler.type},
               {"spp", sensor.sampler.sample_count},
               {"seed", sensor.sampler.seed}};
  if (film.crop_width > 0 && (film.crop_width != film.width || film.crop_height != film.height))
    json["crop"] = {film.crop_x, film.crop_y, film.crop_width, film.crop_height};
  return json;
}

Json integrator_json(const IntegratorDesc& integrator) {
  Json json = {{"type", integrator.type}};
  if (integrator.type == "direct") {
    json["emitter_samples"] = integrator.emitter_samples;
    json["bsdf_samples"] = integrator.bsdf_samples;
  } else {
    json["max_depth"] = integrator.max_depth;
    json["rr_depth"] = integrator.rr_depth;
  }
  json["hide_emitters"] = integrator.hide_emitters;
  json["moments"] = integrator.moments;
  return json;
}

std::string list(const Json& counts) {
  std::string text;
  for (const auto& [name, number] : counts.items())
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", number.get<int>(), name);
  return text.empty() ? "none" : text;
}

std::string sensor_text(const Json& s, size_t number) {
  std::string id = s["id"].get<std::string>();
  std::string text = fmt::format("  sensor {}    {}{} x {}", number, id.empty() ? "" : id + ": ",
                                 s["width"].get<int>(), s["height"].get<int>());
  if (s.contains("crop"))
    text += fmt::format(" (crop {} x {} at {}, {})", s["crop"][2].get<int>(),
                        s["crop"][3].get<int>(), s["crop"][0].get<int>(), s["crop"][1].get<int>());
  return text + fmt::format(", {:g} degrees wide, {} filter, {} sampler, {} spp, seed {}\n",
                            s["x_fov"].get<double>(), s["filter"].get<std::string>(),
                            s["sampler"].get<std::string>(), s["spp"].get<int>(),
                            s["seed"].get<uint32_t>());
}

Json scene_json(const std::string& file, const Settings& defines) {
  xml::ParseOptions parse;
  parse.defines = defines;
  xml::NodePtr root = xml::parse_scene_file(file, parse);
  Census census;
  std::set<const xml::Node*> seen;
  count(*root, census, seen);
  std::unique_ptr<Scene> scene = build_mitsuba_scene(*root);
  scene->build(best_isa());
  SceneStatistics statistics = scene->statistics();
  Json json = {{"file", file},
               {"shapes", Json(census["shape"])},
               {"triangles", statistics.triangles},
               {"emitters", Json(census["emitter"])},
               {"lights", statistics.lights},
               {"materials", Json(census["bsdf"])},
               {"textures", Json(census["texture"])},
               {"bytes", statistics.bytes},
               {"integrator", integrator_json(scene->integrator)},
               {"sensors", Json::array()}};
  for (const SensorDesc& sensor : scene->sensors)
    json["sensors"].push_back(sensor_json(sensor));
  return json;
}

std::string scene_text(const Json& j) {
  std::string text = fmt::format("{}: scene, {:.1f} MiB\n", j["file"].get<std::string>(),
                                 j["bytes"].get<double>() / (1 << 20));
  text += fmt::format("  shapes      {}; {} triangles\n", list(j["shapes"]),
                      j["triangles"].get<size_t>());
  text += fmt::format("  emitters    {}; {} lights to choose from\n", list(j["emitters"]),
                      j["lights"].get<size_t>());
  text += fmt::format("  materials   {}\n", list(j["materials"]));
  text += fmt::format("  textures    {}\n", list(j["textures"]));
  std::string parameters;
  for (const auto& [name, value] : j["integrator"].items())
    if (name != "type")
      parameters += fmt::format(", {} {}", name, value.dump());
  text +=
      fmt::format("  integrator  {}{}\n", j["integrator"]["type"].get<std::string>(), parameters);
  for (size_t i = 0; i < j["sensors"].size(); ++i)
    text += sensor_text(j["sensors"][i], i);
  return text;
}

} // namespace

SceneInfo scene_info(const std::string& file, const Settings& defines) {
  Json json = scene_json(file, defines);
  return {json.dump(2, ' ', false, Json::error_handler_t::replace), scene_text(json)};
}

} // namespace faceta::cli
