#include "formats/measured_loader.h"
#include "formats/mitsuba_reader.h"
#include "formats/xml_values.h"
#include "materials/measured_demo.h"

#include <algorithm>
#include <fmt/format.h>

namespace faceta::mitsuba {

namespace {

using MaterialPtr = std::shared_ptr<MaterialNode>;

/// Models that only the scene knows, beside those of the registry.
const std::vector<std::string> kTreeNodes = {"twosided", "mask", "blendbsdf", "null"};

/// Whether a type is another name of the model `measured`: of a format, which the file must have
/// then, or of Mitsuba's.
bool names_measured(const std::string& type, const Model& measured) {
  const std::vector<std::string>& formats = measured.descriptor.find("format")->choices;
  return type == "measured_polarized" ||
         (type != "auto" && std::find(formats.begin(), formats.end(), type) != formats.end());
}

std::vector<std::string> supported_bsdfs() {
  std::vector<std::string> names = Registry::global().names();
  for (const std::string& format :
       Registry::global().get("measured").descriptor.find("format")->choices)
    if (format != "auto")
      names.push_back(format);
  names.push_back("measured_polarized");
  names.insert(names.end(), kTreeNodes.begin(), kTreeNodes.end());
  return names;
}

MaterialPtr make_node(const xml::Node& node, MaterialNode::Kind kind) {
  auto material = std::make_shared<MaterialNode>();
  material->kind = kind;
  material->where = node.where;
  return material;
}

SourcePosition position(const xml::Node& node, const std::string& name) {
  const xml::Property* property = node.find(name);
  return property ? property->where : node.where;
}

void read_word(const xml::Node& node, const ParamInfo& parameter, Parameters& values) {
  SourcePosition where = position(node, parameter.name);
  if (parameter.kind == ParamKind::flag) {
    values.set(parameter.name, node.get_boolean(parameter.name) ? "true" : "false", where);
    return;
  }
  std::string word = node.get_string(parameter.name);
  const std::vector<std::string>& words = parameter.choices;
  if (std::find(words.begin(), words.end(), word) == words.end())
    word = lower(word);
  values.set(parameter.name, word, where);
}

/// A number must be a <float>, a name a <string>: nothing else, not even an <integer>.
void read_ior(const xml::Node& node, const ParamInfo& parameter, Parameters& values) {
  SourcePosition where = position(node, parameter.name);
  switch (*node.type_of(parameter.name)) {
  case xml::Type::float_:
    values.set_number(parameter.name, node.get_float(parameter.name), where);
    break;
  case xml::Type::string: {
    std::string name = node.get_string(parameter.name);
    if (xml::parse_number(name))
      throw Error(
          fmt::format("'{}' of {} is a number in a string", parameter.name, node.describe()), where,
          fmt::format("<float name=\"{}\" value=\"{}\"/>", parameter.name, name));
    values.set(parameter.name, name, where);
    break;
  }
  default:
    throw Error(fmt::format("'{}' of {} must be a float or the name of a material, not of type {}",
                            parameter.name, node.describe(),
                            xml::type_name(*node.type_of(parameter.name))),
                where);
  }
}

bool lists(const std::string& names, const std::string& name) {
  return ("," + names + ",").find("," + name + ",") != std::string::npos;
}

/// The default name ("none") beside eta and k says nothing; it must not overwrite them.
void read_metal(const xml::Node& node, const ParamInfo& parameter, Parameters& values) {
  std::string metal = node.get_string(parameter.name);
  bool idle = false;
  for (const xml::Property& property : node.properties)
    idle = idle || (metal == parameter.default_name && lists(parameter.excludes, property.name));
  if (!idle)
    values.set(parameter.name, metal, position(node, parameter.name));
}

/// eta without k (or k without eta): the other keeps its default, as in the contract, where
/// Parameters::check() wants both.
void complete_metal(Parameters& values, const SourcePosition& where) {
  for (const ParamInfo& metal : values.descriptor().params) {
    if (metal.kind != ParamKind::metal)
      continue;
    bool some = false;
    for (const ParamInfo& p : values.descriptor().params)
      some = some || (lists(metal.excludes, p.name) && values.was_set(p.name));
    for (const ParamInfo& p : values.descriptor().params)
      if (some && lists(metal.excludes, p.name) && !values.was_set(p.name))
        values.set_color(p.name, {p.defaults[0], p.defaults[1], p.defaults[2]}, where);
  }
}

/// The path of a file, or the name of a demonstration.
std::string measured_file(const xml::Node& node, const std::string& name) {
  std::string text = node.get_string(name);
  return is_demo(text) ? text : node.get_file(name).string();
}

/// `measured` is what files of either kind are called in scenes; what they hold says which it is.
const Model& for_its_file(const xml::Node& node, const Model& model) {
  const ParamInfo* file = model.descriptor.file();
  if (model.name() != "measured" || !node.has(file->name))
    return model;
  return Registry::global().get(model_of_measured(measured_file(node, file->name)));
}

template <class T> void append(std::string& key, const T* values, size_t count) {
  key.append(reinterpret_cast<const char*>(&count), sizeof count);
  key.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

} // namespace

MaterialPtr Reader::read_material(const xml::NodePtr& node) {
  if (auto found = materials_.find(node.get()); found != materials_.end())
    return found->second;
  MaterialPtr material;
  if (node->type == "twosided")
    material = read_twosided(*node);
  else if (node->type == "mask")
    material = read_mask(*node);
  else if (node->type == "blendbsdf")
    material = read_blend(*node);
  else if (node->type == "null") {
    material = make_node(*node, MaterialNode::Kind::null);
    finish(*node, {});
  } else if (const Model* model = Registry::global().find(node->type))
    material = read_model(*node, for_its_file(*node, *model));
  else if (const Model& measured = Registry::global().get("measured");
           names_measured(node->type, measured))
    material = read_measured_alias(*node, measured);
  else
    throw unsupported_plugin(*node, supported_bsdfs());
  materials_[node.get()] = material;
  if (!node->id.empty() && scene_)
    scene_->named_materials.emplace_back(node->id, material);
  return material;
}

MaterialPtr Reader::read_model(const xml::Node& node, const Model& model) {
  MaterialPtr material = make_node(node, MaterialNode::Kind::model);
  material->parameters = std::make_shared<Parameters>(model);
  for (const ParamInfo& parameter : model.descriptor.params)
    if (node.has(parameter.name))
      read_parameter(node, parameter, *material);
  finish(node, model.descriptor.param_names());
  complete_metal(*material->parameters, node.where);
  if (const ParamInfo* file = model.descriptor.file())
    material->parameters->load_file(position(node, file->name));
  material->parameters->check(node.where);
  return material;
}

MaterialPtr Reader::read_measured_alias(const xml::Node& node, const Model& measured) {
  xml::Node plain = node;
  if (node.type == "measured_polarized") {
    // A roughness that Mitsuba samples with: what we sample with comes from the file.
    if (node.has("alpha_sample"))
      node.get_float("alpha_sample");
    std::erase_if(plain.properties, [](const auto& p) { return p.name == "alpha_sample"; });
  } else {
    if (node.has("format"))
      throw node.error_at("format", fmt::format("'format' beside the type '{}'", node.type),
                          "leave it out, or make the type 'measured'");
    plain.set("format", xml::Type::string, node.type);
  }
  return read_model(plain, for_its_file(plain, measured));
}

void Reader::read_parameter(const xml::Node& node, const ParamInfo& parameter,
                            MaterialNode& material) {
  Parameters& values = *material.parameters;
  switch (parameter.kind) {
  case ParamKind::reflectance:
  case ParamKind::spectrum:
  case ParamKind::scalar:
  case ParamKind::roughness:
    read_textured_parameter(node, parameter, material);
    break;
  case ParamKind::number:
    values.set_number(parameter.name, node.get_float(parameter.name),
                      position(node, parameter.name));
    break;
  case ParamKind::ior:
    read_ior(node, parameter, values);
    break;
  case ParamKind::choice:
  case ParamKind::flag:
    read_word(node, parameter, values);
    break;
  case ParamKind::metal:
    read_metal(node, parameter, values);
    break;
  case ParamKind::file:
    values.set(parameter.name, measured_file(node, parameter.name), position(node, parameter.name));
    break;
  }
}

void Reader::read_textured_parameter(const xml::Node& node, const ParamInfo& parameter,
                                     MaterialNode& material) {
  const std::string& name = parameter.name;
  SourcePosition where = position(node, name);
  bool color = parameter.kind == ParamKind::reflectance || parameter.kind == ParamKind::spectrum;
  ColorUse use;
  use.spectrum =
      parameter.kind == ParamKind::reflectance ? SpectrumUse::reflectance : SpectrumUse::unbounded;
  use.scalar = !color;
  Parameters& values = *material.parameters;
  if (parameter.clamps_low)
    if (auto type = node.type_of(name); type == xml::Type::float_ || type == xml::Type::integer) {
      values.set_number(name, std::max(node.get_float(name), parameter.hard.low), where,
                        AboveRange::keep);
      return;
    }
  TexturedValue value = read_color(node, name, use, 0);
  if (value.texture >= 0) {
    values.set_texture(name, scene_->texture_mean(value.texture), where);
    material.textures.emplace_back(name, value.texture);
  } else if (color) {
    values.set_color(name, value.value, where, AboveRange::keep);
  } else {
    values.set_number(name, value.value[0], where, AboveRange::keep);
  }
}

std::vector<MaterialPtr> Reader::read_nested_materials(const xml::Node& node) {
  std::vector<MaterialPtr> materials;
  for (const xml::NodePtr& child : node.objects("bsdf"))
    materials.push_back(read_material(child));
  return materials;
}

MaterialPtr Reader::read_twosided(const xml::Node& node) {
  MaterialPtr material = make_node(node, MaterialNode::Kind::twosided);
  material->children = read_nested_materials(node);
  if (node.get_boolean("allow_transmission", false))
    throw node.error_at("allow_transmission", "'allow_transmission' of bsdf 'twosided' is not "
                                              "supported yet");
  finish(node, {"allow_transmission"});
  if (material->children.empty() || material->children.size() > 2)
    throw node.error(fmt::format("{} needs one or two nested bsdfs, not {}", node.describe(),
                                 material->children.size()));
  return material;
}

MaterialPtr Reader::read_mask(const xml::Node& node) {
  MaterialPtr material = make_node(node, MaterialNode::Kind::mask);
  material->weight = read_color(node, "opacity", {SpectrumUse::reflectance, true}, 0.5);
  material->children = read_nested_materials(node);
  finish(node, {"opacity"});
  if (material->children.size() != 1)
    throw node.error(fmt::format("{} needs one nested bsdf, not {}", node.describe(),
                                 material->children.size()));
  return material;
}

MaterialPtr Reader::read_blend(const xml::Node& node) {
  MaterialPtr material = make_node(node, MaterialNode::Kind::blend);
  if (!node.has("weight"))
    throw node.error(node.describe() + " needs a 'weight'",
                     "<float name=\"weight\" value=\"0.5\"/>: the share of the second bsdf");
  material->weight = read_color(node, "weight", {SpectrumUse::reflectance, true}, 0.5);
  material->children = read_nested_materials(node);
  finish(node, {"weight"});
  if (material->children.size() != 2)
    throw node.error(fmt::format("{} needs two nested bsdfs, not {}", node.describe(),
                                 material->children.size()));
  return material;
}

int Reader::material_number(const MaterialNode& material) {
  // A tree of shared nodes can have 2^depth paths: each node is looked at once.
  auto [known, is_new] = material_numbers_.try_emplace(&material, -1);
  if (!is_new)
    return known->second;
  std::string key;
  int kind = static_cast<int>(material.kind);
  append(key, &kind, 1);
  if (material.parameters) {
    const std::string& name = material.parameters->model().name();
    append(key, name.data(), name.size());
    std::string file = material.parameters->file_name();
    append(key, file.data(), file.size());
    append(key, material.parameters->slots().data(), material.parameters->slots().size());
    append(key, material.parameters->choices().data(), material.parameters->choices().size());
  }
  for (const auto& [name, texture] : material.textures) {
    append(key, name.data(), name.size());
    append(key, &texture, 1);
  }
  append(key, material.weight.value.data(), 3);
  append(key, &material.weight.texture, 1);
  for (const MaterialPtr& child : material.children) {
    int number = material_number(*child);
    append(key, &number, 1);
  }
  int next = static_cast<int>(material_keys_.size());
  int number = material_keys_.try_emplace(std::move(key), next).first->second;
  return material_numbers_[&material] = number;
}

int Reader::material_index(const MaterialPtr& material, const SourcePosition& where) {
  auto [found, is_new] = material_indices_.try_emplace(material_number(*material), -1);
  if (is_new)
    found->second = located(where, [&] { return scene_->add_material(material); });
  return found->second;
}

} // namespace faceta::mitsuba
