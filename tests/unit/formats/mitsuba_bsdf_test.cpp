// Materials of scene files. What is accepted and refused, and every number called Mitsuba's, was
// read off Mitsuba 3.9.1 (scalar_rgb, mi.traverse() of the loaded scene).
#include "mitsuba_test_tools.h"

namespace faceta {
namespace {

std::vector<double> reflectance(const std::string& property) {
  return numbers(*read_bsdf("type='diffuse'>" + property), "reflectance");
}

TEST(MitsubaBsdf, ReflectanceInEveryWayOfWritingIt) {
  EXPECT_EQ(reflectance(""), (std::vector<double>{0.5, 0.5, 0.5}));
  EXPECT_EQ(reflectance("<float name='reflectance' value='.3'/>"),
            (std::vector<double>{0.3, 0.3, 0.3}));
  EXPECT_EQ(reflectance("<integer name='reflectance' value='1'/>"), (std::vector<double>{1, 1, 1}));
  EXPECT_EQ(reflectance("<rgb name='reflectance' value='.1,.2,.3'/>"),
            (std::vector<double>{0.1, 0.2, 0.3}));
  EXPECT_EQ(reflectance("<spectrum name='reflectance' value='.3'/>"),
            (std::vector<double>{0.3, 0.3, 0.3}));
  // Mitsuba's numbers: pairs lit by D65, clamped to 1
  expect_near(
      reflectance("<spectrum name='reflectance' value='400:0.1, 500:0.3, 600:0.7, 700:0.2'/>"),
      {0.682387113571167, 0.478298544883728, 0.16887059807777405});
  expect_near(reflectance("<spectrum name='reflectance' value='400:0.1, 700:3'/>"),
              {1.0, 1.0, 0.49401286244392395});
  xml::TemporaryFolder folder;
  std::string file = folder.write("r.spd", "# data\n400 0.1\n500 0.3\n600 0.7\n700 0.2\n").string();
  expect_near(reflectance("<spectrum name='reflectance' filename='" + file + "'/>"),
              {0.682387113571167, 0.478298544883728, 0.16887059807777405});
}

TEST(MitsubaBsdf, ReflectanceAsPluginsOfSpectra) {
  auto read = [](const std::string& spectrum) {
    return reflectance("<spectrum name='reflectance' " + spectrum + "</spectrum>");
  };
  EXPECT_EQ(read("type='uniform'><float name='value' value='.3'/>"),
            (std::vector<double>{0.3, 0.3, 0.3}));
  EXPECT_EQ(read("type='srgb'><rgb name='color' value='.3,.2,.1'/>"),
            (std::vector<double>{0.3, 0.2, 0.1}));
  EXPECT_EQ(read("type='srgb'><rgb name='color' value='3,.2,.1'/>"
                 "<boolean name='unbounded' value='true'/>"),
            (std::vector<double>{3, 0.2, 0.1}));
  EXPECT_EQ(read("type='d65'><float name='scale' value='.3'/>"),
            (std::vector<double>{0.3, 0.3, 0.3}));
  EXPECT_EQ(read("type='rawconstant'><vector name='value' value='.3,.2,.1'/>"),
            (std::vector<double>{0.3, 0.2, 0.1}));
  // Mitsuba cannot evaluate these two in RGB: they mean what pairs mean
  auto pairs = reflectance("<spectrum name='reflectance' value='400:.1,500:.3,600:.7,700:.2'/>");
  EXPECT_EQ(read("type='irregular'><string name='wavelengths' value='400 500 600 700'/>"
                 "<string name='values' value='.1,.3,.7,.2'/>"),
            pairs);
  EXPECT_EQ(read("type='regular'><float name='wavelength_min' value='400'/>"
                 "<float name='wavelength_max' value='700'/>"
                 "<string name='values' value='.1,.3,.7,.2'/>"),
            pairs);
}

TEST(MitsubaBsdf, NumbersAboveTheRangeAreKeptButNotRgb) {
  // As the scene contract has it.
  EXPECT_EQ(reflectance("<float name='reflectance' value='1.5'/>")[0], 1.5);
  EXPECT_EQ(reflectance("<spectrum name='reflectance' value='1.5'/>")[0], 1.5);
  auto rough = [](const std::string& alpha) {
    return numbers(*read_bsdf("type='roughconductor'>" + alpha), "alpha");
  };
  EXPECT_EQ(rough("<float name='alpha' value='3'/>"), (std::vector<double>{3, 3}));
  EXPECT_EQ(rough("<float name='alpha' value='-1'/>"), (std::vector<double>{0, 0}));
  EXPECT_EQ(rough("<integer name='alpha' value='1'/>"), (std::vector<double>{1, 1}));
  EXPECT_EQ(read_bsdf("type='mask'><float name='opacity' value='1.5'/><bsdf type='diffuse'/>")
                ->weight.value[0],
            1.5);
  EXPECT_EQ(bsdf_error("type='diffuse'><rgb name='reflectance' value='0.5, 1.5, 0.5'/>"),
            "s.xml:1:52: error: 'reflectance' of bsdf of type 'diffuse' (id 'm'): the rgb colour "
            "0.5, 1.5, 0.5 is no reflectance: components must lie between 0 and 1");
  EXPECT_HAS(bsdf_error("type='diffuse'><spectrum type='srgb' name='reflectance'>"
                        "<rgb name='color' value='3,.2,.1'/></spectrum>"),
             "s.xml:1:93: error: 'color' of spectrum of type 'srgb': the rgb colour 3, 0.2, 0.1");
  // Mitsuba takes these as they are
  EXPECT_HAS(bsdf_error("type='diffuse'><float name='reflectance' value='-1'/>"),
             "'reflectance' of bsdf of type 'diffuse' (id 'm') is -1, but must be finite and not "
             "negative");
  EXPECT_HAS(bsdf_error("type='diffuse'><float name='reflectance' value='nan'/>"), "is nan");
  EXPECT_HAS(bsdf_error("type='roughconductor'><float name='alpha' value='inf'/>"), "alpha");
}

TEST(MitsubaBsdf, WrongTypes) {
  EXPECT_EQ(bsdf_error("type='diffuse'><vector name='reflectance' value='.1,.2,.3'/>"),
            "s.xml:1:52: error: 'reflectance' of bsdf of type 'diffuse' (id 'm') must be a float, "
            "rgb, spectrum or texture, not of type vector");
  EXPECT_HAS(bsdf_error("type='diffuse'><string name='reflectance' value='.1'/>"),
             "not of type string");
  EXPECT_HAS(bsdf_error("type='diffuse'><bsdf type='null' name='reflectance'/>"),
             "must be a texture, not a bsdf");
  EXPECT_HAS(bsdf_error("type='roughconductor'><string name='sample_visible' value='true'/>"),
             "property 'sample_visible' of bsdf of type 'roughconductor' (id 'm') must be a "
             "boolean, not a string");
  EXPECT_HAS(bsdf_error("type='roughplastic'><rgb name='alpha' value='1'/>"), "must be a float");
  EXPECT_HAS(bsdf_error("type='roughplastic'><texture type='checkerboard' name='alpha'/>"),
             "must be a float, not a nested object");
  EXPECT_HAS(bsdf_error("type='dielectric'><texture type='checkerboard' name='int_ior'/>"),
             "must be a float or the name of a material, not of type object");
}

TEST(MitsubaBsdf, IndicesOfRefraction) {
  auto ratio = [](const std::string& text) {
    auto m = read_bsdf(text);
    return numbers(*m, "int_ior")[0] / numbers(*m, "ext_ior")[0];
  };
  // Mitsuba's eta
  EXPECT_NEAR(ratio("type='dielectric'>"), 1.504183292388916, 1e-7);
  EXPECT_NEAR(ratio("type='plastic'>"), 1.4895873069763184, 1e-7);
  EXPECT_NEAR(ratio("type='thindielectric'>"), 1.504183292388916, 1e-7);
  EXPECT_NEAR(ratio("type='dielectric'><string name='int_ior' value='WATER'/>"), 1.3326307535171509,
              2e-7);
  EXPECT_NEAR(ratio("type='roughdielectric'><string name='int_ior' value='diamond'/>"),
              2.418329954147339, 2e-7);
  EXPECT_NEAR(ratio("type='roughplastic'><float name='int_ior' value='1.9'/>"
                    "<string name='ext_ior' value='Water'/>"),
              1.425356388092041, 1e-7);
  EXPECT_EQ(bsdf_error("type='dielectric'><integer name='int_ior' value='2'/>"),
            "s.xml:1:55: error: 'int_ior' of bsdf of type 'dielectric' (id 'm') must be a float "
            "or the name of a material, not of type integer");
  EXPECT_EQ(bsdf_error("type='dielectric'><string name='int_ior' value='1.5'/>"),
            "s.xml:1:55: error: 'int_ior' of bsdf of type 'dielectric' (id 'm') is a number in a "
            "string (<float name=\"int_ior\" value=\"1.5\"/>)");
  EXPECT_HAS(bsdf_error("type='dielectric'><float name='int_ior' value='-1.5'/>"),
             "s.xml:1:55: error: parameter 'int_ior' of 'dielectric' is -1.5");
  EXPECT_HAS(bsdf_error("type='dielectric'><string name='int_ior' value='watr'/>"),
             "s.xml:1:55: error: unknown dielectric 'watr' (did you mean 'water'?");
}

TEST(MitsubaBsdf, Metals) {
  auto gold = read_bsdf("type='conductor'><string name='material' value='Au'/>");
  expect_near(numbers(*gold, "eta"), {0.143036, 0.375307, 1.44205}, 5e-6); // Mitsuba's
  expect_near(numbers(*gold, "k"), {3.983, 2.38556, 1.60336}, 5e-6);
  auto carbon = read_bsdf("type='roughconductor'><string name='material' value='a-C'/>");
  expect_near(numbers(*carbon, "eta"), {2.9440457820892334, 2.2271363735198975, 1.968161702156067});
  expect_near(numbers(*carbon, "k"), {0.8874648809432983, 0.7992985248565674, 0.8152899742126465});
  auto pairs = read_bsdf("type='conductor'><spectrum name='eta' value='400:0.1, 500:3, 600:7, "
                         "700:2'/><spectrum name='k' value='3.5'/>");
  expect_near(numbers(*pairs, "eta"), {6.798280715942383, 4.8176727294921875, 1.2249153852462769});
  EXPECT_EQ(numbers(*pairs, "k"), (std::vector<double>{3.5, 3.5, 3.5}));
  // eta or k alone: the other is the mirror's, as in Mitsuba
  EXPECT_EQ(numbers(*read_bsdf("type='conductor'><rgb name='eta' value='1,2,3'/>"), "k"),
            (std::vector<double>{1, 1, 1}));
  EXPECT_EQ(numbers(*read_bsdf("type='conductor'><float name='k' value='2'/>"), "eta"),
            (std::vector<double>{0, 0, 0}));
  auto none = read_bsdf("type='conductor'><string name='material' value='none'/>"
                        "<float name='eta' value='2'/><float name='k' value='3'/>");
  EXPECT_EQ(numbers(*none, "eta")[0], 2);
  EXPECT_HAS(bsdf_error("type='conductor'><string name='material' value='Au'/>"
                        "<float name='eta' value='1'/><float name='k' value='1'/>"),
             "exclude each other");
  EXPECT_HAS(bsdf_error("type='conductor'><string name='material' value='au'/>"),
             "s.xml:1:54: error: unknown metal 'au' (did you mean 'Au'?");
}

TEST(MitsubaBsdf, Roughness) {
  auto copper = read_bsdf("type='roughconductor'><string name='material' value='Cu'/>"
                          "<float name='alpha_u' value='.05'/><float name='alpha_v' value='.3'/>"
                          "<string name='distribution' value='GGX'/>");
  EXPECT_EQ(numbers(*copper, "alpha"), (std::vector<double>{0.05, 0.3}));
  EXPECT_EQ(copper->parameters->text("distribution"), "ggx"); // words in any case, as in Mitsuba
  EXPECT_EQ(copper->parameters->text("sample_visible"), "true");
  EXPECT_EQ(numbers(*read_bsdf("type='roughdielectric'>"), "alpha"),
            (std::vector<double>{0.1, 0.1}));
  // A colour for a number: Mitsuba's eval_1 of it is its mean
  auto alpha = [](const std::string& property) {
    return numbers(*read_bsdf("type='roughconductor'>" + property), "alpha")[0];
  };
  EXPECT_NEAR(alpha("<rgb name='alpha' value='.1,.2,.3'/>"), 0.2, 1e-15);
  EXPECT_NEAR(alpha("<spectrum name='alpha' value='.1'/>"), 0.1, 1e-15);
  EXPECT_NEAR(alpha("<spectrum name='alpha' value='400:.1,700:.2'/>"),
              (0.179949 + 0.147621 + 0.113095) / 3, 1e-6);
  EXPECT_HAS(bsdf_error("type='roughconductor'><float name='alpha' value='.1'/>"
                        "<float name='alpha_u' value='.1'/><float name='alpha_v' value='.1'/>"),
             "s.xml:1:24: error: 'alpha' and 'alpha_u' of 'roughconductor' exclude each other");
  EXPECT_HAS(bsdf_error("type='roughconductor'><float name='alpha_u' value='.1'/>"),
             "must be given together (missing: alpha_v)");
  EXPECT_HAS(bsdf_error("type='roughconductor'><string name='distribution' value='phong'/>"),
             "s.xml:1:59: error: parameter 'distribution' of 'roughconductor' cannot be 'phong'");
}

TEST(MitsubaBsdf, ModelsOfOurOwn) {
  auto m = read_bsdf("type='orennayar'><string name='model' value='eon'/>"
                     "<float name='sigma' value='.4'/><rgb name='reflectance' value='.1,.2,.3'/>");
  EXPECT_EQ(m->parameters->text("model"), "eon");
  EXPECT_EQ(numbers(*m, "sigma"), std::vector<double>{0.4});
  EXPECT_EQ(numbers(*read_bsdf("type='phong'><float name='exponent' value='12'/>"), "exponent"),
            std::vector<double>{12});
  EXPECT_EQ(read_bsdf("type='ward'><string name='variant' value='ward-duer'/>")
                ->parameters->text("variant"),
            "ward-duer");
  for (const std::string& name : Registry::global().names()) {
    const Model& model = Registry::global().get(name);
    const ParamInfo* file = model.descriptor.file();
    std::string setting = file ? "<string name='" + file->name + "' value='" +
                                     model.descriptor.exemplars[0].settings[0].second + "'/>"
                               : "";
    auto plain = read_bsdf("type='" + name + "'>" + setting);
    EXPECT_EQ(plain->parameters->slots(), Parameters(model).slots());
  }
}

TEST(MitsubaBsdf, TextureParametersCarryTheirMean) {
  auto m = read_bsdf("type='roughconductor'>"
                     "<texture type='checkerboard' name='alpha_u'/>"
                     "<float name='alpha_v' value='.2'/>"
                     "<texture type='checkerboard' name='specular_reflectance'>"
                     "<rgb name='color0' value='.1,.2,.3'/></texture>");
  ASSERT_EQ(m->textures.size(), 2u);
  EXPECT_EQ(m->textures[0].first, "specular_reflectance");
  EXPECT_EQ(m->textures[1].first, "alpha_u");
  EXPECT_NE(m->textures[0].second, m->textures[1].second);
  EXPECT_NEAR(numbers(*m, "alpha_u")[0], 0.3, 1e-15);
  expect_near(numbers(*m, "specular_reflectance"), {0.15, 0.2, 0.25}, 1e-15);
}

TEST(MitsubaBsdf, Mask) {
  auto mask = [](const std::string& text) { return read_bsdf("type='mask'>" + text); };
  auto plain = mask("<bsdf type='diffuse'/>");
  EXPECT_EQ(plain->kind, MaterialNode::Kind::mask);
  EXPECT_EQ(plain->weight.value[0], 0.5);
  ASSERT_EQ(plain->children.size(), 1u);
  EXPECT_EQ(plain->children[0]->kind, MaterialNode::Kind::model);
  EXPECT_NEAR(mask("<rgb name='opacity' value='.5,.2,.1'/><bsdf type='diffuse'/>")->weight.value[0],
              0.8 / 3, 1e-15); // the mean: Mitsuba's eval_1
  EXPECT_GE(
      mask("<texture name='opacity' type='checkerboard'/><bsdf type='null'/>")->weight.texture, 0);
  EXPECT_EQ(bsdf_error("type='mask'>"), "s.xml:1:24: error: bsdf of type 'mask' (id 'm') needs one "
                                        "nested bsdf, not 0");
  EXPECT_HAS(bsdf_error("type='mask'><bsdf type='null'/><bsdf type='null'/>"),
             "one nested bsdf, not 2");
}

TEST(MitsubaBsdf, Blend) {
  auto m = read_bsdf("type='blendbsdf'><float name='weight' value='.2'/>"
                     "<bsdf type='diffuse' name='z'/><bsdf type='plastic' name='a'/>");
  EXPECT_EQ(m->kind, MaterialNode::Kind::blend);
  EXPECT_EQ(m->weight.value[1], 0.2);
  EXPECT_EQ(m->children[0]->parameters->model().name(), "diffuse"); // by appearance, not by name
  EXPECT_EQ(m->children[1]->parameters->model().name(), "plastic");
  EXPECT_HAS(bsdf_error("type='blendbsdf'><bsdf type='diffuse'/><bsdf type='diffuse'/>"),
             "needs a 'weight'");
  EXPECT_HAS(bsdf_error("type='blendbsdf'><float name='weight' value='1'/><bsdf type='diffuse'/>"),
             "needs two nested bsdfs, not 1");
}

TEST(MitsubaBsdf, TwosidedAndNull) {
  auto m = read_bsdf("type='twosided'><bsdf type='diffuse'/><bsdf type='plastic'/>");
  EXPECT_EQ(m->kind, MaterialNode::Kind::twosided);
  EXPECT_EQ(m->children.size(), 2u);
  EXPECT_EQ(read_bsdf("type='null'>")->kind, MaterialNode::Kind::null);
  EXPECT_HAS(bsdf_error("type='null'><float name='a' value='1'/>"),
             "s.xml:1:49: error: unexpected property 'a' in bsdf of type 'null' (id 'm')");
  EXPECT_HAS(bsdf_error("type='twosided'>"), "needs one or two nested bsdfs, not 0");
  EXPECT_HAS(bsdf_error("type='twosided'><boolean name='allow_transmission' value='true'/>"
                        "<bsdf type='dielectric'/>"),
             "'allow_transmission' of bsdf 'twosided' is not supported yet");
  for (const char* inside : {"dielectric", "null", "mask"}) {
    std::string child = std::string("<bsdf type='") + inside + "'>" +
                        (std::string(inside) == "mask" ? "<bsdf type='diffuse'/>" : "") + "</bsdf>";
    EXPECT_HAS(
        objects_error("<shape type='sphere'><bsdf type='twosided'>" + child + "</bsdf></shape>"),
        "twosided");
  }
}

TEST(MitsubaBsdf, WhatNobodyKnows) {
  EXPECT_EQ(bsdf_error("type='diffuse'><float name='reflectence' value='1'/>"),
            "s.xml:1:52: error: unexpected property 'reflectence' in bsdf of type 'diffuse' (id "
            "'m') (did you mean 'reflectance'? known: reflectance)");
  EXPECT_HAS(bsdf_error("type='diffuse'><texture type='checkerboard'/>"),
             "unexpected texture of type 'checkerboard' in bsdf of type 'diffuse'");
  EXPECT_HAS(bsdf_error("type='diffuse'><bsdf type='diffuse'/>"),
             "unexpected bsdf of type 'diffuse' in bsdf");
  EXPECT_HAS(bsdf_error("type='difuse'>"),
             "s.xml:1:24: error: unknown bsdf 'difuse' (did you mean 'diffuse'? known: ");
  EXPECT_EQ(bsdf_error("type='hair'>")
                .find("s.xml:1:24: error: bsdf 'hair' is not supported yet "
                      "(supported: diffuse, "),
            0u);
  std::vector<std::string> warnings;
  ReadOptions options;
  options.permissive = true;
  options.warn = [&](const std::string& text) { warnings.push_back(text); };
  read_objects("<bsdf type='diffuse'><float name='reflectence' value='1'/></bsdf>", options);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_HAS(warnings[0], "s.xml:1:45: warning: unexpected property 'reflectence'");
}

} // namespace
} // namespace faceta
