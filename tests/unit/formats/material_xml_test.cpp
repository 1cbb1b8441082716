// Materials to XML and back: the same numbers bit for bit, the same names.
#include "mitsuba_test_tools.h"

#include <cmath>

namespace faceta {
namespace {

Parameters exemplar_parameters(const Model& model, const Exemplar& exemplar) {
  Parameters p(model);
  for (const auto& [key, value] : exemplar.settings)
    p.set(key, value);
  p.check();
  return p;
}

void expect_same(const Parameters& a, const Parameters& b) {
  EXPECT_EQ(a.model().name(), b.model().name());
  EXPECT_EQ(a.slots(), b.slots());
  EXPECT_EQ(a.choices(), b.choices());
  for (const ParamInfo& p : a.descriptor().params) {
    EXPECT_EQ(a.was_set(p.name), b.was_set(p.name)) << p.name;
    if (p.kind == ParamKind::ior || p.kind == ParamKind::metal) {
      EXPECT_EQ(a.given_name(p.name), b.given_name(p.name));
    }
  }
}

TEST(MaterialXml, EveryModelAndExemplarComesBack) {
  size_t count = 0;
  for (const auto& model : Registry::global().models())
    for (const Exemplar& exemplar : model->descriptor.exemplars) {
      SCOPED_TRACE(model->name() + " / " + exemplar.name);
      Parameters given = exemplar_parameters(*model, exemplar);
      std::string text = write_material(given);
      auto back = parse_material(text);
      ASSERT_EQ(back->kind, MaterialNode::Kind::model);
      expect_same(given, *back->parameters);
      EXPECT_EQ(write_material(*back), text);
      ++count;
    }
  EXPECT_GT(count, 30u);
}

TEST(MaterialXml, EveryParameterComesBackWithAwkwardNumbers) {
  // Numbers without a short decimal, inside the range of each parameter.
  for (const auto& model : Registry::global().models()) {
    SCOPED_TRACE(model->name());
    Parameters given(*model);
    int k = 0;
    for (const ParamInfo& p : model->descriptor.params) {
      double high = std::isinf(p.hard.high) ? std::max(p.hard.low, 0.0) + 2 : p.hard.high;
      auto value = [&] {
        return p.hard.low + (high - p.hard.low) * (0.1 + 0.8 * std::fmod(++k * std::sqrt(2.0), 1));
      };
      if (p.reads_file)
        continue;
      if (p.kind == ParamKind::file)
        given.set(p.name, model->descriptor.exemplars[0].settings[0].second);
      else if (p.kind == ParamKind::reflectance || p.kind == ParamKind::spectrum)
        given.set_color(p.name, {value(), value(), value()});
      else if (p.choice >= 0)
        given.set(p.name, p.choices.back());
      else if (p.kind != ParamKind::metal && p.kind != ParamKind::roughness)
        given.set_number(p.name, value());
    }
    given.check();
    expect_same(given, *parse_material(write_material(given))->parameters);
  }
}

TEST(MaterialXml, NamesAreKept) {
  auto back = [](const char* model, const Settings& settings) {
    return write_material(make_parameters(model, settings));
  };
  EXPECT_EQ(back("roughconductor", {{"material", "Au"}, {"alpha", "0.3"}}),
            "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n\n<bsdf version=\"3.0.0\" "
            "type=\"roughconductor\">\n    <string name=\"material\" value=\"Au\"/>\n    <float "
            "name=\"alpha\" value=\"0.3\"/>\n</bsdf>\n");
  EXPECT_HAS(back("dielectric", {{"int_ior", "bk7"}, {"ext_ior", "1.1"}}),
             "<string name=\"int_ior\" value=\"bk7\"/>\n    <float name=\"ext_ior\" "
             "value=\"1.1\"/>");
  EXPECT_HAS(back("conductor", {{"material", "gold"}}), "value=\"gold\"");
  EXPECT_HAS(back("roughconductor", {{"sample_visible", "false"}, {"distribution", "ggx"}}),
             "<boolean name=\"sample_visible\" value=\"false\"/>");
}

TEST(MaterialXml, ColoursOutsideTheRangeComeBack) {
  Parameters p(Registry::global().get("diffuse"));
  p.set_number("reflectance", 1.5, {}, AboveRange::keep);
  expect_same(p, *parse_material(write_material(p))->parameters);
  p.set_color("reflectance", {1.5, 0.25, 0.1}, {}, AboveRange::keep);
  Scene scene;
  expect_same(p, *parse_material(write_material(p), "x", &scene)->parameters);
  expect_same(p, *parse_material(write_material(p))->parameters); // a spectrum needs no scene
}

TEST(MaterialXml, TreesComeBack) {
  auto tree = read_bsdf("type='blendbsdf'><float name='weight' value='0.3'/>"
                        "<bsdf type='mask'><float name='opacity' value='0.7'/>"
                        "<bsdf type='twosided'><bsdf type='diffuse'/><bsdf type='plastic'/></bsdf>"
                        "</bsdf><bsdf type='null'/>");
  std::string text = write_material(*tree);
  auto back = parse_material(text);
  EXPECT_EQ(back->kind, MaterialNode::Kind::blend);
  EXPECT_EQ(back->weight.value[0], 0.3);
  ASSERT_EQ(back->children.size(), 2u);
  EXPECT_EQ(back->children[0]->weight.value[0], 0.7);
  EXPECT_EQ(back->children[1]->kind, MaterialNode::Kind::null);
  EXPECT_EQ(back->children[0]->children[0]->children[1]->parameters->model().name(), "plastic");
  EXPECT_EQ(write_material(*back), text);
}

TEST(MaterialXml, AColouredWeightIsWrittenAsTheShareItIs) {
  auto tree = read_bsdf("type='mask'><float name='opacity' value='0.3'/><bsdf type='diffuse'/>");
  tree->weight.value = {0.9, 0.2, 0.1};
  auto back = parse_material(write_material(*tree));
  double share = 0.212671 * 0.9 + 0.715160 * 0.2 + 0.072169 * 0.1; // ITU-R BT.709
  for (double v : back->weight.value)
    EXPECT_NEAR(v, share, 1e-3);
}

TEST(MaterialXml, SharedChildrenAreWrittenOnce) {
  auto tree = read_bsdf("type='blendbsdf'><float name='weight' value='0.3'/>"
                        "<bsdf type='plastic' id='p'/><ref id='p'/>");
  EXPECT_EQ(tree->children[0], tree->children[1]);
  std::string text = write_material(*tree);
  EXPECT_HAS(text, "<ref id=");
  auto back = parse_material(text);
  EXPECT_EQ(back->children[0], back->children[1]);
}

TEST(MaterialXml, Textures) {
  auto scene = read_objects("<bsdf type='roughconductor' id='m'><texture type='checkerboard' "
                            "name='alpha'/></bsdf>");
  auto material = find_material(*scene, "m");
  EXPECT_HAS(xml::error_in([&] { write_material(*material); }),
             "the texture of 'alpha' cannot be written");
  auto checkerboard = [](int) {
    auto node = std::make_shared<xml::Node>();
    node->tag = "texture";
    node->type = "checkerboard";
    return node;
  };
  Scene other;
  auto back = parse_material(write_material(*material, checkerboard), "x", &other);
  EXPECT_EQ(back->textures, material->textures);
  EXPECT_EQ(back->parameters->slots(), material->parameters->slots());
}

TEST(MaterialXml, OneBsdfIsExpected) {
  EXPECT_HAS(xml::error_in([] { parse_material("<scene version='3.0.0'/>", "x.xml"); }),
             "x.xml:1:1: error: expected a <bsdf>, not a <scene>");
  EXPECT_HAS(xml::error_in([] { parse_material("", "x.xml"); }), "x.xml");
}

} // namespace
} // namespace faceta
