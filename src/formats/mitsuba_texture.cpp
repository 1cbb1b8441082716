#include "formats/mitsuba_reader.h"
#include "formats/xml_values.h"
#include "image/io.h"

#include <bit>
#include <cmath>
#include <fmt/format.h>

namespace faceta::mitsuba {

namespace {

TexturedValue grey(double value) {
  return {{value, value, value}, -1};
}

/// One number of a colour, as Mitsuba's eval_1 of an srgb colour.
TexturedValue constant(const std::array<double, 3>& rgb, const ColorUse& use) {
  return use.scalar ? grey((rgb[0] + rgb[1] + rgb[2]) / 3) : TexturedValue{rgb, -1};
}

void check_not_negative(const std::array<double, 3>& rgb, const SourcePosition& where,
                        std::string_view what) {
  for (double v : rgb)
    if (!(v >= 0) || !std::isfinite(v))
      throw Error(fmt::format("{} is {}, but must be finite and not negative", what, v), where);
}

void check_rgb(const std::array<double, 3>& rgb, const ColorUse& use, const SourcePosition& where,
               std::string_view what) {
  check_not_negative(rgb, where, what);
  if (use.spectrum != SpectrumUse::reflectance)
    return;
  for (double v : rgb)
    if (v > 1)
      throw Error(fmt::format("{}: the rgb colour {}, {}, {} is no reflectance: components must "
                              "lie between 0 and 1",
                              what, rgb[0], rgb[1], rgb[2]),
                  where);
}

TexturedValue from_spectrum(const xml::SpectrumValue& spectrum, const ColorUse& use,
                            const SourcePosition& where, std::string_view what) {
  SpectrumValue value;
  if (spectrum.is_uniform()) {
    value = spectrum.values.at(0);
  } else {
    SpectrumCurve curve{spectrum.wavelengths, spectrum.values};
    check_spectrum(curve, where);
    value = std::move(curve);
  }
  std::array<double, 3> rgb = spectrum_to_rgb(value, use.spectrum);
  check_not_negative(rgb, where, what);
  return constant(rgb, use);
}

SourcePosition position(const xml::Node& node, std::string_view name) {
  const xml::Property* property = node.find(name);
  return property ? property->where : node.where;
}

std::string what(const xml::Node& node, std::string_view name) {
  return fmt::format("'{}' of {}", name, node.describe());
}

std::vector<double> numbers_of(const xml::Node& node, std::string_view name) {
  std::string text = node.get_string(name);
  return xml::parse_numbers(text, position(node, name));
}

/// <spectrum type="uniform">: the same number in every use. (As emission Mitsuba 3.9.1 keeps it
/// grey, other than <spectrum value>.)
TexturedValue read_uniform(const xml::Node& node) {
  double value = node.get_float("value");
  node.get_float("wavelength_min", 360);
  node.get_float("wavelength_max", 830);
  TexturedValue result = grey(value);
  check_not_negative(result.value, position(node, "value"), what(node, "value"));
  return result;
}

TexturedValue read_srgb(const xml::Node& node, ColorUse use) {
  xml::Numbers3 rgb = node.get_rgb("color");
  use.spectrum =
      node.get_boolean("unbounded", false) ? SpectrumUse::unbounded : SpectrumUse::reflectance;
  check_rgb(rgb, use, position(node, "color"), what(node, "color"));
  return constant(rgb, use);
}

TexturedValue read_raw_constant(const xml::Node& node, const ColorUse& use) {
  auto type = node.type_of("value");
  std::array<double, 3> rgb;
  if (type == xml::Type::vector || type == xml::Type::point)
    rgb = node.get_vector("value");
  else
    rgb = grey(node.get_float("value")).value;
  check_not_negative(rgb, position(node, "value"), what(node, "value"));
  return constant(rgb, use);
}

TexturedValue read_sampled_spectrum(const xml::Node& node, const ColorUse& use) {
  xml::SpectrumValue spectrum;
  spectrum.values = numbers_of(node, "values");
  const char* last = node.type == "regular" ? "values" : "wavelengths";
  if (node.type == "regular") {
    double low = node.get_float("wavelength_min"), high = node.get_float("wavelength_max");
    size_t count = spectrum.values.size();
    for (size_t i = 0; i < count; ++i)
      spectrum.wavelengths.push_back(low + (high - low) * double(i) / double(count - 1));
  } else {
    spectrum.wavelengths = numbers_of(node, "wavelengths");
  }
  if (spectrum.values.size() != spectrum.wavelengths.size() || spectrum.values.size() < 2)
    throw node.error_at(last, fmt::format("{} needs as many values as wavelengths, and at least 2; "
                                          "there are {} and {}",
                                          node.describe(), spectrum.values.size(),
                                          spectrum.wavelengths.size()));
  return from_spectrum(spectrum, use, position(node, last), what(node, "values"));
}

std::array<double, 6> read_to_uv(const xml::Node& node) {
  xml::Matrix3 m = node.get_transform_2d("to_uv");
  std::array<double, 6> rows{m[0], m[1], m[2], m[3], m[4], m[5]};
  for (double v : rows)
    if (!std::isfinite(v))
      throw node.error_at("to_uv", what(node, "to_uv") + " is not finite");
  return rows;
}

template <class T> void append(std::string& key, const T& value) {
  key.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

std::string key_of(const TextureDesc& texture) {
  std::string key;
  append(key, texture.type);
  append(key, reinterpret_cast<uintptr_t>(texture.bitmap.get()));
  append(key, texture.raw);
  append(key, texture.wrap);
  append(key, texture.nearest);
  append(key, texture.to_uv);
  append(key, texture.color);
  append(key, texture.child);
  return key;
}

} // namespace

Scene& Reader::need_scene(const SourcePosition& where) const {
  if (!scene_)
    throw Error("a texture cannot be read without a scene to hold it", where);
  return *scene_;
}

TexturedValue Reader::read_color(const xml::Node& node, std::string_view name, const ColorUse& use,
                                 double fallback) {
  const xml::Property* property = node.find(name);
  if (!property)
    return grey(fallback);
  switch (property->type) {
  case xml::Type::float_:
  case xml::Type::integer: {
    TexturedValue value = grey(node.get_float(name));
    check_not_negative(value.value, property->where, what(node, name));
    return value;
  }
  case xml::Type::rgb: {
    xml::Numbers3 rgb = node.get_rgb(name);
    check_rgb(rgb, use, property->where, what(node, name));
    return constant(rgb, use);
  }
  case xml::Type::spectrum:
    return from_spectrum(node.get_spectrum(name), use, property->where, what(node, name));
  case xml::Type::object: {
    xml::NodePtr object = node.get_object(name);
    if (object->tag == "texture" || object->tag == "spectrum")
      return read_texture(object, use);
    throw Error(fmt::format("{} must be a texture, not a {}", what(node, name), object->tag),
                property->where);
  }
  default:
    throw Error(fmt::format("{} must be a float, rgb, spectrum or texture, not of type {}",
                            what(node, name), xml::type_name(property->type)),
                property->where);
  }
}

std::array<double, 3> Reader::read_constant_color(const xml::Node& node, std::string_view name,
                                                  const ColorUse& use, double fallback) {
  TexturedValue value = read_color(node, name, use, fallback);
  if (value.texture >= 0)
    throw node.error_at(name, what(node, name) + " cannot be a texture that varies in space");
  return value.value;
}

TexturedValue Reader::read_texture(const xml::NodePtr& node, const ColorUse& use) {
  // Which spectra there are depends on the use as well; only what makes textures is worth keeping.
  auto [found, is_new] = textures_.try_emplace({node.get(), use.scalar});
  if (!is_new && found->second.texture >= 0)
    return found->second;
  return found->second = read_texture_plugin(*node, use);
}

TexturedValue Reader::read_texture_plugin(const xml::Node& node, const ColorUse& use) {
  TexturedValue result{{1, 1, 1}, -1};
  std::vector<std::string> known;
  if (node.type == "bitmap") {
    result.texture = read_bitmap_texture(node);
    known = {"filename", "filter_type", "wrap_mode", "raw", "to_uv", "format", "accel"};
  } else if (node.type == "checkerboard") {
    result.texture = read_checkerboard(node, use);
    known = {"color0", "color1", "to_uv"};
  } else if (node.type == "uniform") {
    result = read_uniform(node);
    known = {"value", "wavelength_min", "wavelength_max"};
  } else if (node.type == "srgb") {
    result = read_srgb(node, use);
    known = {"color", "unbounded"};
  } else if (node.type == "d65") {
    result = read_d65(node, use);
    known = {"scale", "color"};
  } else if (node.type == "rawconstant") {
    result = read_raw_constant(node, use);
    known = {"value"};
  } else if (node.type == "regular" || node.type == "irregular") {
    result = read_sampled_spectrum(node, use);
    known = {"values", "wavelengths", "wavelength_min", "wavelength_max"};
  } else {
    throw unsupported_plugin(node, {"bitmap", "checkerboard", "uniform", "srgb", "d65", "regular",
                                    "irregular", "rawconstant"});
  }
  finish(node, known);
  return result;
}

/// White is grey in RGB: the colour (1 if absent) or the nested texture, times the scale.
TexturedValue Reader::read_d65(const xml::Node& node, const ColorUse& use) {
  double scale = non_negative(node, "scale", 1);
  std::vector<xml::NodePtr> nested = node.objects("texture");
  if (nested.size() + (node.has("color") ? 1 : 0) > 1)
    throw node.error(node.describe() + " takes one colour or one texture");
  if (nested.empty()) {
    xml::Numbers3 rgb = node.get_rgb("color", {1, 1, 1});
    check_not_negative(rgb, position(node, "color"), what(node, "color"));
    for (double& v : rgb)
      v *= scale;
    return constant(rgb, use);
  }
  TexturedValue value = read_texture(nested[0], use);
  if (value.texture >= 0 && scale != 1)
    throw node.error_at("scale", "a 'scale' other than 1 on a texture is not supported yet");
  for (double& v : value.value)
    v *= scale;
  return value;
}

int Reader::read_bitmap_texture(const xml::Node& node) {
  std::filesystem::path file = node.get_file("filename");
  TextureDesc texture;
  texture.nearest =
      node.get_choice("filter_type", "bilinear", {"bilinear", "nearest"}) == "nearest";
  std::string wrap = node.get_choice("wrap_mode", "repeat", {"repeat", "mirror", "clamp"});
  texture.wrap = wrap == "repeat"   ? WrapMode::repeat
                 : wrap == "mirror" ? WrapMode::mirror
                                    : WrapMode::clamp;
  texture.raw = node.get_boolean("raw", false);
  node.get_boolean("accel", true); // how the peer's GPU filters
  std::string format =
      node.get_choice("format", "auto", {"auto", "variant", "float16", "fp16", "uint8"});
  texture.to_uv = read_to_uv(node);
  need_scene(node.where);
  std::shared_ptr<const Bitmap>& bitmap =
      bitmaps_[std::filesystem::weakly_canonical(file).string()];
  if (!bitmap)
    bitmap = std::make_shared<Bitmap>(
        located(position(node, "filename"), [&] { return read_bitmap(file); }));
  if (format == "uint8" && bitmap->type != Bitmap::Type::u8)
    throw node.error_at("format", "'uint8' for a file of more than 8 bits is not supported yet");
  texture.bitmap = bitmap;
  texture.type =
      bitmap->type == Bitmap::Type::u8 ? TextureType::bitmap8 : TextureType::bitmap_float;
  return texture_index(texture, node.where);
}

int Reader::read_checkerboard(const xml::Node& node, const ColorUse& use) {
  TextureDesc texture;
  texture.type = TextureType::checkerboard;
  const char* names[] = {"color0", "color1"};
  const double defaults[] = {0.4, 0.2};
  for (int i = 0; i < 2; ++i) {
    ColorUse reflectance{SpectrumUse::reflectance, use.scalar};
    TexturedValue value = read_color(node, names[i], reflectance, defaults[i]);
    int target = use.scalar ? 1 - i : i;
    texture.color[target] = value.value;
    texture.child[target] = value.texture;
  }
  texture.to_uv = read_to_uv(node);
  return texture_index(texture, node.where);
}

int Reader::texture_index(const TextureDesc& texture, const SourcePosition& where) {
  Scene& scene = need_scene(where);
  auto [found, is_new] = texture_indices_.try_emplace(key_of(texture), -1);
  if (is_new)
    found->second = located(where, [&] { return scene.add_texture(texture); });
  return found->second;
}

} // namespace faceta::mitsuba
