#include "formats/mitsuba_reader.h"
#include "formats/xml_values.h"
#include "scene/affine.h"

#include <cmath>
#include <fmt/format.h>

namespace faceta::mitsuba {

namespace {

constexpr double kRadians = 3.14159265358979323846 / 180;

SourcePosition position(const xml::Node& node, std::string_view name) {
  const xml::Property* property = node.find(name);
  return property ? property->where : node.where;
}

/// A string that must be one of the words, whatever its case.
std::string read_word(const xml::Node& node, std::string_view name, const char* fallback,
                      const std::vector<std::string>& words) {
  std::string word = lower(node.get_string(name, fallback));
  for (const std::string& known : words)
    if (word == known)
      return word;
  throw node.error_at(
      name, fmt::format("'{}' of {} cannot be '{}'", name, node.describe(), node.get_string(name)),
      suggestion(word, words));
}

/// The diagonal of a 36 x 24 mm film behind a lens of that focal length, degrees.
double read_focal_length(const xml::Node& node) {
  std::string text = node.get_string("focal_length", "50mm");
  std::string number = text.ends_with("mm") ? text.substr(0, text.size() - 2) : text;
  std::optional<double> length = xml::parse_number(number);
  if (!length || !(*length > 0) || !std::isfinite(*length))
    throw node.error_at("focal_length",
                        fmt::format("'focal_length' is '{}', but must be a positive number of "
                                    "millimetres",
                                    text),
                        "<string name=\"focal_length\" value=\"50mm\"/>");
  return 2 * std::atan(std::hypot(36.0, 24.0) / (2 * *length)) / kRadians;
}

double read_x_fov(const xml::Node& node, double aspect) {
  if (node.has("fov") && node.has("focal_length"))
    throw node.error_at("focal_length", "a sensor has a 'fov' or a 'focal_length', not both");
  std::string axis = "diagonal";
  double fov;
  if (node.has("fov")) {
    fov = node.get_float("fov");
    axis = read_word(node, "fov_axis", "x", {"x", "y", "diagonal", "smaller", "larger"});
    if (axis == "smaller")
      axis = aspect > 1 ? "y" : "x";
    else if (axis == "larger")
      axis = aspect > 1 ? "x" : "y";
  } else {
    fov = read_focal_length(node);
  }
  double half = std::tan(0.5 * fov * kRadians);
  double x_fov = fov;
  if (axis == "y")
    x_fov = 2 * std::atan(half * aspect) / kRadians;
  else if (axis == "diagonal")
    x_fov = 2 * std::atan(half / std::sqrt(1 + 1 / (aspect * aspect))) / kRadians;
  if (!(fov > 0 && fov < 180 && x_fov > 0 && x_fov < 180))
    throw node.error_at(node.has("fov") ? "fov" : "focal_length",
                        fmt::format("the field of view of {} is {} degrees, but must lie between 0 "
                                    "and 180",
                                    node.describe(), x_fov));
  return x_fov;
}

/// Mitsuba's own tolerance: rows of length 1 at right angles, up to 10^-3.
void check_rigid(const ToWorld& m, const SourcePosition& where) {
  located(where, [&] { check_affine(m); });
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = i; j < 3; ++j) {
      double product = 0;
      for (size_t k = 0; k < 3; ++k)
        product += m[4 * i + k] * m[4 * j + k];
      if (!(std::abs(product - (i == j ? 1 : 0)) <= 1e-3))
        throw Error("a camera's to_world must not scale or shear", where);
    }
}

double finite(const xml::Node& node, std::string_view name, double fallback) {
  double value = node.get_float(name, fallback);
  if (!std::isfinite(value))
    throw node.error_at(name, fmt::format("'{}' is not finite", name));
  return value;
}

} // namespace

void Reader::read_sensor(const xml::Node& node) {
  if (node.type != "perspective")
    throw unsupported_plugin(node, {"perspective"});
  SensorDesc sensor;
  sensor.id = node.id;
  auto single = [&](const char* tag) {
    std::vector<const xml::Property*> found = node.object_properties(tag);
    if (found.size() > 1)
      throw Error(fmt::format("{} has more than one {}", node.describe(), tag), found[1]->where);
    return found.empty() ? nullptr : found[0]->object();
  };
  for (const xml::Property* medium : node.object_properties("medium"))
    throw Error(
        fmt::format("medium '{}' around a sensor is not supported yet", medium->object()->type),
        medium->where);
  if (xml::NodePtr film = single("film"))
    sensor.film = read_film(*film);
  if (xml::NodePtr sampler = single("sampler"))
    sensor.sampler = read_sampler(*sampler);
  sensor.camera = read_camera(node, sensor.film);
  scene_->sensors.push_back(sensor);
}

