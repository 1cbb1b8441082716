#include "formats/material_xml.h"

#include "formats/mitsuba_reader.h"
#include "spectrum/cie.h"

#include <fmt/format.h>

namespace faceta {

namespace {

xml::NodePtr make_bsdf(const std::string& type) {
  auto node = std::make_shared<xml::Node>();
  node->tag = "bsdf";
  node->type = type;
  return node;
}

/// A colour that an <rgb> cannot carry, because it is no reflectance.
xml::NodePtr unbounded_color(const xml::Numbers3& rgb) {
  auto node = std::make_shared<xml::Node>();
  node->tag = "spectrum";
  node->type = "srgb";
  node->set("color", xml::Type::rgb, rgb);
  node->set("unbounded", xml::Type::boolean, true);
  return node;
}

void write_numbers(xml::Node& node, const ParamInfo& parameter, const double* slots) {
  bool same = true;
  for (int i = 1; i < parameter.slots; ++i)
    same = same && slots[i] == slots[0];
  if (same) {
    node.set(parameter.name, xml::Type::float_, slots[0]);
    return;
  }
  xml::Numbers3 rgb = {slots[0], slots[1], slots[2]};
  bool fits = true;
  for (double v : rgb)
    fits = fits && v >= parameter.hard.low && v <= parameter.hard.high;
  if (fits)
    node.set(parameter.name, xml::Type::rgb, rgb);
  else
    node.add_object(unbounded_color(rgb), parameter.name);
}

void write_parameter(xml::Node& node, const ParamInfo& parameter, const Parameters& values) {
  const std::string& name = parameter.name;
  if (parameter.kind == ParamKind::flag) {
    bool on = values.choices()[static_cast<size_t>(parameter.choice)] != 0;
    node.set(name, xml::Type::boolean, on);
  } else if (parameter.kind == ParamKind::choice) {
    node.set(name, xml::Type::string, values.text(name));
  } else if (!values.given_name(name).empty()) {
    node.set(name, xml::Type::string, values.given_name(name));
  } else {
    write_numbers(node, parameter, &values.slots()[static_cast<size_t>(parameter.slot)]);
  }
}

class Writer {
public:
  explicit Writer(const TextureToXml& texture) : texture_(texture) {}

  xml::NodePtr write(const MaterialNode& material) {
    xml::NodePtr& node = written_[&material];
    if (!node)
      node = make(material);
    return node;
  }

private:
  xml::NodePtr make(const MaterialNode& material) {
    xml::NodePtr node;
    switch (material.kind) {
    case MaterialNode::Kind::model:
      node = parameters_to_xml(*material.parameters);
      for (const auto& [name, texture] : material.textures)
        set_texture(*node, name, texture, material);
      break;
    case MaterialNode::Kind::blend:
      node = make_bsdf("blendbsdf");
      set_weight(*node, "weight", material);
      break;
    case MaterialNode::Kind::mask:
      node = make_bsdf("mask");
      set_weight(*node, "opacity", material);
      break;
    case MaterialNode::Kind::twosided:
      node = make_bsdf("twosided");
      break;
    case MaterialNode::Kind::null:
      node = make_bsdf("null");
      break;
    }
    for (const auto& child : material.children)
      node->add_object(write(*child));
    return node;
  }

  void set_texture(xml::Node& node, const std::string& name, int texture,
                   const MaterialNode& material) {
    if (!texture_)
      throw Error(fmt::format("the texture of '{}' cannot be written", name), material.where);
    node.set(name, xml::Type::object, texture_(texture));
  }

  void set_weight(xml::Node& node, const char* name, const MaterialNode& material) {
    const std::array<double, 3>& v = material.weight.value;
    bool is_grey = v[0] == v[1] && v[1] == v[2];
    if (material.weight.texture >= 0)
      set_texture(node, name, material.weight.texture, material);
    else // the reader takes a colour's mean, the renderer its luminance
      node.set(name, xml::Type::float_, is_grey ? v[0] : luminance(v));
  }

  const TextureToXml& texture_;
  std::unordered_map<const MaterialNode*, xml::NodePtr> written_;
};

} // namespace

xml::NodePtr parameters_to_xml(const Parameters& parameters) {
  xml::NodePtr node = make_bsdf(parameters.model().name());
  for (const ParamInfo& parameter : parameters.descriptor().params)
    if (parameters.was_set(parameter.name))
      write_parameter(*node, parameter, parameters);
  return node;
}

xml::NodePtr material_to_xml(const MaterialNode& material, const TextureToXml& texture) {
  return Writer(texture).write(material);
}

std::string write_material(const Parameters& parameters) {
  return xml::write_xml(*parameters_to_xml(parameters));
}

std::string write_material(const MaterialNode& material, const TextureToXml& texture) {
  return xml::write_xml(*material_to_xml(material, texture));
}

Parameters through_xml(const Parameters& parameters) {
  return *parse_material(write_material(parameters))->parameters;
}

std::shared_ptr<MaterialNode> parse_material(std::string_view text, const std::string& name,
                                             Scene* scene, const ReadOptions& options) {
  xml::ParseOptions parse;
  parse.defines = options.defines;
  parse.permissive = options.permissive;
  parse.search_paths = options.search_paths;
  parse.warn = options.warn;
  xml::NodePtr root = xml::parse_scene_string(text, name, parse);
  if (root->tag != "bsdf")
    throw root->error(fmt::format("expected a <bsdf>, not a <{}>", root->tag));
  return mitsuba::Reader(scene, options).read_material(root);
}

} // namespace faceta
