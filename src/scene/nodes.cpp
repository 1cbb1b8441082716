#include "scene/nodes.h"

namespace faceta {

namespace {

using Kind = MaterialNode::Kind;

/// Puts together the descriptor of a node.
SceneNode make_node(Kind kind, const char* name, const char* title, const char* equation,
                    std::vector<std::string> notes, const char* nested) {
  SceneNode node;
  node.kind = kind;
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
      Kind::twosided, "twosided", "One-sided material on both sides",
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
  node.exemplars = {{"gold", R"(<bsdf version="3.0.0" type="twosided">
  <bsdf type="roughconductor">
    <string name="material" value="Au"/>
    <float name="alpha_u" value="0.1"/>
    <float name="alpha_v" value="0.3"/>
  </bsdf>
</bsdf>
)"},
                    {"paint on copper", R"(<bsdf version="3.0.0" type="twosided">
  <bsdf type="roughplastic">
    <rgb name="diffuse_reflectance" value="0.2, 0.4, 0.1"/>
  </bsdf>
  <bsdf type="conductor">
    <string name="material" value="Cu"/>
  </bsdf>
</bsdf>
)"},
                    {"mixture inside", R"(<bsdf version="3.0.0" type="twosided">
  <bsdf type="blendbsdf">
    <float name="weight" value="0.35"/>
    <bsdf type="orennayar"/>
    <bsdf type="twosided">
      <bsdf type="phong"/>
    </bsdf>
  </bsdf>
</bsdf>
)"}};
  return node;
}

SceneNode make_mask() {
  SceneNode node = make_node(
      Kind::mask, "mask", "Material with holes",
      "f = opacity f_nested; straight on with 1 - opacity",
      {"Nest one bsdf.", "Of a colour the mean counts, of a colour texture the luminance.",
       "Light is not sampled through the holes: it shines through when a path happens "
       "to meet it."},
      "  <bsdf type=\"diffuse\"/>\n");
  node.descriptor.params = {share("opacity", "share of the nested bsdf; the rest is a hole")};
  node.exemplars = {{"leaf", R"(<bsdf version="3.0.0" type="mask">
  <float name="opacity" value="0.7"/>
  <bsdf type="twosided">
    <bsdf type="diffuse">
      <rgb name="reflectance" value="0.1, 0.5, 0.2"/>
    </bsdf>
  </bsdf>
</bsdf>
)"},
                    {"holes in frosted glass", R"(<bsdf version="3.0.0" type="mask">
  <float name="opacity" value="0.6"/>
  <bsdf type="roughdielectric">
    <float name="alpha" value="0.3"/>
  </bsdf>
</bsdf>
)"},
                    {"front only", R"(<bsdf version="3.0.0" type="mask">
  <bsdf type="plastic"/>
</bsdf>
)"}};
  return node;
}

SceneNode make_blend() {
  SceneNode node =
      make_node(Kind::blend, "blendbsdf", "Mixture of two materials",
                "f = (1 - weight) f_first + weight f_second",
                {"Nest two bsdfs; they may be blends themselves.",
                 "Of a colour the mean counts, of a colour texture the luminance."},
                "  <float name=\"weight\" value=\"0.5\"/>\n  <bsdf type=\"diffuse\"/>\n"
                "  <bsdf type=\"conductor\"/>\n");
  node.descriptor.params = {share("weight", "share of the second bsdf")};
  node.descriptor.params[0].defaults.clear();
  node.exemplars = {{"rust", R"(<bsdf version="3.0.0" type="blendbsdf">
  <float name="weight" value="0.3"/>
  <bsdf type="roughconductor">
    <string name="material" value="Cr"/>
    <float name="alpha" value="0.2"/>
  </bsdf>
  <bsdf type="diffuse">
    <rgb name="reflectance" value="0.4, 0.15, 0.05"/>
  </bsdf>
</bsdf>
)"},
                    {"dirty glass", R"(<bsdf version="3.0.0" type="blendbsdf">
  <float name="weight" value="0.2"/>
  <bsdf type="dielectric"/>
  <bsdf type="twosided">
    <bsdf type="diffuse"/>
  </bsdf>
</bsdf>
)"},
                    {"blend of blends", R"(<bsdf version="3.0.0" type="blendbsdf">
  <float name="weight" value="0.75"/>
  <bsdf type="blendbsdf">
    <float name="weight" value="0.4"/>
    <bsdf type="blinnphong"/>
    <bsdf type="null"/>
  </bsdf>
  <bsdf type="blendbsdf">
    <float name="weight" value="0.1"/>
    <bsdf type="roughdielectric">
      <float name="alpha" value="0.15"/>
    </bsdf>
    <bsdf type="twosided">
      <bsdf type="ward"/>
      <bsdf type="roughconductor"/>
    </bsdf>
  </bsdf>
</bsdf>
)"}};
  return node;
}

SceneNode make_null() {
  SceneNode node = make_node(
      Kind::null, "null", "No surface at all", "light goes straight on",
      {"It counts as a vertex of the path, and shadow rays do not pass it (see mask)."}, "");
  node.descriptor.traits.lobes = kNullLobe;
  node.descriptor.traits.delta = true;
  node.descriptor.traits.two_sided = true;
  node.exemplars = {{"nothing", "<bsdf version=\"3.0.0\" type=\"null\"/>\n"}};
  return node;
}

} // namespace

const std::vector<SceneNode>& scene_nodes() {
  static const std::vector<SceneNode> nodes = {make_twosided(), make_mask(), make_blend(),
                                               make_null()};
  return nodes;
}

const SceneNode* find_scene_node(const std::string& name) {
  for (const SceneNode& node : scene_nodes())
    if (node.descriptor.name == name)
      return &node;
  return nullptr;
}

const SceneNode& scene_node(Kind kind) {
  for (const SceneNode& node : scene_nodes())
    if (node.kind == kind)
      return node;
  throw Error("a model is no node of scene files");
}

} // namespace faceta