CameraDesc Reader::read_camera(const xml::Node& node, const FilmDesc& film) {
  CameraDesc camera;
  camera.to_world = node.get_transform("to_world", xml::kIdentity);
  check_rigid(camera.to_world, position(node, "to_world"));
  camera.x_fov = read_x_fov(node, double(film.width) / film.height);
  camera.near_clip = positive(node, "near_clip", 0.01);
  camera.far_clip = positive(node, "far_clip", 1e4);
  if (camera.near_clip >= camera.far_clip)
    throw node.error_at("near_clip", fmt::format("'near_clip' ({}) must be smaller than 'far_clip' "
                                                 "({})",
                                                 camera.near_clip, camera.far_clip));
  node.get_float("focus_distance", 0); // a pinhole has no focus
  camera.principal_point[0] = finite(node, "principal_point_offset_x", 0);
  camera.principal_point[1] = finite(node, "principal_point_offset_y", 0);
  if (node.get_float("shutter_open", 0) > node.get_float("shutter_close", 0))
    throw node.error_at("shutter_open", "'shutter_open' must not be later than 'shutter_close'");
  if (node.has("srf"))
    throw node.error_at("srf", "the spectral response 'srf' needs spectral rendering, which is not "
                               "supported yet");
  std::vector<std::string> known = {"to_world",
                                    "near_clip",
                                    "far_clip",
                                    "focus_distance",
                                    "principal_point_offset_x",
                                    "principal_point_offset_y",
                                    "shutter_open",
                                    "shutter_close",
                                    "fov",
                                    "focal_length"};
  if (node.has("fov"))
    known.emplace_back("fov_axis");
  finish(node, known);
  return camera;
}

FilmDesc Reader::read_film(const xml::Node& node) {
  if (node.type != "hdrfilm")
    throw unsupported_plugin(node, {"hdrfilm"});
  FilmDesc film;
  film.width = node.get_integer("width", film.width, 1, kMaxDimension);
  film.height = node.get_integer("height", film.height, 1, kMaxDimension);
  located(node.where, [&] { check_image_size(film.width, film.height); });
  bool crops = node.has("crop_offset_x") || node.has("crop_offset_y") || node.has("crop_width") ||
               node.has("crop_height");
  int x = node.get_integer("crop_offset_x", 0, 0, kMaxDimension);
  int y = node.get_integer("crop_offset_y", 0, 0, kMaxDimension);
  int width = node.get_integer("crop_width", film.width, 1, kMaxDimension);
  int height = node.get_integer("crop_height", film.height, 1, kMaxDimension);
  if (x + width > film.width || y + height > film.height)
    throw node.error(fmt::format("the crop window of {} x {} at ({}, {}) leaves the film of {} x "
                                 "{}",
                                 width, height, x, y, film.width, film.height),
                     "crop_width and crop_height are those of the film unless given");
  if (crops) {
    film.crop_x = x;
    film.crop_y = y;
    film.crop_width = width;
    film.crop_height = height;
  }
  film.file_format = read_word(node, "file_format", "openexr", {"openexr", "exr", "rgbe", "pfm"});
  if (film.file_format == "exr")
    film.file_format = "openexr";
  film.pixel_format = read_word(node, "pixel_format", "rgb",
                                {"luminance", "luminance_alpha", "rgb", "rgba", "xyz", "xyza"});
  film.component_format =
      read_word(node, "component_format", "float16", {"float16", "float32", "uint32"});
  if (film.component_format == "uint32")
    throw node.error_at("component_format", "component_format 'uint32' is not supported yet",
                        "use float16 or float32");
  if (node.get_boolean("sample_border", false))
    throw node.error_at("sample_border", "'sample_border' of film 'hdrfilm' is not supported yet");
  node.mark("banner");
  node.mark("compensate");
  std::vector<const xml::Property*> filters = node.object_properties("rfilter");
  if (filters.size() > 1)
    throw Error(node.describe() + " has more than one rfilter", filters[1]->where);
  if (!filters.empty())
    film.filter = read_filter(*filters[0]->object());
  finish(node, {"width", "height", "crop_offset_x", "crop_offset_y", "crop_width", "crop_height",
                "file_format", "pixel_format", "component_format", "sample_border", "banner",
                "compensate"});
  return film;
}

FilterDesc Reader::read_filter(const xml::Node& node) {
  FilterDesc filter;
  std::vector<std::string> known;
  if (node.type == "box") {
    filter.type = FilterType::box;
  } else if (node.type == "tent") {
    filter.type = FilterType::tent;
    filter.radius = positive(node, "radius", 1);
    known = {"radius"};
  } else if (node.type == "gaussian") {
    filter.type = FilterType::gaussian;
    filter.stddev = positive(node, "stddev", 0.5);
    known = {"stddev"};
  } else {
    throw unsupported_plugin(node, {"box", "tent", "gaussian"});
  }
  finish(node, known);
  return filter;
}

SamplerDesc Reader::read_sampler(const xml::Node& node) {
  if (node.type != "independent" && node.type != "sobol")
    throw unsupported_plugin(node, {"independent", "sobol"});
  SamplerDesc sampler;
  sampler.type = node.type;
  sampler.sample_count = node.get_integer("sample_count", 4, 1);
  sampler.seed = static_cast<uint32_t>(node.get_integer64("seed", 0, 0, UINT32_MAX));
  finish(node, {"sample_count", "seed"});
  return sampler;
}

} // namespace faceta::mitsuba
