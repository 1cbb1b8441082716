#include "base/cpu.h"
#include "cli/commands.h"
#include "cli/scene_info.h"
#include "image/io.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <thread>

namespace faceta::cli {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

Json cpu_json() {
  Json sets = Json::array(), modules = Json::array();
  for (int i = 0; i < kIsaCount; ++i)
    if (isa_supported(static_cast<Isa>(i)))
      sets.push_back(kIsaNames[i]);
  std::string directory = module_directory();
  for (const fs::directory_entry& entry : fs::directory_iterator(directory))
    if (entry.path().extension() == ".so")
      modules.push_back(entry.path().filename().string());
  std::sort(modules.begin(), modules.end());
  return {{"cpu", cpu_brand()},         {"threads", std::thread::hardware_concurrency()},
          {"instruction_sets", sets},   {"best", kIsaNames[static_cast<int>(best_isa())]},
          {"module_folder", directory}, {"modules", modules}};
}

Json metadata_json(const MetadataValue& value) {
  if (const auto* v = std::get_if<V3f>(&value))
    return {v->x, v->y, v->z};
  if (const auto* m = std::get_if<M44f>(&value))
    return m->m;
  if (const auto* c = std::get_if<Chromaticities>(&value))
    return {{"red", c->red}, {"green", c->green}, {"blue", c->blue}, {"white", c->white}};
  if (const auto* i = std::get_if<int>(&value))
    return *i;
  if (const auto* d = std::get_if<double>(&value))
    return *d;
  return std::get<std::string>(value);
}

/// Range and mean of the finite values of a channel.
Json channel_json(const Image& image, int channel) {
  double low = INFINITY, high = -INFINITY, sum = 0;
  size_t finite = 0;
  for (size_t i = static_cast<size_t>(channel); i < image.data.size(); i += image.channels.size()) {
    double v = image.data[i];
    if (!std::isfinite(v))
      continue;
    low = std::min(low, v);
    high = std::max(high, v);
    sum += v;
    ++finite;
  }
  return {{"name", image.channels[static_cast<size_t>(channel)]},
          {"min", low},
          {"max", high},
          {"mean", sum / static_cast<double>(finite)},
          {"non_finite", image.pixel_count() - finite}};
}

const char* storage_text(const Bitmap& bitmap) {
  switch (bitmap.type) {
  case Bitmap::Type::u8:
    return bitmap.srgb_encoded ? "8-bit sRGB" : "8-bit linear";
  case Bitmap::Type::u16:
    return bitmap.srgb_encoded ? "16-bit sRGB" : "16-bit linear";
  case Bitmap::Type::f16:
    return "half";
  case Bitmap::Type::f32:
    return "float";
  }
  return "";
}

Json image_json(const std::string& file) {
  Image image = read_image(file);
  Json json = {{"file", file},
               {"width", image.width},
               {"height", image.height},
               {"storage", storage_text(read_bitmap(file))}};
  if (image.full_width > 0)
    json["window"] = {{"x", image.x},
                      {"y", image.y},
                      {"full_width", image.full_width},
                      {"full_height", image.full_height}};
  json["channels"] = Json::array();
  for (int c = 0; c < image.channel_count(); ++c)
    json["channels"].push_back(channel_json(image, c));
  json["metadata"] = Json::object();
  for (const auto& [name, value] : image.metadata)
    json["metadata"][name] = metadata_json(value);
  return json;
}

std::string words(const Json& list) {
  std::string text;
  for (const Json& word : list)
    text += (text.empty() ? "" : " ") + word.get<std::string>();
  return text;
}

std::string cpu_text(const Json& j) {
  return fmt::format("cpu               {}\nthreads           {}\ninstruction sets  {} (best: {})\n"
                     "modules           {}\nmodule folder     {}\n",
                     j["cpu"].get<std::string>(), j["threads"].get<unsigned>(),
                     words(j["instruction_sets"]), j["best"].get<std::string>(),
                     words(j["modules"]), j["module_folder"].get<std::string>());
}

std::string image_text(const Json& j) {
  std::string text =
      fmt::format("{}: {} x {}, {}\n", j["file"].get<std::string>(), j["width"].get<int>(),
                  j["height"].get<int>(), j["storage"].get<std::string>());
  if (j.contains("window")) {
    const Json& w = j["window"];
    text += fmt::format("  window at {}, {} of a frame of {} x {}\n", w["x"].get<int>(),
                        w["y"].get<int>(), w["full_width"].get<int>(), w["full_height"].get<int>());
  }
  for (const Json& c : j["channels"]) {
    text +=
        fmt::format("  {:<8} min {:<12.6g} max {:<12.6g} mean {:.6g}", c["name"].get<std::string>(),
                    c["min"].get<double>(), c["max"].get<double>(), c["mean"].get<double>());
    if (size_t bad = c["non_finite"].get<size_t>())
      text += fmt::format(", {} not finite", bad);
    text += "\n";
  }
  for (const auto& [name, value] : j["metadata"].items())
    text += fmt::format("  {} = {}\n", name,
                        value.is_string() ? value.get<std::string>() : value.dump());
  return text;
}

} // namespace

int run_info(const InfoOptions& options) {
  Json all = Json::array();
  std::string text;
  if (options.cpu) {
    all.push_back(cpu_json());
    text += cpu_text(all.back());
  }
  for (const std::string& file : options.files) {
    if (fs::path(file).extension() == ".xml") {
      SceneInfo info = scene_info(file, options.defines);
      all.push_back(Json::parse(info.json));
      text += info.text;
    } else {
      all.push_back(image_json(file));
      text += image_text(all.back());
    }
  }
  if (options.json)
    text =
        (all.size() == 1 ? all[0] : all).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  std::fputs(text.c_str(), stdout);
  return kOk;
}

} // namespace faceta::cli
