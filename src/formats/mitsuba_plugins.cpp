#include "formats/mitsuba_reader.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace faceta::mitsuba {

namespace {

struct Plugins {
  const char* tag;
  std::vector<std::string> names;
};

/// Every plugin of the scene contract, by tag.
const std::vector<Plugins>& contract_plugins() {
  static const std::vector<Plugins> plugins = {
      {"bsdf", {"diffuse",   "dielectric",         "thindielectric", "roughdielectric",
                "conductor", "roughconductor",     "plastic",        "roughplastic",
                "pplastic",  "principled",         "principledthin", "hair",
                "measured",  "measured_polarized", "blendbsdf",      "mask",
                "twosided",  "normalmap",          "bumpmap",        "null",
                "polarizer", "retarder",           "circular"}},
      {"texture",
       {"bitmap", "checkerboard", "mesh_attribute", "volume", "uniform", "srgb", "regular",
        "irregular", "d65", "blackbody", "rawconstant"}},
      {"shape",
       {"obj", "ply", "serialized", "sphere", "rectangle", "disk", "cylinder", "cube",
        "bsplinecurve", "linearcurve", "sdfgrid", "shapegroup", "instance", "merge", "ellipsoids",
        "ellipsoidsmesh"}},
      {"emitter",
       {"area", "constant", "envmap", "point", "spot", "directional", "directionalarea",
        "projector", "sunsky", "timed_sunsky"}},
      {"sensor",
       {"perspective", "thinlens", "orthographic", "radiancemeter", "irradiancemeter", "distant",
        "batch"}},
      {"film", {"hdrfilm", "specfilm"}},
      {"rfilter", {"box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos"}},
      {"sampler", {"independent", "stratified", "multijitter", "orthogonal", "ldsampler"}},
      {"integrator",
       {"path", "volpath", "volpathmis", "direct", "ptracer", "depth", "aov", "moment", "stokes",
        "prb", "prb_basic", "prbvolpath", "direct_projective", "prb_projective",
        "volprim_rf_basic"}},
      {"medium", {"homogeneous", "heterogeneous"}},
      {"phase", {"isotropic", "hg", "rayleigh", "sggx", "tabphase", "blendphase"}},
      {"volume", {"constvolume", "gridvolume"}}};
  return plugins;
}

} // namespace

Error unsupported_plugin(const xml::Node& node, const std::vector<std::string>& supported) {
  std::string tag = node.tag == "spectrum" ? "texture" : node.tag;
  std::vector<std::string> known = supported;
  for (const Plugins& plugins : contract_plugins())
    if (tag == plugins.tag) {
      if (std::find(plugins.names.begin(), plugins.names.end(), node.type) != plugins.names.end())
        return node.error(
            fmt::format("{} '{}' is not supported yet", node.tag, node.type),
            supported.empty() ? "" : fmt::format("supported: {}", fmt::join(supported, ", ")));
      for (const std::string& name : plugins.names)
        if (std::find(known.begin(), known.end(), name) == known.end())
          known.push_back(name);
    }
  return node.error(fmt::format("unknown {} '{}'", node.tag, node.type),
                    suggestion(node.type, known));
}

double positive(const xml::Node& node, std::string_view name, double fallback) {
  double value = node.get_float(name, fallback);
  if (!(value > 0) || !std::isfinite(value))
    throw node.error_at(name, fmt::format("'{}' of {} is {}, but must be positive and finite", name,
                                          node.describe(), value));
  return value;
}

double non_negative(const xml::Node& node, std::string_view name, double fallback) {
  double value = node.get_float(name, fallback);
  if (!(value >= 0) || !std::isfinite(value))
    throw node.error_at(name, fmt::format("'{}' of {} is {}, but must be finite and not negative",
                                          name, node.describe(), value));
  return value;
}

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z')
      c = static_cast<char>(c - 'A' + 'a');
  return text;
}

void Reader::finish(const xml::Node& node, const std::vector<std::string>& known) {
  xml::check_all_queried(node, options_.permissive, known, options_.warn);
}

void Reader::warn(const SourcePosition& where, const std::string& message) const {
  if (options_.warn)
    options_.warn(
        fmt::format("{}:{}:{}: warning: {}", where.file, where.line, where.column, message));
}

} // namespace faceta::mitsuba
