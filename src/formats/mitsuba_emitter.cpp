#include "formats/mitsuba_reader.h"
#include "image/io.h"
#include "scene/affine.h"

#include <fmt/format.h>

namespace faceta::mitsuba {

namespace {

constexpr ColorUse kEmission{SpectrumUse::emission, false};

SourcePosition position(const xml::Node& node, std::string_view name) {
  const xml::Property* property = node.find(name);
  return property ? property->where : node.where;
}

} // namespace

double Reader::read_sampling_weight(const xml::Node& node) {
  return non_negative(node, "sampling_weight", 1);
}

void Reader::refuse_emitter_children(const xml::Node& node) {
  for (const xml::Property* medium : node.object_properties("medium"))
    throw Error(
        fmt::format("medium '{}' in an emitter is not supported yet", medium->object()->type),
        medium->where);
}

std::shared_ptr<AreaEmitter> Reader::read_area_emitter(const xml::Node& node) {
  auto emitter = std::make_shared<AreaEmitter>();
  if (node.has("to_world"))
    throw node.error_at("to_world", "an area emitter has no 'to_world'",
                        "it lies where its shape lies");
  refuse_emitter_children(node);
  emitter->radiance = read_color(node, "radiance", kEmission, 1);
  emitter->sampling_weight = read_sampling_weight(node);
  finish(node, {"radiance", "sampling_weight"});
  return emitter;
}

void Reader::read_point_light(const xml::Node& node) {
  PointLightDesc light;
  if (node.has("position") && node.has("to_world"))
    throw node.error_at("position", "a point emitter has a 'position' or a 'to_world', not both");
  if (node.has("position"))
    light.position = node.get_point("position");
  else
    light.position = double3::column(node.get_transform("to_world", xml::kIdentity), 3);
  if (!double3::finite(light.position))
    throw node.error_at(node.has("position") ? "position" : "to_world",
                        "the position of " + node.describe() + " is not finite");
  refuse_emitter_children(node);
  light.intensity = read_constant_color(node, "intensity", kEmission, 1);
  light.sampling_weight = read_sampling_weight(node);
  finish(node, {"intensity", "position", "to_world", "sampling_weight"});
  located(node.where, [&] { scene_->add_point_light(light); });
}

void Reader::set_environment(const xml::Node& node, const EnvironmentDesc& environment) {
  if (environment_)
    throw node.error(fmt::format("a second environment: {} beside {}", node.describe(),
                                 environment_->describe()));
  environment_ = &node;
  located(node.where, [&] { scene_->set_environment(environment); });
}

void Reader::read_constant_environment(const xml::Node& node) {
  EnvironmentDesc environment;
  refuse_emitter_children(node);
  environment.radiance = read_constant_color(node, "radiance", kEmission, 1);
  environment.sampling_weight = read_sampling_weight(node);
  node.get_transform("to_world", xml::kIdentity); // turns a constant into itself
  finish(node, {"radiance", "sampling_weight", "to_world"});
  set_environment(node, environment);
}

void Reader::read_envmap(const xml::Node& node) {
  EnvironmentDesc environment;
  refuse_emitter_children(node);
  std::filesystem::path file = node.get_file("filename");
  environment.radiance.fill(non_negative(node, "scale", 1));
  environment.to_world = node.get_transform("to_world", xml::kIdentity);
  located(position(node, "to_world"), [&] {
    check_affine(environment.to_world);
    inverse(environment.to_world, "the environment's to_world");
  });
  if (node.get_boolean("mis_compensation", false))
    throw node.error_at("mis_compensation",
                        "'mis_compensation' of emitter 'envmap' is not supported yet",
                        "leave it out, or set it to false: it only changes the noise");
  environment.sampling_weight = read_sampling_weight(node);
  finish(node, {"filename", "scale", "to_world", "mis_compensation", "sampling_weight"});
  environment.image = located(position(node, "filename"), [&] {
    return std::make_shared<Image>(read_image(file).rgb(RgbFallback::luminance_or_xyz));
  });
  set_environment(node, environment);
}

} // namespace faceta::mitsuba
