// Whole scenes: what belongs at the top, plugins that are not there yet, ids, real files, damaged
// files. What is accepted and refused was read off Mitsuba 3.9.1.
#include "mitsuba_test_tools.h"

#include <random>

namespace faceta {
namespace {

TEST(MitsubaScene, NeedsSensorAndIntegrator) {
  EXPECT_EQ(xml::error_in([] { read_text("<integrator type='path'/>"); }),
            "s.xml:1:1: error: the scene has no sensor (<sensor type=\"perspective\">)");
  EXPECT_EQ(xml::error_in([] { read_text("<sensor type='perspective'/>"); }),
            "s.xml:1:1: error: the scene has no integrator (<integrator type=\"path\"/>)");
  EXPECT_EQ(objects_error("<integrator type='direct'/>"),
            "s.xml:1:51: error: the scene has more than one integrator");
  EXPECT_HAS(xml::error_in([] {
               read_mitsuba_scene_string("<bsdf version='3.0.0' type='diffuse'/>", "b.xml");
             }),
             "b.xml:1:1: error: a scene file must hold a <scene>, not a <bsdf>");
}

TEST(MitsubaScene, WhatElseMayStandAtTheTop) {
  std::vector<std::string> warnings;
  ReadOptions options;
  options.warn = [&](const std::string& text) { warnings.push_back(text); };
  read_objects("<film type='hdrfilm'/><rfilter type='box'/><sampler type='sobol'/>"
               "<texture type='checkerboard'/><spectrum type='uniform'><float name='value' "
               "value='1'/></spectrum><boolean name='embree_use_robust_intersections' "
               "value='true'/>",
               options);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_HAS(warnings[0], "'embree_use_robust_intersections' has no effect here");
  EXPECT_HAS(objects_error("<float name='a' value='1'/>"), "unexpected property 'a' in the scene");
  // and what stands there is checked like everything else
  EXPECT_HAS(objects_error("<film type='hdrfilm'><float name='a' value='1'/></film>"),
             "unexpected property 'a'");
}

TEST(MitsubaScene, EveryPluginOfTheContractIsReadOrNamed) {
  // Plugins of the scene contract that this version does not read: tag and names.
  const std::vector<std::pair<std::string, std::vector<std::string>>> missing = {
      {"bsdf",
       {"pplastic", "principled", "principledthin", "hair", "normalmap", "bumpmap", "polarizer",
        "retarder", "circular"}},
      {"texture", {"mesh_attribute", "volume"}},
      {"spectrum", {"blackbody"}},
      {"shape",
       {"serialized", "bsplinecurve", "linearcurve", "sdfgrid", "shapegroup", "instance", "merge",
        "ellipsoids", "ellipsoidsmesh"}},
      {"emitter",
       {"spot", "directional", "directionalarea", "projector", "sunsky", "timed_sunsky"}},
      {"sensor",
       {"thinlens", "orthographic", "radiancemeter", "irradiancemeter", "distant", "batch"}},
      {"film", {"specfilm"}},
      {"rfilter", {"mitchell", "catmullrom", "lanczos"}},
      {"sampler", {"stratified", "multijitter", "orthogonal", "ldsampler"}},
      {"integrator",
       {"volpath", "volpathmis", "ptracer", "depth", "aov", "stokes", "prb", "prb_basic",
        "prbvolpath", "direct_projective", "prb_projective", "volprim_rf_basic"}},
      {"medium", {"homogeneous", "heterogeneous"}},
      {"phase", {"isotropic", "hg", "rayleigh", "sggx", "tabphase", "blendphase"}},
      {"volume", {"constvolume", "gridvolume"}}};
  for (const auto& [tag, names] : missing)
    for (const std::string& name : names) {
      std::string error = xml::error_in(
          [&] { read_text("<" + tag + " type='" + name + "'/><sensor type='perspective'/>"); });
      EXPECT_EQ(error.find("s.xml:1:24: error: " + tag + " '" + name + "' is not supported yet"),
                0u)
          << error;
    }
  for (const char* tag : {"bsdf", "texture", "shape", "emitter", "sensor", "film", "rfilter",
                          "sampler", "integrator"})
    EXPECT_HAS(xml::error_in([&] { read_text(std::string("<") + tag + " type='pathh'/>"); }),
               std::string("s.xml:1:24: error: unknown ") + tag + " 'pathh' (");
}

TEST(MitsubaScene, MaterialsById) {
  auto scene = read_objects("<bsdf type='twosided' id='outer'><bsdf type='plastic' id='inner'/>"
                            "</bsdf><shape type='sphere'><bsdf type='diffuse' id='ball'/></shape>"
                            "<shape type='cube'><ref id='outer'/></shape>");
  EXPECT_EQ(find_material(*scene, "inner")->parameters->model().name(), "plastic");
  EXPECT_EQ(find_material(*scene, "ball")->parameters->model().name(), "diffuse");
  EXPECT_EQ(find_material(*scene, "outer")->children.at(0), find_material(*scene, "inner"));
  EXPECT_EQ(scene->named_materials.size(), 3u);
  EXPECT_HAS(xml::error_in([&] { find_material(*scene, "bal"); }),
             "the scene has no bsdf with the id 'bal' (did you mean 'ball'?");
}

TEST(MitsubaScene, OneMaterialOfAFile) {
  xml::TemporaryFolder folder;
  auto file =
      folder.write("s.xml", "<scene version='3.0.0'><default name='a' value='.2'/><shape "
                            "type='sphere'><bsdf type='twosided'><bsdf type='roughconductor' "
                            "id='m'><texture type='checkerboard' name='alpha'/></bsdf></bsdf>"
                            "</shape><bsdf type='hair' id='h'/><shape type='obj'/><bsdf id='d' "
                            "type='diffuse'><float name='reflectance' value='$a'/></bsdf></scene>");
  Scene scene;
  EXPECT_EQ(read_mitsuba_material(file, "m", scene)->textures.size(), 1u);
  EXPECT_NEAR(scene.texture_mean(0)[0], 0.3, 1e-12);
  ReadOptions options;
  options.defines = {{"a", "0.25"}};
  EXPECT_EQ(numbers(*read_mitsuba_material(file, "d", scene, options), "reflectance")[0], 0.25);
  EXPECT_HAS(xml::error_in([&] { read_mitsuba_material(file, "h", scene); }),
             "bsdf 'hair' is not supported yet");
  EXPECT_HAS(xml::error_in([&] { read_mitsuba_material(file, "x", scene); }),
             "no bsdf with the id 'x' (");
}

TEST(MitsubaScene, EqualMaterialsAreOne) {
  auto scene = read_objects(
      "<bsdf type='diffuse' id='a'/><shape type='sphere'><ref id='a'/></shape>"
      "<shape type='sphere'><bsdf type='diffuse'><rgb name='reflectance' value='.5'/></bsdf>"
      "</shape><shape type='sphere'/><shape type='sphere'><bsdf type='diffuse'>"
      "<float name='reflectance' value='.6'/></bsdf></shape><shape type='sphere'>"
      "<bsdf type='twosided'><bsdf type='diffuse'/></bsdf></shape><shape type='sphere'>"
      "<bsdf type='mask'><bsdf type='diffuse'/></bsdf></shape><shape type='sphere'>"
      "<bsdf type='mask'><float name='opacity' value='.25'/><bsdf type='diffuse'/></bsdf></shape>");
  scene->build(Isa::scalar);
  EXPECT_EQ(scene->statistics().materials, 5u);
}

TEST(MitsubaScene, SharedNodesDoNotMultiply) {
  // 2^60 leaves in 60 lines.
  std::string text = "<bsdf type='diffuse' id='b0'/>";
  for (int i = 1; i <= 60; ++i) {
    std::string below = "<ref id='b" + std::to_string(i - 1) + "'/>";
    text += "<bsdf type='blendbsdf' id='b" + std::to_string(i) +
            "'><float name='weight' value='.5'/>" + below + below + "</bsdf>";
  }
  read_objects(text);
  EXPECT_HAS(objects_error(text + "<shape type='sphere'><ref id='b20'/></shape>"),
             "more than 64 leaves");
  EXPECT_HAS(objects_error(text + "<shape type='sphere'><ref id='b60'/></shape>"), "s.xml:1:");
  EXPECT_NE(write_material(*find_material(*read_objects(text), "b60")), "");
}

struct Scenes : testing::Test {
  std::filesystem::path data = FACETA_SHARED_DATA;
  void SetUp() override {
    if (!shared_data_is_here())
      GTEST_SKIP() << "the shared data are not here";
  }
  /// "" or the Error's text, the folder of the data left out.
  std::string outcome(const std::string& file, ReadOptions options = {}) {
    try {
      read_mitsuba_scene(data / file, options);
      return {};
    } catch (const Error& error) {
      std::string text = error.what();
      size_t at = text.find(data.string());
      return at == text.npos ? text : text.erase(at, data.string().size() + 1);
    }
  }
};

TEST_F(Scenes, ThoseInScopeLoad) {
  // The small ones here; the large ones are rendered by the scene tests.
  for (const char* file :
       {"scenes/rgl-cornell-box/scene_ref320.xml", "scenes/rgl-veach-mis/scene_ref320.xml",
        "scenes/rgl-veach-bidir/scene_ref320.xml",
        "scenes/bitterli06-cbox-spheres/scene_ref320.xml",
        "scenes/bitterli06-staircase2/scene_ref320.xml",
        "mitsuba-data/tests/scenes/bsdf_spheres/test_textured_roughconductor_path.xml",
        "mitsuba-data/tests/scenes/bsdf_spheres/test_roughdielectric_path.xml",
        "mitsuba-data/tests/scenes/texture_interp/test_texture_interp_direct.xml",
        "mitsuba-data/scenes/cbox/cbox-rgb.xml", "mitsuba-data/scenes/cbox/cbox-spectral.xml"})
    EXPECT_EQ(outcome(file), "") << file;
}

TEST_F(Scenes, ThoseOutOfScopeNameWhatIsMissing) {
  const std::string tests = "mitsuba-data/tests/scenes/";
  const std::vector<std::array<std::string, 2>> expected = {
      {"scenes/rgl-torus/scene_ref320.xml", ":72:2: error: shape 'serialized'"},
      {"scenes/hairblock/scene_ref320.xml", ":11:3: error: shape 'bsplinecurve'"},
      {"scenes/restir-tire/scene_ref320.xml", ":38:3: error: bsdf 'principled'"},
      {tests + "bsdf_spheres/test_bumpmap_path.xml", ":7:9: error: bsdf 'bumpmap'"},
      {tests + "floating_sphere/test_directional_direct.xml", ":7:5: error: emitter 'directional'"},
      {tests + "instancing/test_instancing_path.xml", ":41:5: error: shape 'shapegroup'"},
      {tests + "orthographic_sensor/test_orthographic_path.xml",
       ":12:5: error: sensor 'orthographic'"},
      {tests + "spot_light/test_spot_direct.xml", ":11:5: error: emitter 'spot'"}};
  for (const auto& [file, error] : expected)
    EXPECT_EQ(outcome(file).find(file + error + " is not supported yet"), 0u) << outcome(file);
}

TEST_F(Scenes, DefinesReachThePlugins) {
  ReadOptions options;
  options.defines = {{"spp", "7"}, {"integrator", "direct"}};
  auto scene = read_mitsuba_scene(
      data / "mitsuba-data/tests/scenes/texture_interp/test_texture_interp_direct.xml", options);
  EXPECT_EQ(scene->sensors.at(0).sampler.sample_count, 7);
  EXPECT_EQ(scene->integrator.type, "direct");
  EXPECT_TRUE(scene->integrator.moments);
  options.defines = {{"spq", "7"}};
  EXPECT_HAS(
      outcome("mitsuba-data/tests/scenes/texture_interp/test_texture_interp_direct.xml", options),
      "spq");
}

/// One scene with every kind of property in it.
std::string rich_scene() {
  return "<scene version=\"3.0.0\">\n<integrator type=\"moment\"><integrator type=\"direct\">"
         "<integer name=\"emitter_samples\" value=\"2\"/></integrator></integrator>\n"
         "<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/><transform "
         "name=\"to_world\"><lookat origin=\"0,0,4\" target=\"0,0,0\" up=\"0,1,0\"/></transform>"
         "<film type=\"hdrfilm\"><integer name=\"width\" value=\"64\"/><integer name=\"height\" "
         "value=\"32\"/><rfilter type=\"tent\"><float name=\"radius\" value=\"1.5\"/></rfilter>"
         "</film><sampler type=\"independent\"><integer name=\"seed\" value=\"3\"/></sampler>"
         "</sensor>\n<bsdf type=\"mask\" id=\"m\"><rgb name=\"opacity\" value=\"0.5\"/>"
         "<bsdf type=\"twosided\"><bsdf type=\"roughconductor\"><string name=\"material\" "
         "value=\"Au\"/><texture type=\"checkerboard\" name=\"alpha\"><transform name=\"to_uv\">"
         "<scale x=\"5\" y=\"5\"/></transform></texture></bsdf></bsdf></bsdf>\n"
         "<shape type=\"sphere\"><point name=\"center\" x=\"1\" y=\"0\" z=\"0\"/><ref id=\"m\"/>"
         "</shape>\n<shape type=\"cube\"><bsdf type=\"diffuse\"><spectrum name=\"reflectance\" "
         "value=\"400:0.1, 500:0.3, 700:0.2\"/></bsdf><transform name=\"to_world\"><rotate "
         "y=\"1\" angle=\"30\"/></transform></shape>\n<shape type=\"rectangle\"><emitter "
         "type=\"area\"><spectrum type=\"d65\" name=\"radiance\"><float name=\"scale\" "
         "value=\"3\"/></spectrum></emitter></shape>\n<emitter type=\"point\"><spectrum "
         "name=\"intensity\" value=\"2\"/></emitter>\n<emitter type=\"constant\"/>\n</scene>\n";
}

TEST(MitsubaScene, DamagedFilesEndInAMessage) {
  const std::string whole = rich_scene();
  read_mitsuba_scene_string(whole);
  const std::vector<std::string> words = {
      "\"",      "<",       "/>",      "0",      "-1",       "1e400", "nan",   "path",
      "sphere",  "diffuse", "value",   "name",   "rgb",      "float", "bsdf",  "999999999",
      "emitter", "area",    "texture", "bitmap", "twosided", "mask",  "shape", "65536"};
  std::mt19937 random(7);
  auto pick = [&](size_t n) { return std::uniform_int_distribution<size_t>(0, n - 1)(random); };
  int accepted = 0, refused = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string text = whole;
    for (size_t edits = 1 + pick(3); edits > 0; --edits) {
      size_t at = pick(text.size());
      switch (pick(8)) {
      case 0:
        text[at] = static_cast<char>(32 + pick(95));
        break;
      case 1:
        text.erase(at, 1 + pick(12));
        break;
      case 2:
        text.insert(at, words[pick(words.size())]);
        break;
      case 3:
      case 4: { // one digit for another
        size_t digit = text.find_first_of("0123456789", at);
        if (digit != text.npos)
          text[digit] = static_cast<char>('0' + pick(10));
        break;
      }
      default: { // one attribute's text for another
        size_t from = text.find('"', at);
        size_t to = from == text.npos ? from : text.find('"', from + 1);
        if (to != text.npos)
          text.replace(from + 1, to - from - 1, words[3 + pick(words.size() - 3)]);
      }
      }
    }
    try {
      read_mitsuba_scene_string(text, "m.xml");
      ++accepted;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find("m.xml"), 0u) << error.what() << "\n" << text;
      ++refused;
    }
  }
  EXPECT_GT(accepted, 100);
  EXPECT_GT(refused, 1000);
}

} // namespace
} // namespace faceta
