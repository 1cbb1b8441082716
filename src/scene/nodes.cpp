#include "formats/material_docs.h"

namespace faceta {

namespace {

/// Puts together the descriptor of a node.
SceneNode make_node(const char* name, const char* title, const char* equation,
                    std::vector<std::string> notes, const char* nested) {
  SceneNode node;
  node.descriptor.name = name;
  node.descriptor.title = title;
  node.descriptor.equation = equation;
  node.descriptor.notes = std::move(notes);
  node.descriptor.traits.lobes = 0;
  node.nested = nested;
  return node;
}

/// A number in [0, 1], or a texture.
ParamInfo share(const char* name, const char* doc) {
  ParamInfo p;
  p.name = name;
  p.doc = doc;
  p.slot = 0;
  p.slots = 1;
  p.defaults = {0.5};
  p.hard = p.soft = {0, 1};
  p.textured = true;
  return p;
}

SceneNode make_twosided() {
  SceneNode node = make_node(
      "twosided", "One-sided material on both sides",
      "f(wo, wi) = f_front(wo, wi) above the surface, f_back(mirrored wo, mirrored wi) below",
      {"Nest one bsdf for both sides, or two: front, back.",
       "Bsdfs that transmit light, and mask and null, cannot be inside; put the twosided inside "
       "the mask."},
      "  <bsdf type=\"diffuse\"/>\n");
  ParamInfo p;
  p.name = "allow_transmission";
  p.doc = "true is not supported yet and ends in an error";
  p.kind = ParamKind::flag;
  p.choices = {"false", "true"};
  p.defaults = {0};
  p.choice = 0;
  node.descriptor.params = {p};
  return node;
}

SceneNode make_mask() {
  SceneNode node =
      make_node("mask", "Material with holes", "f = opacity f_nested; straight on with 1 - opacity",
                {"Nest one bsdf.", "Of a colour or colour texture the mean counts.",
                 "Light is not sampled through the holes: it shines through when a path happens "
                 "to meet it."},
                "  <bsdf type=\"diffuse\"/>\n");
  node.descriptor.params = {share("opacity", "share of the nested bsdf; the rest is a hole")};
  return node;
}

SceneNode make_blend() {
  SceneNode node = make_node(
      "blendbsdf", "Mixture of two materials", "f = (1 - weight) f_first + weight f_second",
      {"Nest two bsdfs; they may be blends themselves.",
       "Of a colour or colour texture the mean counts."},
      "  <float name=\"weight\" value=\"0.5\"/>\n  <bsdf type=\"diffuse\"/>\n"
      "  <bsdf type=\"conductor\"/>\n");
  node.descriptor.params = {share("weight", "share of the second bsdf")};
  node.descriptor.params[0].defaults.clear();
  return node;
}

SceneNode make_null() {
  SceneNode node = make_node(
      "null", "No surface at all", "light goes straight on",
      {"It counts as a vertex of the path, and shadow rays do not pass it (see mask)."}, "");
  node.descriptor.traits.lobes = kNullLobe;
  node.descriptor.traits.delta = true;
  node.descriptor.traits.two_sided = true;
  return node;
}

} // namespace

const std::vector<SceneNode>& scene_nodes() {
  static const std::vector<SceneNode> nodes = {make_twosided(), make_mask(), make_blend(),
                                               make_null()};
  return nodes;
}

const Descriptor* find_scene_node(const std::string& name) {
  for (const SceneNode& node : scene_nodes())
    if (node.descriptor.name == name)
      return &node.descriptor;
  return nullptr;
}

const Descriptor& material_descriptor(const Registry& registry, const std::string& name) {
  if (const Descriptor* node = find_scene_node(name))
    return *node;
  if (const Model* model = registry.find(name))
    return model->descriptor;
  std::vector<std::string> names = registry.names();
  for (const SceneNode& node : scene_nodes())
    names.push_back(node.descriptor.name);
  throw Error("unknown material '" + name + "'", {}, suggestion(name, names));
}

} // namespace faceta
